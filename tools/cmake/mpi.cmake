# SPDX-License-Identifier: GPL-3.0-or-later
# lacuna-mpi, the same program for the ranks of an MPI job, where MPI is. Neither lacuna nor the
# libraries know of MPI: all of it is in src/cli/team/team_mpi.c.
set(LACUNA_MPI AUTO CACHE STRING "Build lacuna-mpi: ON, OFF, or AUTO where MPI is found")
set_property(CACHE LACUNA_MPI PROPERTY STRINGS AUTO ON OFF)
if(NOT LACUNA_MPI OR (LACUNA_MPI STREQUAL AUTO AND (LACUNA_SANITIZE OR LACUNA_FUZZ)))
  return()
endif()
set(MPI_CXX_SKIP_MPICXX ON)
find_package(MPI QUIET COMPONENTS C)
if(NOT MPI_C_FOUND)
  if(NOT LACUNA_MPI STREQUAL AUTO)
    message(FATAL_ERROR "LACUNA_MPI=ON, but there is no MPI: libopenmpi-dev on Debian")
  endif()
  message(STATUS "without MPI (libopenmpi-dev): lacuna-mpi is not built")
  return()
endif()
lacuna_add_program(lacuna_mpi lacuna-mpi team_mpi.c)
target_link_libraries(lacuna_mpi PRIVATE MPI::MPI_C)
