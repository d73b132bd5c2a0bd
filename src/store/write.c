// SPDX-License-Identifier: GPL-3.0-or-later
// A dataset to its file, as users of the library have it written.
#include <math.h>

#include "base/ask.h"
#include "data/dataset.h"
#include "store/store.h"

void lac_provenance_sign(lac_provenance *provenance, const lac_write_options *options)
{
    provenance->now = options->now != 0.0 ? options->now : NAN;
    provenance->command_line = options->command_line;
    provenance->libraries = options->libraries;
}

lac_status lac_dataset_write(const lac_dataset *dataset, const char *path,
                             const lac_write_options *options, lac_error *err)
{
    lac_write_options own = lac_write_options_default();
    lac_status status;
    LAC_TRY(LAC_NEED(err, dataset, path));
    LAC_TRY(lac_take_options("lac_write_options", options, &own, sizeof own, err));
    lac_provenance made =
        dataset->made != NULL ? *dataset->made : (lac_provenance){.seed = INT64_MIN};
    lac_provenance_sign(&made, &own);
    status = lac_store_dataset(path, own.force, &made, dataset, err);
out:
    return status;
}
