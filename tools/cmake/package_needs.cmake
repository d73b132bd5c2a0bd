# SPDX-License-Identifier: GPL-3.0-or-later
# Read by cpack before it begins: without these programs its packages would have no dependencies.
find_program(LACUNA_FILE file)
find_program(LACUNA_SHLIBDEPS dpkg-shlibdeps)
if(NOT LACUNA_FILE OR NOT LACUNA_SHLIBDEPS)
  message(FATAL_ERROR "a .deb needs the programs file and dpkg-shlibdeps: apt-get install file dpkg-dev")
endif()
# Times in packages are the release's, so that the same sources give the same bytes.
if(NOT DEFINED ENV{SOURCE_DATE_EPOCH})
  file(STRINGS ${CMAKE_CURRENT_LIST_DIR}/../../CITATION.cff released REGEX "^date-released: ")
  string(REGEX REPLACE "^.*: " "" released "${released}")
  execute_process(COMMAND date -u -d ${released} +%s OUTPUT_VARIABLE epoch OUTPUT_STRIP_TRAILING_WHITESPACE
                  COMMAND_ERROR_IS_FATAL ANY)
  set(ENV{SOURCE_DATE_EPOCH} ${epoch})
endif()
