/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "cli/common/options.h"
#include "store/store.h"

/// The file a command writes: -o, else `configured`, else the case's name with `ending` in place
/// of its extension, in the working folder, checked as `cli_output_check` does.
/// @param configured  output.file of the case; NULL: none
/// @param path        the caller frees
/// @return LAC_OK; LAC_EINPUT (exists and no --force, is one of the command's own inputs); LAC_EIO
///         (no such folder, not writable); LAC_ENOMEM
lac_status cli_output_path(const cli_request *request, const lac_case *c, const char *configured,
                           const char *ending, char **path, lac_error *err);

/// FOLDER/NAME.EXT as NAME and an ending, in the working folder. To be freed; NULL without memory.
char *cli_name_after(const char *path, const char *ending);

/// Length of a name without its ending, such as ".nc"; the whole where it has another, or none
/// before it.
size_t cli_stem(const char *name, const char *ending);

/// The request of a command that with --resume goes on from what it keeps, not from its output.
/// @param replaces  which it then may replace: it may hold what an interrupt left
cli_request cli_request_anew(const cli_request *request, bool replaces);

/// Checks, before anything is computed, that a file can be written, is not there already and is
/// none that the command reads.
/// @param c  NULL: the command reads no case
/// @return as `cli_output_path`
lac_status cli_output_check(const cli_request *request, const lac_case *c, const char *path,
                            lac_error *err);

/// Says who makes a file, when, with what: texts of the request.
void cli_sign(const cli_request *request, lac_provenance *provenance);

/// What a file says of its case and who made it.
/// @param case_text  borrowed
lac_provenance cli_provenance(const cli_request *request, const lac_case *c, const char *case_text);

/// Writes the file of a case's result; --force replaces one that is there.
/// @param seed  of the result; INT64_MIN: the case's own
/// @return as lac_store_dataset
lac_status cli_store_dataset(const cli_request *request, const lac_case *c, int64_t seed,
                             const char *path, lac_dataset *dataset, lac_error *err);

/// Makes ready for --pipe: what is printed from now on is dropped, but what cli_put_dataset does.
lac_status cli_pipe_open(cli_request *request, lac_error *err);

/// Writes a dataset to its file; with --pipe to standard output instead, once.
/// @param made  says what the dataset's own does not
/// @return as lac_store_dataset
lac_status cli_put_dataset(const cli_request *request, bool force, const lac_provenance *made,
                           const char *path, lac_dataset *dataset, lac_error *err);

/// Prints a result as one JSON object on stdout, behind it CPU time and the file.
void cli_print_json(const lac_dataset *dataset, const char *path);

/// What the files that a case names hold: a section `files:` with a line `NAME: CHECKSUM` for each,
/// "" where it names none. To be freed; NULL where memory is short.
char *cli_inputs_sums(const lac_case *c);

/// Checksum of what a command's results follow from: the case, its files, the program.
/// @return LAC_OK; LAC_ENOMEM
lac_status cli_case_sum(const cli_request *request, const lac_case *c, uint64_t *sum,
                        lac_error *err);

/// Version of netCDF.
const char *cli_netcdf_version(void);
