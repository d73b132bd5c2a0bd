# SPDX-License-Identifier: GPL-3.0-or-later
# cpack --config build/CPackConfig.cmake: the .debs of the program, the shared library, what is built with it,
# the Python module, and the program for MPI. The same sources give the same bytes (tools/dev/reproduce).
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME lacuna)
set(CPACK_PACKAGE_CONTACT "${PROJECT_NAME} <lacuna@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGE_DESCRIPTION
  "Presses rough surfaces, follows the cells that touch through rate-and-state friction and a
hierarchy of stress transfer in time, and forecasts failure from readings. Program, tools that draw,
manual pages, documentation and cases.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/tools/cmake/package_modes.cmake)
set(CPACK_COMPONENTS_ALL)
# What shlibdeps cannot see: opened where they are needed.
string(JOIN ", " opened ${LACUNA_LAZY_PACKAGES})

# lacuna_package(COMPONENT NAME SECTION DESCRIPTION): its licence goes with it.
function(lacuna_package component name section description)
  list(APPEND CPACK_COMPONENTS_ALL ${component})
  string(TOUPPER ${component} upper)
  set(CPACK_COMPONENTS_ALL ${CPACK_COMPONENTS_ALL} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${name} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${section} PARENT_SCOPE)
  set(CPACK_COMPONENT_${upper}_DESCRIPTION "${description}" PARENT_SCOPE)
  if(NOT name STREQUAL "lacuna")
    install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name}
            RENAME copyright COMPONENT ${component} EXCLUDE_FROM_ALL)
  endif()
endfunction()

lacuna_package(lacuna lacuna science "${CPACK_PACKAGE_DESCRIPTION}")
set(CPACK_DEBIAN_LACUNA_PACKAGE_SHLIBDEPS ON)
string(JOIN ", " CPACK_DEBIAN_LACUNA_PACKAGE_DEPENDS libmicrohttpd12 ${opened})
set(CPACK_DEBIAN_LACUNA_PACKAGE_SUGGESTS "python3-lacuna, liblacuna-dev, python3-numpy, python3-xarray, python3-netcdf4, python3-matplotlib, netcdf-bin")
set(CPACK_DEBIAN_LACUNA_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/tools/cmake/prerm)
if(TARGET lacuna_shared)
  set(library liblacuna${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  lacuna_package(library ${library} libs "The shared library of lacuna.")
  set(CPACK_DEBIAN_LIBRARY_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS "${opened}")
  set(same "${library} (= ${PROJECT_VERSION})")
  lacuna_package(python python3-lacuna python
    "The Python module: each command of lacuna as a function that gives an xarray.Dataset,\nby the library and the program of the package lacuna.")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_ARCHITECTURE all)
  # As the module knows the interface of that version alone.
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
      "${same}, lacuna (= ${PROJECT_VERSION}), python3, python3-numpy, python3-xarray")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "python3-netcdf4")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-matplotlib, jupyter-notebook")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/tools/cmake/prerm)
endif()
lacuna_package(dev liblacuna-dev libdevel
  "Headers and the static library of lacuna, for pkg-config and CMake. Programs that link the\nstatic library need the headers' packages of what it uses too.")
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "${same}")
# which once held them
set(CPACK_DEBIAN_DEV_PACKAGE_BREAKS "lacuna (<< 0.2.0)")
set(CPACK_DEBIAN_DEV_PACKAGE_REPLACES "lacuna (<< 0.2.0)")
if(TARGET lacuna_mpi)
  lacuna_package(mpi lacuna-mpi science
    "The program for the ranks of an MPI job: a run that many processes share,\nto the same bits as lacuna.")
  set(CPACK_DEBIAN_MPI_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_MPI_PACKAGE_DEPENDS "lacuna (= ${PROJECT_VERSION}), ${CPACK_DEBIAN_LACUNA_PACKAGE_DEPENDS}, openmpi-bin")
endif()
set(CPACK_PROJECT_CONFIG_FILE ${PROJECT_SOURCE_DIR}/tools/cmake/package_needs.cmake)
include(CPack)
