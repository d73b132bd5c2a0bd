# SPDX-License-Identifier: GPL-3.0-or-later
# What `cmake --install` puts where: program, library, headers, manual pages, cases.
include(GNUInstallDirs)

if(TARGET lacuna_program)
  install(TARGETS lacuna_program RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
install(TARGETS lacuna ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY ${CMAKE_SOURCE_DIR}/include/lacuna DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY ${CMAKE_SOURCE_DIR}/cases DESTINATION ${CMAKE_INSTALL_DATADIR}/lacuna OPTIONAL
        PATTERN "*.nc" EXCLUDE)
install(FILES ${CMAKE_SOURCE_DIR}/README.md ${CMAKE_SOURCE_DIR}/CITATION.cff
              ${CMAKE_SOURCE_DIR}/CHANGELOG.md
        DESTINATION ${CMAKE_INSTALL_DOCDIR})

# cc program.c $(pkg-config --static --cflags --libs lacuna)
configure_file(${CMAKE_SOURCE_DIR}/cmake/lacuna.pc.in ${CMAKE_BINARY_DIR}/lacuna.pc @ONLY)
install(FILES ${CMAKE_BINARY_DIR}/lacuna.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

# Manual pages, where scdoc is there to make them.
find_program(SCDOC scdoc)
if(SCDOC)
  file(GLOB man_sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/docs/man/*.scd)
  set(man_pages)
  foreach(source ${man_sources})
    get_filename_component(page ${source} NAME_WLE)
    set(page ${CMAKE_BINARY_DIR}/man/${page})
    add_custom_command(OUTPUT ${page}
      COMMAND ${SCDOC} < ${source} > ${page}
      DEPENDS ${source} VERBATIM)
    list(APPEND man_pages ${page})
  endforeach()
  file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/man)
  add_custom_target(man ALL DEPENDS ${man_pages})
  install(FILES ${man_pages} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
endif()
