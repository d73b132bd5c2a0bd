/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "contact/tangential.h"
#include "data/dataset.h"
#include "fractal/fractal.h"
#include "run/run.h"
#include "surface/surface.h"

/// Who made a file, from what. Texts may be NULL: the attribute is then left out.
typedef struct lac_provenance {
    const char *title, *institution, *references;
    const char *case_text;    ///< the whole resolved case
    const char *fidelity;     ///< what a run resolved in time; NULL: there is no run
    const char *fidelity_why; ///< why that; NULL: the case names it
    double fidelity_error;    ///< that it keeps, relative; where `fidelity_why` is not NULL
    const char *lumped;       ///< which cells stand for others, in words; NULL: none do
    const char *accuracy;     ///< what pilot runs picked for which error; NULL: nothing
    double accuracy_asked, accuracy_estimated; ///< relative; where `accuracy` is not NULL
    const char *branch; ///< what it goes on from and how, in words; NULL: it starts by itself
    const char *branch_file, *branch_changes, *branch_case_sum; ///< where `branch` is not NULL
    double branch_time;                                         ///< [s]; also
    const char *command_line;                                   ///< for `history`
    const char *libraries;                                      ///< names and versions
    int64_t seed; ///< of the surface or domain; INT64_MIN: none
    double now;   ///< seconds since 1970, UTC: the library reads no clock
} lac_provenance;

/// Says who writes, when.
void lac_provenance_sign(lac_provenance *provenance, const lac_write_options *options);

/// A checkpoint as it is kept beside the file of its run, in FILE.checkpoint; docs/format.md.
typedef struct lac_checkpoint_file {
    lac_checkpoint from;
    uint64_t records, snapshots, events; ///< in the file by then
    double begun;                        ///< when the file was made first, seconds since 1970
    double last_time;                    ///< of the last of the records [s]
    char *program, *libraries;           ///< that made it, with their versions
    char *case_text;      ///< the whole resolved case, and what the files hold that it names
    unsigned char *bytes; ///< `from` points into them
} lac_checkpoint_file;

/// Reads the checkpoint of a run's file; LAC_EINPUT where there is none.
/// @param out  to be cleared whatever the status
lac_status lac_checkpoint_file_read(const char *path, lac_checkpoint_file *out, lac_error *err);

void lac_checkpoint_file_clear(lac_checkpoint_file *checkpoint);

/// What this program calls itself in a checkpoint: its name and version.
const char *lac_checkpoint_file_program(void);

typedef struct lac_store_def {
    const char *path;
    bool force; ///< replace an existing file
    lac_provenance provenance;
    lac_run_output of;   ///< its extras outlive the store
    bool single;         ///< records and fields but times are written as floats
    int64_t compression; ///< deflate level of the snapshots, 0 to 9
    int64_t sync_every;  ///< records between syncs
    const char *inputs;  ///< what a checkpoint keeps of the files that the run reads; NULL
    const lac_checkpoint_file *resume; ///< the file that is there goes on from it; NULL: a new one
} lac_store_def;

/// A netCDF-4 file being written; docs/format.md.
typedef struct lac_store lac_store;

/// Creates the file with its metadata and status `running`; LAC_EINPUT where one exists without
/// `force`. With `resume` it takes the place of the one that is there once it holds that one's
/// records and snapshots up to the checkpoint.
lac_status lac_store_create(const lac_store_def *def, lac_store **out, lac_error *err);

/// The sink that writes into the store; valid until the store is finished or freed.
lac_sink lac_store_sink(lac_store *store);

/// Writes what is still buffered, `status` ("complete", "failed", "interrupted"), the result and
/// the wall time, and closes the file. A complete one needs its checkpoint no more, which is
/// removed. The store still has to be freed. A full disk shows up here.
lac_status lac_store_finish(lac_store *store, const char *status, const lac_run_result *result,
                            double wall_time, lac_error *err);

/// Whether it has stored a checkpoint.
bool lac_store_has_checkpoint(const lac_store *store);

/// Frees a store; one that was not finished is closed with status `running`. NULL is fine.
void lac_store_free(lac_store *store);

/// Writes a dataset to a netCDF-4 file of its own; docs/format.md.
lac_status lac_store_dataset(const char *path, bool force, const lac_provenance *provenance,
                             const lac_dataset *dataset, lac_error *err);

/// One solved step of a history of normal and shear load.
typedef struct lac_history_record {
    size_t number;   ///< from 1, increments counted
    double area;     ///< nominal [m2]
    double pressure; ///< mean over the nominal area [Pa]
    lac_tangential_stats shear;
    double highest[2];  ///< where q/(f p) is highest [m]; NaN where nothing sticks
    double dissipated;  ///< frictional work since the start [J]
    size_t cycle_start; ///< the step to whose controls this one comes back, 0 the start; SIZE_MAX:
                        ///< to none
    double cycle_dissipation;                     ///< frictional work since then [J]; NaN: to none
    double cycle_shift;                           ///< shift that is left over [m]; NaN: to none
    int64_t contact_iterations, contact_products; ///< of the normal contact; 0: pressure held
} lac_history_record;

/// A step cell by cell, [ny * nx] each.
typedef struct lac_history_maps {
    const double *pressure;              ///< [Pa]
    const double *traction[2], *slip[2]; ///< along x and y [Pa], [m]
    const uint8_t *state;                ///< lac_cell_state
    bool pressed;                        ///< the pressures change on the way
} lac_history_maps;

/// What a file of a history holds of the cells.
typedef enum lac_history_keep { LAC_KEEP_ALL, LAC_KEEP_LAST, LAC_KEEP_NONE } lac_history_keep;

typedef struct lac_history_store_def {
    const char *path;
    bool force; ///< replace an existing file
    lac_provenance provenance;
    lac_dataset *contact; ///< where the history starts; gets its steps, and must outlive it
    lac_history_keep keep;
    bool pressed; ///< of lac_history_maps
} lac_history_store_def;

/// The file of a solved contact with the steps of its history, which are written as they come;
/// docs/format.md.
typedef struct lac_history_store lac_history_store;

/// Creates the file with the contact and status `running`.
lac_status lac_history_store_create(const lac_history_store_def *def, lac_history_store **out,
                                    lac_error *err);

/// Adds a step and has it written to disk; with LAC_KEEP_ALL its maps must follow, with which it is
/// written.
lac_status lac_history_store_step(lac_history_store *store, const lac_history_record *record,
                                  lac_error *err);

/// Writes the cells of the step added last.
lac_status lac_history_store_maps(lac_history_store *store, const lac_history_maps *maps,
                                  lac_error *err);

/// The variables of a step, laid on a lac_history_record; docs/format.md.
/// @param stride  between records that stand one behind the other
lac_variables lac_history_steps(size_t stride);

/// Those of the cells, laid on lac_history_maps: of one step or, as arrays over steps, of all.
lac_variables lac_history_cells(lac_history_keep keep);

/// Writes what attributes of the contact are LAC_LATE and `status`, and closes the file, as
/// lac_store_finish does.
lac_status lac_history_store_finish(lac_history_store *store, const char *status, lac_error *err);

/// Frees a store; one that was not finished is closed with status `running`. NULL is fine.
void lac_history_store_free(lac_history_store *store);

/// Reads a global text attribute.
lac_status lac_store_read_attribute(const char *path, const char *name, char *text, size_t size,
                                    lac_error *err);
