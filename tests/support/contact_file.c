// SPDX-License-Identifier: GPL-3.0-or-later
// The file of a contact, for tests of what it holds and of what may fail on the way.
#include "support/contact_file.h"

lac_status contact_file(const lac_scene_contact *contact, const char *path, bool force,
                        const char *case_text, lac_error *err)
{
    const lac_provenance provenance = {.title = "A map", .case_text = case_text, .seed = INT64_MIN};
    const lac_contact_outcome outcome = {.contact = contact, .status = "complete"};
    lac_dataset *dataset = NULL;
    lac_status status = lac_contact_describe(&outcome, &dataset, err);
    if (status == LAC_OK) {
        status = lac_store_dataset(path, force, &provenance, dataset, err);
    }
    lac_dataset_free(dataset);
    return status;
}
