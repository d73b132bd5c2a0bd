# SPDX-License-Identifier: GPL-3.0-or-later
# The program itself, called as its users call it.
foreach(program test_cli test_interface)
  add_test(NAME case.${program}
           COMMAND ${LACUNA_PYTHON} ${CMAKE_CURRENT_SOURCE_DIR}/case/${program}.py
                   $<TARGET_FILE:lacuna_program> ${PROJECT_SOURCE_DIR})
  set_tests_properties(case.${program} PROPERTIES LABELS case TIMEOUT 1200 COST 100 ENVIRONMENT
    "LSAN_OPTIONS=suppressions=${CMAKE_CURRENT_SOURCE_DIR}/lsan.supp:print_suppressions=0")
endforeach()
