# SPDX-License-Identifier: GPL-3.0-or-later
# What the sources must look like; label `lint`. Each check is shown to fail by lint.selftest.
set(lint ${PROJECT_SOURCE_DIR}/tools/dev/lint)

function(lacuna_lint name)
  add_test(NAME lint.${name} COMMAND ${ARGN} WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
  set_tests_properties(lint.${name} PROPERTIES LABELS lint ENVIRONMENT PYTHONDONTWRITEBYTECODE=1)
endfunction()

lacuna_lint(selftest ${LACUNA_PYTHON} ${lint}/selftest.py ${CMAKE_C_COMPILER})
lacuna_lint(layers ${LACUNA_PYTHON} ${lint}/layers.py)
lacuna_lint(rows ${LACUNA_PYTHON} ${lint}/rows.py)
lacuna_lint(sizes ${LACUNA_PYTHON} ${lint}/sizes.py)
lacuna_lint(docs ${LACUNA_PYTHON} ${lint}/docs.py)
lacuna_lint(spdx ${LACUNA_PYTHON} ${lint}/spdx.py)
if(TARGET lacuna_shared)
  set(exports --names $<TARGET_FILE:lacuna_shared>)
endif()
lacuna_lint(budgets ${LACUNA_PYTHON} ${lint}/budgets.py ${exports})

# Sanitizers, fuzzers and coverage add symbols of their own.
if(NOT LACUNA_SANITIZE AND NOT LACUNA_FUZZ AND NOT CMAKE_C_FLAGS MATCHES "--coverage")
  lacuna_lint(symbols ${LACUNA_PYTHON} ${lint}/symbols.py $<TARGET_FILE:lacuna>)
endif()

file(GLOB_RECURSE lint_sources CONFIGURE_DEPENDS
     ${PROJECT_SOURCE_DIR}/include/*.h ${PROJECT_SOURCE_DIR}/src/*.[ch]
     ${PROJECT_SOURCE_DIR}/tests/*.[ch] ${PROJECT_SOURCE_DIR}/tools/*.[ch])

# lacuna_lint_by_clang(NAME PROGRAM COMMAND ...): another version of clang's programs breaks lines and warns
# elsewhere than the one that the sources are written for; the test is then skipped, and says so.
set(clang_tools 14)
function(lacuna_lint_by_clang name program)
  execute_process(COMMAND ${program} --version OUTPUT_VARIABLE said)
  string(REGEX MATCH "version ([0-9]+)" said "${said}")
  if(CMAKE_MATCH_1 EQUAL clang_tools)
    lacuna_lint(${name} ${ARGN})
  else()
    lacuna_lint(${name} ${CMAKE_COMMAND} -E echo
                "skipped: ${program} is ${said}, the sources are for version ${clang_tools}")
    set_tests_properties(lint.${name} PROPERTIES SKIP_REGULAR_EXPRESSION "^skipped")
  endif()
endfunction()

find_program(CLANG_FORMAT NAMES clang-format-${clang_tools} clang-format)
if(CLANG_FORMAT)
  lacuna_lint_by_clang(format ${CLANG_FORMAT} ${CLANG_FORMAT} --dry-run -Werror ${lint_sources})
  add_custom_target(format COMMAND ${CLANG_FORMAT} -i ${lint_sources} VERBATIM)
endif()

find_program(SHELLCHECK NAMES shellcheck)
if(SHELLCHECK)
  lacuna_lint(shell ${SHELLCHECK} tools/install-packages tools/quickstart tools/build tools/test
              tools/dev/memcheck tools/dev/races tools/dev/rank-errors tools/bench tools/dev/instruction-counts tools/dev/case-counts tools/dev/on-debian .ci/run tools/cmake/prerm)
endif()

# Every unit of the compilation database; the options that gcc alone knows are dropped. The target has clang's
# analyzer too, which takes as long as all the rest.
find_program(CLANG_TIDY NAMES clang-tidy-${clang_tools} clang-tidy)
find_program(RUN_CLANG_TIDY NAMES run-clang-tidy-${clang_tools} run-clang-tidy)
if(CLANG_TIDY AND RUN_CLANG_TIDY)
  set(tidy ${RUN_CLANG_TIDY} -clang-tidy-binary ${CLANG_TIDY} -quiet -p ${PROJECT_BINARY_DIR}
      -extra-arg=-Wno-unknown-warning-option ${PROJECT_SOURCE_DIR}/src/.*)
  add_custom_target(tidy COMMAND ${tidy} WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} VERBATIM)
  lacuna_lint_by_clang(tidy ${CLANG_TIDY} ${tidy} -checks=-clang-analyzer-*)
  set_tests_properties(lint.tidy PROPERTIES TIMEOUT 1800 COST 1000)
endif()
