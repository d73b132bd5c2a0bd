# SPDX-License-Identifier: GPL-3.0-or-later
# The libraries Lacuna stands on, gathered in one interface target.
find_package(SUNDIALS 6.4 REQUIRED COMPONENTS cvodes arkode nvecserial)
find_package(PkgConfig REQUIRED)
pkg_check_modules(LACUNA_LIBS REQUIRED IMPORTED_TARGET gsl fftw3 fftw3f netcdf yaml-0.1)
find_library(UDUNITS2_LIBRARY udunits2 REQUIRED)
find_path(UDUNITS2_INCLUDE udunits2.h PATH_SUFFIXES udunits2 REQUIRED)
find_path(RANDOM123_INCLUDE Random123/philox.h REQUIRED)
find_path(MICROHTTPD_INCLUDE microhttpd.h REQUIRED) # loaded by `run --view` alone, not linked
find_package(OpenMP REQUIRED COMPONENTS C)

add_library(lacuna_dependencies INTERFACE)
# cvodes is a superset of cvode; arkode brings the explicit Runge-Kutta method.
target_link_libraries(lacuna_dependencies INTERFACE
  SUNDIALS::cvodes SUNDIALS::arkode SUNDIALS::nvecserial
  PkgConfig::LACUNA_LIBS ${UDUNITS2_LIBRARY} OpenMP::OpenMP_C)
target_include_directories(lacuna_dependencies SYSTEM INTERFACE
  ${UDUNITS2_INCLUDE} ${RANDOM123_INCLUDE})
