# SPDX-License-Identifier: GPL-3.0-or-later
# Tests that call programs: the command line, the bundled cases and what they write.
include(cli.cmake)

# Every bundled case checks, runs (one without time: is pressed and sheared), and writes a file that
# meets CF and opens in xarray.
set(case_environment
    "LSAN_OPTIONS=suppressions=${CMAKE_CURRENT_SOURCE_DIR}/lsan.supp:print_suppressions=0")
file(GLOB bundled_cases CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/cases/*.yaml
     ${CMAKE_SOURCE_DIR}/cases/load/*.yaml
     ${CMAKE_SOURCE_DIR}/cases/peers/*.yaml ${CMAKE_SOURCE_DIR}/cases/transfer/*.yaml)
foreach(bundled ${bundled_cases})
  get_filename_component(name ${bundled} NAME_WE)
  set(output ${CMAKE_CURRENT_BINARY_DIR}/${name}.nc)
  add_test(NAME case.${name}.check COMMAND lacuna_program check -q ${bundled})
  set(shorter)
  if(name MATCHES "^(periodic-line|plane-patch)$")
    # half a minute to their ends, which verify.test_peers and tools/bench look at
    set(shorter --set "time.end=1e8 s")
  endif()
  file(STRINGS ${bundled} timed REGEX "^time:")
  set(command run)
  if(NOT timed)
    set(command contact)
  endif()
  add_test(NAME case.${name}.run
           COMMAND lacuna_program ${command} ${bundled} ${shorter} -o ${output} --force
                   --no-progress)
  add_test(NAME case.${name}.cf
           COMMAND /usr/bin/python3 ${CMAKE_CURRENT_SOURCE_DIR}/support/check_cf.py ${output})
  set_tests_properties(case.${name}.check case.${name}.run case.${name}.cf PROPERTIES
                       LABELS case ENVIRONMENT ${case_environment})
  set_tests_properties(case.${name}.run PROPERTIES FIXTURES_SETUP output_${name} TIMEOUT 300)
  set_tests_properties(case.${name}.cf PROPERTIES FIXTURES_REQUIRED output_${name})
endforeach()

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

# Cases for `lacuna contact`: each checks, is pressed, and its file meets CF.
file(GLOB contact_cases CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/cases/contact/*.yaml)
foreach(bundled ${contact_cases})
  get_filename_component(name ${bundled} NAME_WE)
  set(output ${CMAKE_CURRENT_BINARY_DIR}/${name}-contact.nc)
  add_test(NAME case.contact.${name}.check COMMAND lacuna_program check -q ${bundled})
  add_test(NAME case.contact.${name}.run
           COMMAND lacuna_program contact ${bundled} -o ${output} --force
                   --set interface.levels=9)
  add_test(NAME case.contact.${name}.cf
           COMMAND /usr/bin/python3 ${CMAKE_CURRENT_SOURCE_DIR}/support/check_cf.py
                   --status complete ${output})
  set_tests_properties(case.contact.${name}.check case.contact.${name}.run
                       case.contact.${name}.cf PROPERTIES LABELS case
                       ENVIRONMENT ${case_environment})
  set_tests_properties(case.contact.${name}.run PROPERTIES FIXTURES_SETUP contact_${name})
  set_tests_properties(case.contact.${name}.cf PROPERTIES FIXTURES_REQUIRED contact_${name})
endforeach()

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

# Cases for `lacuna rg`: each checks, runs, and its file meets CF.
file(GLOB rg_cases CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/cases/rg/*.yaml)
foreach(bundled ${rg_cases})
  get_filename_component(name ${bundled} NAME_WE)
  set(output ${CMAKE_CURRENT_BINARY_DIR}/${name}-rg.nc)
  add_test(NAME case.rg.${name}.check COMMAND lacuna_program check -q ${bundled})
  add_test(NAME case.rg.${name}.run
           COMMAND lacuna_program rg ${bundled} -o ${output} --force --set interface.levels=7)
  add_test(NAME case.rg.${name}.cf
           COMMAND /usr/bin/python3 ${CMAKE_CURRENT_SOURCE_DIR}/support/check_cf.py
                   --status complete ${output})
  set_tests_properties(case.rg.${name}.check case.rg.${name}.run case.rg.${name}.cf
                       PROPERTIES LABELS case ENVIRONMENT ${case_environment})
  set_tests_properties(case.rg.${name}.run PROPERTIES FIXTURES_SETUP rg_${name})
  set_tests_properties(case.rg.${name}.cf PROPERTIES FIXTURES_REQUIRED rg_${name})
endforeach()

# Cases of friction: each checks, runs, and its file meets CF; and shows what it says.
file(GLOB friction_cases CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/cases/friction/*.yaml)
foreach(bundled ${friction_cases})
  get_filename_component(name ${bundled} NAME_WE)
  set(output ${CMAKE_CURRENT_BINARY_DIR}/${name}-friction.nc)
  add_test(NAME case.friction.${name}.check COMMAND lacuna_program check -q ${bundled})
  add_test(NAME case.friction.${name}.run
           COMMAND lacuna_program run ${bundled} -o ${output} --force --no-progress)
  add_test(NAME case.friction.${name}.cf
           COMMAND /usr/bin/python3 ${CMAKE_CURRENT_SOURCE_DIR}/support/check_cf.py
                   --status complete ${output})
  set_tests_properties(case.friction.${name}.check case.friction.${name}.run
                       case.friction.${name}.cf PROPERTIES LABELS case
                       ENVIRONMENT ${case_environment})
  set_tests_properties(case.friction.${name}.run PROPERTIES FIXTURES_SETUP friction_${name})
  set_tests_properties(case.friction.${name}.cf PROPERTIES FIXTURES_REQUIRED friction_${name})
endforeach()
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

# Fits, and what they write; the bundled cases for it check, and their files meet CF.
add_test(NAME case.test_fit
         COMMAND /usr/bin/python3 ${CMAKE_CURRENT_SOURCE_DIR}/case/test_fit.py
                 $<TARGET_FILE:lacuna_program> ${CMAKE_SOURCE_DIR})
set_tests_properties(case.test_fit PROPERTIES LABELS case TIMEOUT 600
                     ENVIRONMENT ${case_environment})
foreach(bundled block century)
  add_test(NAME case.fit.${bundled}.check
           COMMAND lacuna_program check -q ${CMAKE_SOURCE_DIR}/cases/fit/${bundled}.yaml)
  set_tests_properties(case.fit.${bundled}.check PROPERTIES LABELS case
                       ENVIRONMENT ${case_environment})
endforeach()
set(fit_output ${CMAKE_CURRENT_BINARY_DIR}/block-fit.nc)
add_test(NAME case.fit.block.fit
         COMMAND lacuna_program fit ${CMAKE_SOURCE_DIR}/cases/fit/block.yaml
                 ${CMAKE_SOURCE_DIR}/cases/data/creep.csv --set fit.steps=20 --set fit.burn=5
                 --set fit.starts=8 -o ${fit_output} --force)
add_test(NAME case.fit.block.cf
         COMMAND /usr/bin/python3 ${CMAKE_CURRENT_SOURCE_DIR}/support/check_cf.py
                 --status complete ${fit_output})
set_tests_properties(case.fit.block.fit case.fit.block.cf PROPERTIES LABELS case
                     ENVIRONMENT ${case_environment})
set_tests_properties(case.fit.block.fit PROPERTIES FIXTURES_SETUP block_fit)
set_tests_properties(case.fit.block.cf PROPERTIES FIXTURES_REQUIRED block_fit)
