# SPDX-License-Identifier: GPL-3.0-or-later
# What `cmake --install` puts where: program, libraries, headers, Python module, tools that draw, manual
# pages, completions, documentation, cases. Nothing of it knows its place: the whole may be moved.
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME lacuna)
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

if(TARGET lacuna_program)
  install(TARGETS lacuna_program RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
if(TARGET lacuna_mpi)
  install(TARGETS lacuna_mpi RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT mpi)
endif()
if(LACUNA_STATIC)
  install(TARGETS lacuna ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev)
endif()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/lacuna DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT dev)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/cases DESTINATION ${CMAKE_INSTALL_DATADIR}/lacuna OPTIONAL
        PATTERN "*.nc" EXCLUDE)
foreach(folder data peers seas)  # maps and records that cases read; other .nc files are of runs
  file(GLOB read CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/cases/${folder}/*.nc)
  install(FILES ${read} DESTINATION ${CMAKE_INSTALL_DATADIR}/lacuna/cases/${folder})
endforeach()
file(GLOB pages CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/*.md)
install(FILES ${pages} ${PROJECT_SOURCE_DIR}/CITATION.cff DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs DESTINATION ${CMAKE_INSTALL_DOCDIR}
        PATTERN docs/man EXCLUDE)
file(GLOB drawing CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/tools/plot/*.py)
install(PROGRAMS ${drawing} DESTINATION ${CMAKE_INSTALL_DATADIR}/lacuna/tools)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright)

# cc program.c $(pkg-config --cflags --libs lacuna); with --static the static library and all it needs.
list(JOIN LACUNA_LINK_FLAGS " " LACUNA_NEEDS)
if(NOT LACUNA_SHARED)
  set(LACUNA_NEEDS_ALWAYS " ${LACUNA_NEEDS}")
endif()
file(RELATIVE_PATH LACUNA_PC_PREFIX /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
string(REGEX REPLACE "/$" "" LACUNA_PC_PREFIX ${LACUNA_PC_PREFIX})
configure_file(${PROJECT_SOURCE_DIR}/tools/cmake/lacuna.pc.in ${PROJECT_BINARY_DIR}/lacuna.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/lacuna.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT dev)

# find_package(lacuna)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/lacuna)
configure_package_config_file(${PROJECT_SOURCE_DIR}/tools/cmake/lacuna-config.cmake.in
  ${PROJECT_BINARY_DIR}/lacuna-config.cmake INSTALL_DESTINATION ${package}
  NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/lacuna-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/lacuna-config.cmake
              ${PROJECT_BINARY_DIR}/lacuna-config-version.cmake DESTINATION ${package} COMPONENT dev)

# The Python module loads the shared library.
if(TARGET lacuna_shared)
  install(TARGETS lacuna_shared EXPORT lacuna-targets LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
          COMPONENT library NAMELINK_COMPONENT dev)
  install(EXPORT lacuna-targets NAMESPACE lacuna:: DESTINATION ${package} COMPONENT dev)
  install(FILES ${PROJECT_SOURCE_DIR}/tools/python/lacuna.py DESTINATION lib/python3/dist-packages
          COMPONENT python)
endif()
if(TARGET lacuna_shared AND TARGET lacuna_program AND LACUNA_PYTHON)
  add_custom_target(wheel COMMAND ${LACUNA_PYTHON} ${PROJECT_SOURCE_DIR}/tools/python/make-wheel
                    $<TARGET_FILE:lacuna_program> $<TARGET_FILE:lacuna_shared> ${PROJECT_BINARY_DIR} VERBATIM)
endif()

# Manual pages, where scdoc is there to make them; in man1 `man` finds them by the PATH of build/lacuna.
find_program(SCDOC scdoc)
if(SCDOC)
  file(GLOB man_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/docs/man/*.scd)
  set(man_pages)
  foreach(source ${man_sources})
    get_filename_component(page ${source} NAME_WLE)
    set(page ${PROJECT_BINARY_DIR}/man/man1/${page})
    add_custom_command(OUTPUT ${page}
      COMMAND ${SCDOC} < ${source} > ${page}
      DEPENDS ${source} VERBATIM)
    list(APPEND man_pages ${page})
  endforeach()
  file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/man/man1)
  add_custom_target(man ALL DEPENDS ${man_pages})
  install(FILES ${man_pages} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
endif()

# Words for shells, which the program writes itself.
if(TARGET lacuna_program)
  file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/completion)
  set(completions)
  foreach(shell bash zsh fish)
    set(words ${PROJECT_BINARY_DIR}/completion/lacuna.${shell})
    add_custom_command(OUTPUT ${words}
      COMMAND lacuna_program completion ${shell} > ${words}
      DEPENDS lacuna_program VERBATIM)
    list(APPEND completions ${words})
  endforeach()
  add_custom_target(completion ALL DEPENDS ${completions})
  install(FILES ${PROJECT_BINARY_DIR}/completion/lacuna.bash RENAME lacuna
          DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
  install(FILES ${PROJECT_BINARY_DIR}/completion/lacuna.zsh RENAME _lacuna
          DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions)
  # where zsh looks below /usr/local, and anywhere but on Debian
  install(FILES ${PROJECT_BINARY_DIR}/completion/lacuna.zsh RENAME _lacuna
          DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
  install(FILES ${PROJECT_BINARY_DIR}/completion/lacuna.fish
          DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
endif()
# The documentation as static pages, where mkdocs is there to make them.
if(LACUNA_PYTHON)
  add_custom_target(site COMMAND ${LACUNA_PYTHON} ${PROJECT_SOURCE_DIR}/tools/dev/docs_site.py
                    --output ${PROJECT_BINARY_DIR}/site VERBATIM)
endif()
include(tools/cmake/package.cmake)
