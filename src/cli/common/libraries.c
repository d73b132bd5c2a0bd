// SPDX-License-Identifier: GPL-3.0-or-later
// The versions of the libraries in use, as they tell them themselves at run time: the one file
// besides each library's home that includes its header, and for nothing else. Of SUNDIALS and
// netCDF, which may not be open, those that the program was built with. UDUNITS and Random123 do
// not tell theirs.
#include "cli/common/output.h"

#include <fftw3.h>
#include <gsl/gsl_version.h>
#include <netcdf_meta.h>
#include <sundials/sundials_config.h>
#include <yaml.h>

void cli_libraries(char *text, size_t size)
{
    const char *fftw = strchr(fftw_version, '-'); // "fftw-3.3.10-sse2-avx"
    fftw = fftw == NULL ? fftw_version : fftw + 1;
    (void)snprintf(text, size, "SUNDIALS %s, FFTW %.*s, GSL %s, libyaml %s, UDUNITS 2, Random123",
                   SUNDIALS_VERSION, (int)strcspn(fftw, "-"), fftw, gsl_version,
                   yaml_get_version_string());
}

const char *cli_netcdf_version(void) { return NC_VERSION; }
