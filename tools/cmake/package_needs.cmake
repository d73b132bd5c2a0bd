# SPDX-License-Identifier: GPL-3.0-or-later
# Read by cpack before it begins: without these programs its package would have no dependencies.
find_program(LACUNA_FILE file)
find_program(LACUNA_SHLIBDEPS dpkg-shlibdeps)
if(NOT LACUNA_FILE OR NOT LACUNA_SHLIBDEPS)
  message(FATAL_ERROR "a .deb needs the programs file and dpkg-shlibdeps: apt-get install file dpkg-dev")
endif()
