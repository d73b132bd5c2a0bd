# SPDX-License-Identifier: GPL-3.0-or-later
# Writes a version script that exports what the public headers declare.
#   cmake -DOUTPUT=FILE -DVERSION=M.N "-DHEADERS=A.h;B.h" -P exports.cmake
set(names)
foreach(header ${HEADERS})
  # Comments name functions too, also such as are not public.
  file(STRINGS ${header} lines REGEX "lac_[a-z0-9_]+")
  list(FILTER lines EXCLUDE REGEX "^static inline ") # is in the header itself
  foreach(line ${lines})
    string(REGEX REPLACE "//.*" "" line "${line}")
    # A function: a name, then its parameters. A model's row: a name in an `extern`.
    string(REGEX MATCHALL "lac_[a-z0-9_]+\\(" found "${line}")
    if(line MATCHES "^extern ")
      string(REGEX MATCHALL "lac_[a-z0-9_]+[,;]" rows "${line}")
      list(APPEND found ${rows})
    endif()
    list(APPEND names ${found})
  endforeach()
endforeach()
string(REGEX REPLACE "[ ,(]" "" names "${names}")
list(REMOVE_DUPLICATES names)
list(SORT names)
list(JOIN names ";\n    " text)
file(WRITE ${OUTPUT} "LACUNA_${VERSION} {\n  global:\n    ${text};\n  local: *;\n};\n")
