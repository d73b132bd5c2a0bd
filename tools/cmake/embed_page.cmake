# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -D FOLDER=... -D OUTPUT=FILE.c -P embed_page.cmake
# In page.html a line <!-- style NAME --> or <!-- script NAME --> stands for the file of that name, in a tag with the
# mark @NONCE@.
get_filename_component(folder ${OUTPUT} DIRECTORY)
file(MAKE_DIRECTORY ${folder})
file(READ ${FOLDER}/page.html page)
foreach(kind style script)
  string(REGEX MATCHALL "<!-- ${kind} [a-z.]+ -->" marks "${page}")
  foreach(mark ${marks})
    string(REGEX REPLACE "<!-- ${kind} ([a-z.]+) -->" "\\1" name "${mark}")
    file(READ ${FOLDER}/${name} part)
    string(REPLACE "${mark}" "<${kind}@NONCE@>\n${part}</${kind}>" page "${page}")
  endforeach()
endforeach()
file(WRITE ${OUTPUT}.html "${page}")
file(READ ${OUTPUT}.html bytes HEX)
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
string(REGEX REPLACE "(................................................................................)" "\\1\n" bytes "${bytes}")
file(WRITE ${OUTPUT} "#include \"report/run.h\"\n\nconst unsigned char lac_page_html[] = {\n${bytes}0x00};\n")
