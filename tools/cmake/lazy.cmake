# SPDX-License-Identifier: GPL-3.0-or-later
# Opens netCDF and SUNDIALS where they are first used, not when the program starts: what they draw in
# (curl, Kerberos, XML; MPI on Debian 13) costs more to load than most commands take. For the program and the
# shared library; who links liblacuna.a links them.
string(TOLOWER "${CMAKE_SYSTEM_PROCESSOR}" processor)
set(lazy_default OFF)
if(LACUNA_SHARED AND processor MATCHES "^(x86_64|amd64|aarch64|arm64)$" AND CMAKE_SYSTEM_NAME STREQUAL "Linux")
  set(lazy_default ON)
endif()
option(LACUNA_LAZY "Open netCDF and SUNDIALS where they are needed" ${lazy_default})
set(LACUNA_LAZY_SOURCES)
set(LACUNA_LAZY_PACKAGES)
if(NOT LACUNA_LAZY)
  return()
endif()
find_program(READELF readelf REQUIRED)

# What dlopen is to be asked for: a name where the system looks for it by itself, else a path.
function(lacuna_lazy name expression)
  set(files)
  foreach(path ${ARGN})
    file(REAL_PATH ${path} real)
    execute_process(COMMAND ${READELF} -d ${real} OUTPUT_VARIABLE said COMMAND_ERROR_IS_FATAL ANY)
    string(REGEX MATCH "SONAME[^[]*\\[([^]]*)\\]" found "${said}")
    set(file ${CMAKE_MATCH_1})
    get_filename_component(folder ${path} DIRECTORY)
    if(NOT folder IN_LIST CMAKE_C_IMPLICIT_LINK_DIRECTORIES)
      set(file ${folder}/${file})
    endif()
    list(APPEND files ${file})
    # shlibdeps cannot see it: the package that the file is of
    execute_process(COMMAND dpkg-query -S ${real} OUTPUT_VARIABLE owner RESULT_VARIABLE none ERROR_QUIET)
    if(none EQUAL 0)
      string(REGEX REPLACE ":.*" "" owner "${owner}")
      list(APPEND LACUNA_LAZY_PACKAGES ${owner})
    endif()
  endforeach()
  set(source ${PROJECT_BINARY_DIR}/lazy_${name}.c)
  set(objects ${PROJECT_BINARY_DIR}/lazy_${name}.objects)
  file(GENERATE OUTPUT ${objects} CONTENT "$<JOIN:$<TARGET_OBJECTS:lacuna_objects>,;>")
  add_custom_command(OUTPUT ${source}
    COMMAND ${CMAKE_COMMAND} -DNM=${CMAKE_NM} -DOBJECTS=${objects} -DLIBRARY=${name} "-DEXPRESSION=${expression}"
            "-DNAMED=${files}" -DIN=${PROJECT_SOURCE_DIR}/tools/cmake/lazy.c.in -DOUTPUT=${source}
            -P ${PROJECT_SOURCE_DIR}/tools/cmake/lazy_source.cmake
    DEPENDS lacuna_objects $<TARGET_OBJECTS:lacuna_objects> ${PROJECT_SOURCE_DIR}/tools/cmake/lazy.c.in
            ${PROJECT_SOURCE_DIR}/tools/cmake/lazy_source.cmake VERBATIM)
  list(APPEND LACUNA_LAZY_SOURCES ${source})
  set(LACUNA_LAZY_SOURCES ${LACUNA_LAZY_SOURCES} PARENT_SCOPE)
  set(LACUNA_LAZY_PACKAGES ${LACUNA_LAZY_PACKAGES} PARENT_SCOPE)
endfunction()

set(sundials)
foreach(name cvodes arkode nvecserial core)
  if(TARGET SUNDIALS::${name}_shared)
    get_target_property(path SUNDIALS::${name}_shared LOCATION)
    list(APPEND sundials ${path})
  endif()
endforeach()
lacuna_lazy(netcdf "^nc_" ${LACUNA_netcdf_LINK_LIBRARIES})
lacuna_lazy(sundials "^(CVode|CVodeS|N_V|SUN|ERKStep|ARK)" ${sundials})
# One target, as two that compile a made file would each make it.
add_library(lacuna_lazy OBJECT ${LACUNA_LAZY_SOURCES})
target_include_directories(lacuna_lazy PRIVATE ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR}/src)
target_link_libraries(lacuna_lazy PRIVATE lacuna_options)
set_target_properties(lacuna_lazy PROPERTIES POSITION_INDEPENDENT_CODE ON)
