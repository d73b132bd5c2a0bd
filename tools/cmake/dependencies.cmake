# SPDX-License-Identifier: GPL-3.0-or-later
# The libraries Lacuna stands on, gathered in one interface target.
find_package(SUNDIALS 6.4 REQUIRED COMPONENTS cvodes arkode nvecserial)
find_package(PkgConfig REQUIRED)
# Each by itself: of several at once all would be looked for where the first one is.
set(modules gsl fftw3 fftw3f netcdf yaml-0.1)
set(module_paths)
foreach(module ${modules})
  pkg_check_modules(LACUNA_${module} REQUIRED IMPORTED_TARGET ${module})
  list(APPEND module_paths ${LACUNA_${module}_LINK_LIBRARIES})
endforeach()
list(TRANSFORM modules PREPEND PkgConfig::LACUNA_ OUTPUT_VARIABLE module_targets)
find_library(UDUNITS2_LIBRARY udunits2 REQUIRED)
find_path(UDUNITS2_INCLUDE udunits2.h PATH_SUFFIXES udunits2 REQUIRED)
find_path(RANDOM123_INCLUDE Random123/philox.h REQUIRED)
find_path(MICROHTTPD_INCLUDE microhttpd.h) # loaded by `run --view` alone, not linked
find_package(OpenMP REQUIRED COMPONENTS C)

add_library(lacuna_dependencies INTERFACE)
# cvodes is a superset of cvode; arkode brings the explicit Runge-Kutta method.
target_link_libraries(lacuna_dependencies INTERFACE
  SUNDIALS::cvodes SUNDIALS::arkode SUNDIALS::nvecserial
  ${module_targets} ${UDUNITS2_LIBRARY} OpenMP::OpenMP_C)
target_include_directories(lacuna_dependencies SYSTEM INTERFACE
  ${UDUNITS2_INCLUDE} ${RANDOM123_INCLUDE})

# The same as words for a linker that knows nothing of CMake, for whoever links liblacuna.a. netCDF's
# own list for static linking is not asked: on Debian 13 it names CMake's targets.
set(needed)
foreach(name core cvodes arkode nvecserial) # core: from SUNDIALS 7 on
  foreach(target SUNDIALS::${name}_shared SUNDIALS::${name}_static)
    if(TARGET ${target})
      get_target_property(path ${target} LOCATION)
      list(APPEND needed ${path})
      break()
    endif()
  endforeach()
endforeach()
if(SUNDIALS_VERSION VERSION_GREATER_EQUAL 7 AND MPI_C_LIBRARIES)
  list(APPEND needed ${MPI_C_LIBRARIES}) # whose "none" a context is made with
endif()
list(APPEND needed ${module_paths} ${UDUNITS2_LIBRARY} ${OpenMP_C_LIBRARIES})
set(LACUNA_LINK_FLAGS)
foreach(path ${needed})
  get_filename_component(folder ${path} DIRECTORY)
  if(folder AND NOT folder IN_LIST CMAKE_C_IMPLICIT_LINK_DIRECTORIES)
    list(APPEND LACUNA_LINK_FLAGS -L${folder})
  endif()
  string(REGEX REPLACE "^.*/lib([^/]*)\\.(so|a)[.0-9]*$" "-l\\1" word ${path})
  list(APPEND LACUNA_LINK_FLAGS ${word})
endforeach()
list(REMOVE_DUPLICATES LACUNA_LINK_FLAGS)
