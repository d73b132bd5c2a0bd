# SPDX-License-Identifier: GPL-3.0-or-later
# Read by cpack when all files of the packages are in place: everyone may read them, whatever the umask was.
execute_process(COMMAND chmod -R u=rwX,go=rX ${CPACK_TEMPORARY_DIRECTORY} COMMAND_ERROR_IS_FATAL ANY)
