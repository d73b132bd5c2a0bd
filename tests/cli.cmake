# SPDX-License-Identifier: GPL-3.0-or-later
# The program itself, called as its users call it.
find_package(Python3 REQUIRED COMPONENTS Interpreter)
add_test(NAME case.test_cli
         COMMAND Python3::Interpreter ${CMAKE_CURRENT_SOURCE_DIR}/case/test_cli.py
                 $<TARGET_FILE:lacuna_program> ${CMAKE_SOURCE_DIR})
set_tests_properties(case.test_cli PROPERTIES LABELS case TIMEOUT 300 ENVIRONMENT
  "LSAN_OPTIONS=suppressions=${CMAKE_CURRENT_SOURCE_DIR}/lsan.supp:print_suppressions=0")
