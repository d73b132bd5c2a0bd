# SPDX-License-Identifier: GPL-3.0-or-later
# The texts that the program writes as they are, cases to start from and scripts for shells, put into a C
# file: @NAME@ on a line of a case stands for NAME.part.
set(texts_folder ${PROJECT_SOURCE_DIR}/src/cli/common/texts)
set(texts_source ${PROJECT_BINARY_DIR}/generated/texts.c)
set(texts "#include \"cli/common/command.h\"\n")

# Adds a table of texts to the C file.
function(add_texts table ending)
  set(rows)
  foreach(name ${ARGN})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${texts_folder}/${name}${ending})
    file(READ ${texts_folder}/${name}${ending} text)
    if(ending STREQUAL .yaml)
      string(CONFIGURE "${text}" text @ONLY)
    endif()
    string(HEX "${text}" bytes)
    string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
    string(APPEND texts "\nstatic const char ${table}_${name}[] = {${bytes}0};\n")
    string(APPEND rows "{\"${name}\", ${table}_${name}}, ")
  endforeach()
  set(texts "${texts}\nconst cli_named_text ${table}[] = {${rows}{0}};\n" PARENT_SCOPE)
endfunction()

foreach(part head law touch time creep)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${texts_folder}/${part}.part)
  file(READ ${texts_folder}/${part}.part ${part})
  string(REGEX REPLACE "\n$" "" ${part} "${${part}}")
endforeach()
string(CONFIGURE "${creep}" creep @ONLY)
add_texts(cli_templates .yaml block fit injection joint laboratory reservoir slope)
add_texts(cli_template_readings .csv fit) # what a case of that name comes with
add_texts(cli_shells "" bash zsh fish)
file(GENERATE OUTPUT ${texts_source} CONTENT "${texts}")
