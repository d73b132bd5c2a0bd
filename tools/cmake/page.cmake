# SPDX-License-Identifier: GPL-3.0-or-later
# The page of `lacuna report`: its style and scripts put into page.html, all of it into a C array.
set(page_folder ${PROJECT_SOURCE_DIR}/src/report/page)
file(GLOB page_parts CONFIGURE_DEPENDS ${page_folder}/*)
set(page_source ${PROJECT_BINARY_DIR}/generated/page.c)
add_custom_command(OUTPUT ${page_source}
  COMMAND ${CMAKE_COMMAND} -D FOLDER=${page_folder} -D OUTPUT=${page_source}
          -P ${PROJECT_SOURCE_DIR}/tools/cmake/embed_page.cmake
  DEPENDS ${page_parts} ${PROJECT_SOURCE_DIR}/tools/cmake/embed_page.cmake VERBATIM)
