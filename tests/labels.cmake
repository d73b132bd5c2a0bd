# SPDX-License-Identifier: GPL-3.0-or-later
# What a test is about: one label more for each, so that `ctest -L page` runs what a change of the page can break.
# The other label says how it looks: unit, conform, verify, extreme, case, lint, fuzz, speed.
set(about_physics
  "(conform|verify|extreme)\\..*"
  "unit\\.test_(analysis|answers|benchmark_surface|bootstrap|catalogue_keep|components|contact|contact_control|crest|domain|dyadic|events)"
  "unit\\.test_(forecast_times|fractal_.*|friction|friction_rates|history|joint_surface|load|lump|micro|motion|noise|posterior|series|series_doubts)"
  "unit\\.test_(simulation|skill|spread|sweep_case|surface_.*|tangential|tangential_space|trade|trend|verdict)"
  "case\\.(cases|contact|domain|fit|friction|load|momentum|normal|peers|rg|seas|solver|surface|transfer|weakening)\\..*"
  "case\\.test_(accuracy|analysis|breaks|catalogue|driver|elastic|elastic_limits|events|extremes|fidelity|fit|fit_friction|fractal|friction|geometry|history|loads|loads_over_joint|lumped|ranks)"
  "case\\.test_(precursors|readings|rg|safety|seas|small_cases|sweep|sweep_parts|trade|verdicts?|watch|weakening)|speed\\..*|case\\.costs")
set(about_cli "unit\\.test_pool"
  "case\\.test_(cli|cluster|completion|interface|valid_cases|wrong_cases|static_cases|verdict_levels)")
set(about_data
  "unit\\.test_(dataset|door|load_files|netcdf|recording|store|store_.*|verdict_words)"
  "case\\.test_(branch|domain_file|every_allocation|every_call|export|fit_resume|points|resume|rg_file|rg_parts)")
set(about_page "unit\\.test_(live|report)" "case\\.test_(pictures|report|report_page|view|view_page)")
set(about_docs
  "case\\.(README|format|install|rg-results|tables|vajont|howto-.*|tutorial-.*)"
  "case\\.test_(commands|howto_law|names|site)")
set(about_base
  "unit\\.test_(date|error|filter|free_memory|memory|part|pieces|strip|team|units|units_usual|vector|vmath|write_text)")
set(about_build "case\\.test_(build|door|install|python|start|vector_width)" "lint\\..*")

get_property(tests DIRECTORY PROPERTY TESTS)
foreach(test ${tests})
  set(subjects)
  foreach(subject physics cli data page docs base build)
    list(JOIN about_${subject} "|" any)
    if(test MATCHES "^(${any})$")
      list(APPEND subjects ${subject})
    endif()
  endforeach()
  list(LENGTH subjects count)
  if(NOT count EQUAL 1)
    message(FATAL_ERROR "${test} is about \"${subjects}\": say one thing that it is about in tests/labels.cmake")
  endif()
  set_property(TEST ${test} APPEND PROPERTY LABELS ${subjects})
endforeach()
