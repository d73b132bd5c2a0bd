# SPDX-License-Identifier: GPL-3.0-or-later
# The one Python of all tests and of the site: the first on the path, then of the system, that has what
# they import. -DLACUNA_PYTHON=PROGRAM is another.
function(lacuna_python_serves result program)
  execute_process(COMMAND ${program} -c "from importlib.util import find_spec
assert all(map(find_spec, ('numpy', 'xarray', 'netCDF4', 'matplotlib')))"
    RESULT_VARIABLE failed OUTPUT_QUIET ERROR_QUIET)
  if(NOT failed EQUAL 0)
    set(${result} FALSE PARENT_SCOPE)
  endif()
endfunction()
find_program(LACUNA_PYTHON python3 VALIDATOR lacuna_python_serves
             DOC "Python with NumPy, xarray, netCDF4 and matplotlib")
