# SPDX-License-Identifier: GPL-3.0-or-later
# Debian's hardening of programs (stack protector, fortified functions, all symbols bound at the start and
# then read-only) for what is released, as a package of it ought to have; dpkg-dev says which words these are.
option(LACUNA_HARDENED "Harden Release builds with Debian's flags, where dpkg-dev is" ON)
find_program(DPKG_BUILDFLAGS dpkg-buildflags)
if(NOT LACUNA_HARDENED OR NOT DPKG_BUILDFLAGS OR NOT CMAKE_BUILD_TYPE STREQUAL "Release" OR LACUNA_SANITIZE)
  return()
endif()
foreach(kind CPPFLAGS CFLAGS LDFLAGS)
  execute_process(COMMAND ${CMAKE_COMMAND} -E env DEB_BUILD_MAINT_OPTIONS=hardening=+all
                          ${DPKG_BUILDFLAGS} --get ${kind}
                  OUTPUT_VARIABLE said OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX MATCHALL "-D_FORTIFY_SOURCE=[0-9]|-fstack-[a-z-]+|-fcf-[a-z]+|-Wl,-z,[a-z]+" words "${said}")
  if(kind STREQUAL "LDFLAGS")
    add_link_options(${words})
  else()
    add_compile_options(${words})
  endif()
endforeach()
