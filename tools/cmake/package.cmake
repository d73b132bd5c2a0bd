# SPDX-License-Identifier: GPL-3.0-or-later
# cpack --config build/CPackConfig.cmake: two .deb, of the Python module and of all else that is installed.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME lacuna)
set(CPACK_PACKAGE_CONTACT "${PROJECT_NAME} <lacuna@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGE_DESCRIPTION
  "Presses rough surfaces, follows the cells that touch through rate-and-state friction and a
hierarchy of stress transfer in time, and forecasts failure from readings. Program, library,
headers, tools that draw, manual pages, documentation and cases.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL lacuna)
set(CPACK_DEBIAN_LACUNA_PACKAGE_NAME lacuna)
set(CPACK_COMPONENT_LACUNA_DESCRIPTION "${CPACK_PACKAGE_DESCRIPTION}")
set(CPACK_DEBIAN_LACUNA_PACKAGE_SECTION science)
# What the binaries need; a program in C or Python needs more only where it is written.
set(CPACK_DEBIAN_LACUNA_PACKAGE_SHLIBDEPS ON)
# Opened where they are needed, which shlibdeps cannot see.
string(JOIN ", " CPACK_DEBIAN_LACUNA_PACKAGE_DEPENDS libmicrohttpd12 ${LACUNA_LAZY_PACKAGES})
set(CPACK_DEBIAN_LACUNA_PACKAGE_SUGGESTS "python3-lacuna, python3-numpy, python3-xarray, python3-netcdf4, python3-matplotlib, netcdf-bin")
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_LACUNA_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/tools/cmake/prerm)
if(TARGET lacuna_shared)
  list(APPEND CPACK_COMPONENTS_ALL python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-lacuna)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_ARCHITECTURE all)
  set(CPACK_COMPONENT_PYTHON_DESCRIPTION
      "The Python module: each command of lacuna as a function that gives an xarray.Dataset,\nby the library and the program of the package lacuna.")
  # As the module knows the interface of that version alone.
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
      "lacuna (= ${PROJECT_VERSION}), python3, python3-numpy, python3-xarray")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "python3-netcdf4")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-matplotlib, jupyter-notebook")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/tools/cmake/prerm)
endif()
if(TARGET lacuna_mpi)
  list(APPEND CPACK_COMPONENTS_ALL mpi)
  set(CPACK_DEBIAN_MPI_PACKAGE_NAME lacuna-mpi)
  set(CPACK_DEBIAN_MPI_PACKAGE_SECTION science)
  set(CPACK_DEBIAN_MPI_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_MPI_PACKAGE_DEPENDS "lacuna (= ${PROJECT_VERSION}), ${CPACK_DEBIAN_LACUNA_PACKAGE_DEPENDS}, openmpi-bin")
  set(CPACK_COMPONENT_MPI_DESCRIPTION "The program for the ranks of an MPI job: a run that many processes share,\nto the same bits as lacuna.")
endif()
set(CPACK_PROJECT_CONFIG_FILE ${PROJECT_SOURCE_DIR}/tools/cmake/package_needs.cmake)
include(CPack)
