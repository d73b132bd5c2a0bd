# SPDX-License-Identifier: GPL-3.0-or-later
# The shared library. Every function that a public header declares is exported, nothing else.

# The list for the linker, made anew when a header changes.
file(GLOB public_headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/include/lacuna/*.h)
set(exports ${PROJECT_BINARY_DIR}/lacuna.map)
add_custom_command(OUTPUT ${exports}
  COMMAND ${CMAKE_COMMAND} -DOUTPUT=${exports} -DVERSION=${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
          "-DHEADERS=${public_headers}" -P ${PROJECT_SOURCE_DIR}/tools/cmake/exports.cmake
  DEPENDS ${public_headers} ${PROJECT_SOURCE_DIR}/tools/cmake/exports.cmake VERBATIM)
add_custom_target(lacuna_exports DEPENDS ${exports})

add_library(lacuna_shared SHARED $<TARGET_OBJECTS:lacuna_objects>)
add_dependencies(lacuna_shared lacuna_exports)
target_include_directories(lacuna_shared INTERFACE
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:include>)
target_link_libraries(lacuna_shared PRIVATE lacuna_dependencies m)
if(LACUNA_LAZY)
  target_sources(lacuna_shared PRIVATE $<TARGET_OBJECTS:lacuna_lazy>)
endif()
target_link_options(lacuna_shared PRIVATE
  -Wl,--version-script=${exports} -Wl,-Bsymbolic -Wl,--no-undefined -Wl,--as-needed)
# While the version begins with 0 each minor one may change the interface, and so has a name of its
# own.
set_target_properties(lacuna_shared PROPERTIES
  OUTPUT_NAME lacuna EXPORT_NAME lacuna VERSION ${PROJECT_VERSION}
  SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR} LINK_DEPENDS ${exports})
