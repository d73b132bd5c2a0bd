# SPDX-License-Identifier: GPL-3.0-or-later
# Tests that call programs: the command line, the bundled cases and what they write.

# Every bundled case checks, and runs by the command that it is for: what it writes meets CF and opens
# in xarray. A folder is one group: case.GROUP.NAME.check and .run, case.GROUP.cf of all its files.
set(case_environment
    "OMP_WAIT_POLICY=passive"
    "LSAN_OPTIONS=suppressions=${CMAKE_CURRENT_SOURCE_DIR}/lsan.supp:print_suppressions=0")
if(LACUNA_SANITIZE)
  # Tests leave out what is of numbers alone, and of a table of kinds take a third each.
  list(APPEND case_environment "LACUNA_SANITIZED=1")
endif()

# lacuna_cases(GROUP COMMAND [--set KEY=VALUE...]): a case without `time` is run by `contact` where
# COMMAND is run.
function(lacuna_cases group command)
  string(REPLACE "cases" "" folder "/${group}")
  file(GLOB bundled_cases CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/cases${folder}/*.yaml)
  set(outputs)
  foreach(bundled ${bundled_cases})
    get_filename_component(name ${bundled} NAME_WE)
    set(test case.${group}.${name})
    set(output ${CMAKE_CURRENT_BINARY_DIR}/${group}-${name}.nc)
    list(APPEND outputs ${output})
    set(changed ${ARGN})
    if(name MATCHES "^bp[68]$")
      list(APPEND changed --set "time.end=1e5 s")
    elseif(name MATCHES "^(periodic-line|plane-patch|bp[145])$")
      # half a minute to their ends, which verify.test_peers, case.test_seas and tools/bench look at
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
                         ENVIRONMENT "${case_environment}" TIMEOUT 1200)
    set_tests_properties(${test}.run PROPERTIES FIXTURES_SETUP outputs_${group})
  endforeach()
  if(NOT LACUNA_SANITIZE)
    add_test(NAME case.${group}.cf
             COMMAND ${LACUNA_PYTHON} ${CMAKE_CURRENT_SOURCE_DIR}/support/check_cf.py
                     --status complete ${outputs})
    set_tests_properties(case.${group}.cf PROPERTIES LABELS case ENVIRONMENT "${case_environment}"
                         FIXTURES_REQUIRED outputs_${group})
  endif()
endfunction()

set(groups cases domain friction load momentum normal peers seas solver surface transfer weakening)
foreach(group ${groups})
  lacuna_cases(${group} run)
endforeach()
lacuna_cases(contact contact --set interface.levels=9)
lacuna_cases(rg rg --set interface.levels=7)
list(TRANSFORM groups PREPEND outputs_ OUTPUT_VARIABLE case_outputs)
list(APPEND case_outputs outputs_contact outputs_rg)

# The pages of docs/tables that say what the program says of itself; case.test_names has the one of files.
add_test(NAME case.tables COMMAND ${LACUNA_PYTHON} ${PROJECT_SOURCE_DIR}/tools/dev/tables.py --check
         --program $<TARGET_FILE:lacuna_program> keys rocks)
set_tests_properties(case.tables PROPERTIES LABELS case ENVIRONMENT "${case_environment}")

# lacuna_python_test(NAME [once] [LABEL...]): case/NAME.py, called with the program and the source folder.
# These are the long ones, so they begin. `once`: not under sanitizers, which show nothing more, as what is
# tested is Python, a page in a browser or numbers, by commands that other tests give the program too. All
# that they do without, here, in CMakeLists.txt and where LACUNA_SANITIZED is set, takes 4 of 1 000 branches
# that nothing else takes (counted by --coverage, test by test) and a third of the time.
function(lacuna_python_test name)
  if("once" IN_LIST ARGN AND LACUNA_SANITIZE)
    return()
  endif()
  list(REMOVE_ITEM ARGN once)
  add_test(NAME case.${name}
           COMMAND ${LACUNA_PYTHON} ${CMAKE_CURRENT_SOURCE_DIR}/case/${name}.py
                   $<TARGET_FILE:lacuna_program> ${PROJECT_SOURCE_DIR} ${${name}_files})
  set(labels case ${ARGN})
  set_tests_properties(case.${name} PROPERTIES LABELS "${labels}" TIMEOUT 1200 COST 100
                       ENVIRONMENT "${case_environment}")
endfunction()

# Of long runs against closed forms sanitizers see what is refused and what is told: the runs of bundled cases take
# the same ways.
if(LACUNA_SANITIZE)
  set(test_loads_over_joint_files -k Refusals)
  set(test_geometry_files -k Refused -k test_refused)
  set(test_fractal_files -k Scaling -k Options)
  set(test_rg_files -k Cascade -k pressure)
  set(test_analysis_files -k wrong -k one_cell -k test_line -k free_boundary -k full_domain -k fraction -k stopped -k fixed_point)
  set(test_accuracy_files -k kept -k checkpoints -k break -k signal)
  set(test_fidelity_files -k Rule -k regularised)
  set(test_points_files -k free_border -k beside -k a_block -k a_line -k floats -k Wrong -k compare -k Page -k Tables)
  set(test_safety_files -k Stop -k Written -k Water -k Page)
  set(test_fit_files -k files -k range -k columns -k before_failure -k wrong -k says -k spares -k hopeless -k interrupt)
endif()

# The small cases of one model each show what their first lines say.
lacuna_python_test(test_small_cases once)
lacuna_python_test(test_fidelity)

# The program itself, called as its users call it.
lacuna_python_test(test_cli)
lacuna_python_test(test_interface)

# Contact cells from files: what goes in is what comes out.
lacuna_python_test(test_domain_file)

# Loads that bend at every reading of a long series.
lacuna_python_test(test_breaks once extreme)

# Pilot runs: the one that is kept, and those that must not deceive.
lacuna_python_test(test_accuracy)

# Loads that change in time, and the files that they come from.
lacuna_python_test(test_loads)
lacuna_python_test(test_loads_over_joint)
lacuna_python_test(test_lumped)
lacuna_python_test(test_safety)
lacuna_python_test(test_seas once)
lacuna_python_test(test_geometry)

# Elastic rock: what slip takes off the cells and how loads reach them.
lacuna_python_test(test_elastic once)
lacuna_python_test(test_elastic_limits once extreme)

# Numbers of extreme size, through the program.
lacuna_python_test(test_extremes extreme)

# Runs that are stopped and go on. The library that stops them is loaded into them.
add_library(at_call MODULE stop/at_call.c)
target_compile_options(at_call PRIVATE ${warnings})
# netCDF comes along with it, in whose nc_sync's place it stands, as the program opens it late.
target_link_options(at_call PRIVATE -Wl,--no-as-needed)
target_link_libraries(at_call PRIVATE ${CMAKE_DL_LIBS} PkgConfig::LACUNA_netcdf)
set(test_resume_files $<TARGET_FILE:at_call>)
lacuna_python_test(test_resume)
set(test_branch_files $<TARGET_FILE:at_call>)
lacuna_python_test(test_branch)
lacuna_python_test(test_points)

# Memory that is short for one allocation, of the program as it is shipped.
if(NOT LACUNA_SANITIZE)
  add_library(fail_at MODULE memory/fail_at.c)
  target_compile_options(fail_at PRIVATE ${warnings})
  target_link_libraries(fail_at PRIVATE ${CMAKE_DL_LIBS})
  set(test_every_allocation_files $<TARGET_FILE:fail_at>)
  lacuna_python_test(test_every_allocation once)
endif()

# Runs on the ranks of an MPI job, where that is there.
set(test_ranks_files none none none none ${PROJECT_BINARY_DIR})
if(TARGET lacuna_mpi)
  foreach(loaded wrong_order count_messages)
    add_library(${loaded} MODULE ranks/${loaded}.c)
    target_compile_options(${loaded} PRIVATE ${warnings})
    target_link_libraries(${loaded} PRIVATE MPI::MPI_C)
  endforeach()
  add_executable(unit_test_pieces ranks/test_pieces.c ${PROJECT_SOURCE_DIR}/src/cli/team/team_mpi.c)
  target_include_directories(unit_test_pieces PRIVATE ${PROJECT_SOURCE_DIR}/src ${CMAKE_CURRENT_SOURCE_DIR})
  target_link_libraries(unit_test_pieces PRIVATE lacuna lacuna_options ${CMOCKA_LIBRARY} MPI::MPI_C)
  add_test(NAME unit.test_pieces COMMAND unit_test_pieces)
  set_tests_properties(unit.test_pieces PROPERTIES LABELS unit)
  set(test_ranks_files $<TARGET_FILE:lacuna_mpi> $<TARGET_FILE:wrong_order> $<TARGET_FILE:count_messages>
      $<TARGET_FILE:fail_at> ${PROJECT_BINARY_DIR})
endif()
lacuna_python_test(test_ranks)

# What is left where a program is killed, or a file call fails, at each third of them in turn; test_every_call.py
# --all takes them all.
set(test_every_call_files $<TARGET_FILE:at_call> --step $<IF:$<BOOL:${LACUNA_SANITIZE}>,7,3>)
lacuna_python_test(test_every_call)

# Streams of readings, watched, killed and gone on with.
set(test_watch_files $<TARGET_FILE:at_call>)
lacuna_python_test(test_watch)

# Trades, stopped and killed ones among them, and runs that keep an accuracy.
set(test_trade_files $<TARGET_FILE:at_call>)
lacuna_python_test(test_trade)

# Sweeps in shards, by hand and by the engines that are there; tools/install-packages --long brings all.
set(test_cluster_files $<TARGET_FILE:at_call>)
lacuna_python_test(test_cluster once)
# Sweeps, their answers and their page.
lacuna_python_test(test_sweep once)
lacuna_python_test(test_sweep_parts once)

# How many of its runs go side by side.
target_sources(unit_test_free_memory PRIVATE ${PROJECT_SOURCE_DIR}/src/cli/common/memory.c)
target_sources(unit_test_pool PRIVATE
  "$<FILTER:$<TARGET_OBJECTS:lacuna_cli>,INCLUDE,common/(keep|memory|pool|progress|words)[.]c>")

# What a scene does not name costs nothing: bytes and threads, counted by a library that sanitizers
# would not let in.
if(NOT LACUNA_SANITIZE)
  add_library(count_bytes MODULE memory/count_bytes.c)
  target_compile_options(count_bytes PRIVATE ${warnings})
  target_link_libraries(count_bytes PRIVATE ${CMAKE_DL_LIBS})
  add_test(NAME case.costs COMMAND ${LACUNA_PYTHON} ${PROJECT_SOURCE_DIR}/tools/studies/costs.py --check
           --lacuna $<TARGET_FILE:lacuna_program> --count $<TARGET_FILE:count_bytes>)
  set_tests_properties(case.costs PROPERTIES LABELS case ENVIRONMENT "${case_environment}")
  if(CMAKE_BUILD_TYPE STREQUAL "Release")
    # Under 20 ms of CPU from start to end, where the machine is quiet.
    add_test(NAME speed.block COMMAND ${LACUNA_PYTHON} ${PROJECT_SOURCE_DIR}/tools/studies/costs.py --quick
             --lacuna $<TARGET_FILE:lacuna_program>)
    set_tests_properties(speed.block PROPERTIES LABELS speed RUN_SERIAL TRUE
                         SKIP_RETURN_CODE 77 ENVIRONMENT "${case_environment}")
  endif()
endif()

# Histories of load, and the commands of the documentation with what they print.
lacuna_python_test(test_history)
if(NOT LACUNA_SANITIZE)
  file(GLOB_RECURSE documented CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/docs/*.md)
  list(FILTER documented EXCLUDE REGEX "howto-friction-law") # test_howto_law follows that one
  if(NOT TARGET lacuna_shared)
    list(FILTER documented EXCLUDE REGEX "howto-embed")
  endif()
  set(pages ${PROJECT_SOURCE_DIR}/README.md)
  foreach(page ${documented})
    file(STRINGS ${page} shown REGEX "^```sh")
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${page})
    if(shown)
      list(APPEND pages ${page})
    endif()
  endforeach()
  foreach(page ${pages})
    get_filename_component(name ${page} NAME_WE)
    add_test(NAME case.${name}
             COMMAND ${LACUNA_PYTHON} ${CMAKE_CURRENT_SOURCE_DIR}/support/run_page.py
                     $<TARGET_FILE:lacuna_program> ${PROJECT_SOURCE_DIR} ${page})
    set_tests_properties(case.${name} PROPERTIES LABELS case TIMEOUT 1200
                         ENVIRONMENT "${case_environment};MPLBACKEND=Agg")
  endforeach()

  # All other commands that the documentation shows.
  set(test_commands_files ${PROJECT_BINARY_DIR})
  lacuna_python_test(test_commands)

  # Names that pages state: of options, keys, variables and attributes, those of the bundled cases' files too.
  set(test_names_files ${CMAKE_CURRENT_BINARY_DIR})
  lacuna_python_test(test_names)
  set_tests_properties(case.test_names PROPERTIES FIXTURES_REQUIRED "${case_outputs}")
endif()

# The library's allocations fail one after the other.
add_executable(unit_test_memory memory/test_memory.c memory/whole_run.c memory/forecast.c
                                 memory/report.c memory/trade.c memory/failing_malloc.c
                                 support/contact_file.c)
target_include_directories(unit_test_memory PRIVATE ${PROJECT_SOURCE_DIR}/src ${CMAKE_CURRENT_SOURCE_DIR})
target_link_libraries(unit_test_memory PRIVATE lacuna lacuna_options lacuna_dependencies
                      ${CMOCKA_LIBRARY})
target_link_options(unit_test_memory PRIVATE
                    -Wl,--wrap=malloc -Wl,--wrap=calloc -Wl,--wrap=realloc -Wl,--wrap=fsync)
add_test(NAME unit.test_memory COMMAND unit_test_memory)
set_tests_properties(unit.test_memory PROPERTIES LABELS unit COST 200 ENVIRONMENT
  "${case_environment};UDUNITS2_XML_PATH=${CMAKE_CURRENT_SOURCE_DIR}/memory/units.xml;OMP_WAIT_POLICY=passive")

# The fractal measures as the program gives them, and the tools that read them.
lacuna_python_test(test_fractal)

# The cascade through the program, of cases and of files.
lacuna_python_test(test_rg)
lacuna_python_test(test_rg_file)
set(test_rg_parts_files $<TARGET_FILE:at_call>)
lacuna_python_test(test_rg_parts)

# The cases of friction show what they say.
lacuna_python_test(test_friction)
lacuna_python_test(test_weakening)

# The indicators of a run, counted again from the cells' own fields.
lacuna_python_test(test_analysis)

# The catalogue of events, found again from the cells' own fields at every step.
lacuna_python_test(test_events once)

# Forecasts of series and runs, wrong series among them.
lacuna_python_test(test_driver)
lacuna_python_test(test_verdict_levels)
lacuna_python_test(test_precursors)

# Files of readings as they come.
lacuna_python_test(test_readings)

# What an engineer is told first.
lacuna_python_test(test_verdict)

# The slopes on which verdicts are measured, and the study that does it.
lacuna_python_test(test_verdicts once)

# Files as tables for a spreadsheet.
lacuna_python_test(test_export)

# The page of a run: its numbers, and what a browser makes of it. tools/install-packages --test
# brings the browser; without it the test fails.
lacuna_python_test(test_report)
lacuna_python_test(test_report_page once)

# The same page while a run goes on, which is held where the tests look at it.
add_library(hold_at_checkpoint MODULE stop/hold_at_checkpoint.c)
target_compile_options(hold_at_checkpoint PRIVATE ${warnings})
set(test_view_files $<TARGET_FILE:hold_at_checkpoint>)
set(test_view_page_files $<TARGET_FILE:hold_at_checkpoint>)
lacuna_python_test(test_view)
lacuna_python_test(test_view_page once)

# Fits, and what they write; the bundled cases for it check.
lacuna_python_test(test_fit)
lacuna_python_test(test_fit_friction once)
lacuna_python_test(test_fit_resume once)
foreach(bundled block century century-undriven velocity-step)
  add_test(NAME case.fit.${bundled}.check
           COMMAND lacuna_program check -q ${PROJECT_SOURCE_DIR}/cases/fit/${bundled}.yaml)
  set_tests_properties(case.fit.${bundled}.check PROPERTIES LABELS case
                       ENVIRONMENT "${case_environment}")
endforeach()

# A friction law made as docs/howto-friction-law.md says, and what its conformance kit says of it.
if(NOT LACUNA_SANITIZE AND NOT LACUNA_FUZZ)
  set(test_howto_law_files ${PROJECT_BINARY_DIR} $<TARGET_FILE:lacuna>)
  lacuna_python_test(test_howto_law)
endif()

# The site of the documentation.
lacuna_python_test(test_site once)

# What shells complete.
lacuna_python_test(test_completion once)

# Built otherwise than by the presets.
if(NOT LACUNA_SANITIZE AND NOT LACUNA_FUZZ)
  lacuna_python_test(test_build)
  if(CMAKE_C_COMPILER_ID STREQUAL "GNU" AND CMAKE_BUILD_TYPE STREQUAL "Release")
    set(test_vector_width_files ${PROJECT_BINARY_DIR} $<TARGET_FILE:lacuna>)
    lacuna_python_test(test_vector_width)
  endif()
endif()

# What is loaded at the start.
lacuna_python_test(test_start)

# What is installed, its .deb, and the Python module, which are of the shared library.
if(TARGET lacuna_shared)
  set(test_install_files ${PROJECT_BINARY_DIR})
  lacuna_python_test(test_install)
  # The notebooks, which take the module, and figures for a publication.
  set(test_pictures_files $<TARGET_FILE:lacuna_shared>)
  lacuna_python_test(test_pictures once)
  set(test_python_files $<TARGET_FILE:lacuna_shared>)
  lacuna_python_test(test_python)
  set(test_door_files $<TARGET_FILE:lacuna_shared>)
  lacuna_python_test(test_door)
endif()
