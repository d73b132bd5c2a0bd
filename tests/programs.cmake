# SPDX-License-Identifier: GPL-3.0-or-later
# Tests that call programs: the command line, the bundled cases and what they write.
include(cli.cmake)

# Every bundled case checks, and runs by the command that it is for: what it writes meets CF and opens
# in xarray. A folder is one group: case.GROUP.NAME.check and .run, case.GROUP.cf of all its files.
set(case_environment
    "LSAN_OPTIONS=suppressions=${CMAKE_CURRENT_SOURCE_DIR}/lsan.supp:print_suppressions=0")

# lacuna_cases(GROUP COMMAND [--set KEY=VALUE...]): a case without `time` is run by `contact` where
# COMMAND is run.
function(lacuna_cases group command)
  string(REPLACE "cases" "" folder "/${group}")
  file(GLOB bundled_cases CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/cases${folder}/*.yaml)
  set(outputs)
  foreach(bundled ${bundled_cases})
    get_filename_component(name ${bundled} NAME_WE)
    set(test case.${group}.${name})
    set(output ${CMAKE_CURRENT_BINARY_DIR}/${group}-${name}.nc)
    list(APPEND outputs ${output})
    set(changed ${ARGN})
    if(name MATCHES "^(periodic-line|plane-patch)$")
      # half a minute to their ends, which verify.test_peers and tools/bench look at
      list(APPEND changed --set "time.end=1e8 s")
    endif()
    set(how ${command})
    file(STRINGS ${bundled} timed REGEX "^time:")
    if(command STREQUAL run AND NOT timed)
      set(how contact)
    endif()
    add_test(NAME ${test}.check COMMAND lacuna_program check -q ${bundled})
    add_test(NAME ${test}.run
             COMMAND lacuna_program ${how} ${bundled} ${changed} -o ${output} --force --no-progress)
    set_tests_properties(${test}.check ${test}.run PROPERTIES LABELS case
                         ENVIRONMENT ${case_environment} TIMEOUT 300)
    set_tests_properties(${test}.run PROPERTIES FIXTURES_SETUP outputs_${group})
  endforeach()
  add_test(NAME case.${group}.cf
           COMMAND /usr/bin/python3 ${CMAKE_CURRENT_SOURCE_DIR}/support/check_cf.py
                   --status complete ${outputs})
  set_tests_properties(case.${group}.cf PROPERTIES LABELS case ENVIRONMENT ${case_environment}
                       FIXTURES_REQUIRED outputs_${group})
endfunction()

foreach(group cases domain friction load normal peers solver surface transfer)
  lacuna_cases(${group} run)
endforeach()
lacuna_cases(contact contact --set interface.levels=9)
lacuna_cases(rg rg --set interface.levels=7)

# The tables of docs/case.md are the program's.
add_test(NAME case.tables COMMAND /usr/bin/python3 ${CMAKE_SOURCE_DIR}/tools/case_tables.py --check
         --program $<TARGET_FILE:lacuna_program> --page ${CMAKE_SOURCE_DIR}/docs/case.md)
set_tests_properties(case.tables PROPERTIES LABELS case ENVIRONMENT ${case_environment})

# The small cases of one model each show what their first lines say.
add_test(NAME case.test_small_cases
         COMMAND /usr/bin/python3 ${CMAKE_CURRENT_SOURCE_DIR}/case/test_small_cases.py
                 $<TARGET_FILE:lacuna_program> ${CMAKE_SOURCE_DIR})
set_tests_properties(case.test_small_cases PROPERTIES LABELS case TIMEOUT 300
                     ENVIRONMENT ${case_environment})

# Loads that change in time, and the files that they come from.
add_test(NAME case.test_loads
         COMMAND /usr/bin/python3 ${CMAKE_CURRENT_SOURCE_DIR}/case/test_loads.py
                 $<TARGET_FILE:lacuna_program> ${CMAKE_SOURCE_DIR})
set_tests_properties(case.test_loads PROPERTIES LABELS case TIMEOUT 300
                     ENVIRONMENT ${case_environment})

# Numbers of extreme size, through the program.
add_test(NAME case.test_extremes
         COMMAND /usr/bin/python3 ${CMAKE_CURRENT_SOURCE_DIR}/case/test_extremes.py
                 $<TARGET_FILE:lacuna_program> ${CMAKE_SOURCE_DIR})
set_tests_properties(case.test_extremes PROPERTIES LABELS "case;extreme" TIMEOUT 300
                     ENVIRONMENT ${case_environment})

# Histories of load, and the commands of the tutorials with what they print.
add_test(NAME case.test_history
         COMMAND /usr/bin/python3 ${CMAKE_CURRENT_SOURCE_DIR}/case/test_history.py
                 $<TARGET_FILE:lacuna_program> ${CMAKE_SOURCE_DIR})
set_tests_properties(case.test_history PROPERTIES LABELS case TIMEOUT 300
                     ENVIRONMENT ${case_environment})
file(GLOB tutorials CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/docs/tutorial-*.md)
foreach(page ${tutorials})
  get_filename_component(name ${page} NAME_WE)
  add_test(NAME case.${name}
           COMMAND /usr/bin/python3 ${CMAKE_CURRENT_SOURCE_DIR}/support/run_page.py
                   $<TARGET_FILE:lacuna_program> ${CMAKE_SOURCE_DIR} ${page})
  set_tests_properties(case.${name} PROPERTIES LABELS case TIMEOUT 300
                       ENVIRONMENT "${case_environment};MPLBACKEND=Agg")
endforeach()

# The library's allocations fail one after the other.
add_executable(unit_test_memory memory/test_memory.c memory/failing_malloc.c)
target_include_directories(unit_test_memory PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
target_link_libraries(unit_test_memory PRIVATE lacuna lacuna_options lacuna_dependencies
                      ${CMOCKA_LIBRARY})
target_link_options(unit_test_memory PRIVATE
                    -Wl,--wrap=malloc -Wl,--wrap=calloc -Wl,--wrap=realloc)
add_test(NAME unit.test_memory COMMAND unit_test_memory)
set_tests_properties(unit.test_memory PROPERTIES LABELS unit ENVIRONMENT ${case_environment})

# The fractal measures as the program gives them, and the tools that read them.
add_test(NAME case.test_fractal
         COMMAND /usr/bin/python3 ${CMAKE_CURRENT_SOURCE_DIR}/case/test_fractal.py
                 $<TARGET_FILE:lacuna_program> ${CMAKE_SOURCE_DIR})
set_tests_properties(case.test_fractal PROPERTIES LABELS case TIMEOUT 600
                     ENVIRONMENT ${case_environment})

# The cascade through the program, of cases and of files.
foreach(program test_rg test_rg_file)
  add_test(NAME case.${program}
           COMMAND /usr/bin/python3 ${CMAKE_CURRENT_SOURCE_DIR}/case/${program}.py
                   $<TARGET_FILE:lacuna_program> ${CMAKE_SOURCE_DIR})
  set_tests_properties(case.${program} PROPERTIES LABELS case TIMEOUT 600
                       ENVIRONMENT ${case_environment})
endforeach()

# The cases of friction show what they say.
add_test(NAME case.test_friction
         COMMAND /usr/bin/python3 ${CMAKE_CURRENT_SOURCE_DIR}/case/test_friction.py
                 $<TARGET_FILE:lacuna_program> ${CMAKE_SOURCE_DIR})
set_tests_properties(case.test_friction PROPERTIES LABELS case TIMEOUT 300
                     ENVIRONMENT ${case_environment})

# The indicators of a run, counted again from the cells' own fields.
add_test(NAME case.test_analysis
         COMMAND /usr/bin/python3 ${CMAKE_CURRENT_SOURCE_DIR}/case/test_analysis.py
                 $<TARGET_FILE:lacuna_program> ${CMAKE_SOURCE_DIR})
set_tests_properties(case.test_analysis PROPERTIES LABELS case TIMEOUT 600
                     ENVIRONMENT ${case_environment})

# The catalogue of events, found again from the cells' own fields at every step.
add_test(NAME case.test_events
         COMMAND /usr/bin/python3 ${CMAKE_CURRENT_SOURCE_DIR}/case/test_events.py
                 $<TARGET_FILE:lacuna_program> ${CMAKE_SOURCE_DIR})
set_tests_properties(case.test_events PROPERTIES LABELS case TIMEOUT 600
                     ENVIRONMENT ${case_environment})
