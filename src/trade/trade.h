/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "scene/scene.h"

/// Error against cost of a case under the settings that trade one for the other; docs/trade.md.

enum { LAC_SETTINGS = 12, LAC_SETTING_VALUES = 16, LAC_SETTING_LABEL = 32, LAC_SETTING_YAML = 64 };

/// One position of a setting.
typedef struct lac_setting_value {
    char label[LAC_SETTING_LABEL]; ///< as tables have it: "1e-05", "elastic"
    char yaml[LAC_SETTING_YAML];   ///< what `--set KEY=` takes
} lac_setting_value;

/// What is computed, and what a setting belongs to (several of them with |).
typedef enum lac_trade_of {
    LAC_OF_RUN = 1,     ///< a run in time
    LAC_OF_CASCADE = 2, ///< the cascade of a case with a section rg
    LAC_OF_CONTACT = 4, ///< a contact that is pressed, and sheared where it has a history
} lac_trade_of;

/// A setting that trades accuracy for cost.
typedef struct lac_setting {
    const char *name, *key; ///< "method", "solver.method"
    unsigned asked;         ///< lac_trade_of whose trades turn it only where it is named
    bool scene;             ///< it changes what is computed, not only how well
    unsigned use;           ///< lac_trade_of
    bool falls;             ///< of a ladder: a finer position is a smaller number
    double ratio;           ///< its positions are a ladder from coarse to fine; that errors fall by
                            ///< more than this a rung is not believed; 0: no ladder
    const char *cascade;    ///< the label at which the cascade is computed, else a run; NULL: the
                            ///< setting does not choose between them
    const char *coarse;     ///< the label of a position with keys of its own; NULL
    const char *coarse_keys; ///< these, which a case may hold for that position alone
    /// Its positions on this case, the coarsest and cheapest first.
    /// @param of   what is traded
    /// @param out  [LAC_SETTING_VALUES]
    /// @return how many; 0: nothing to turn on this case
    size_t (*values)(const lac_case *c, lac_trade_of of, lac_setting_value *out);
    double finer;  ///< of a ladder: the reference's number over the last one; 0: that is it
    double finest; ///< beyond which it does not go
} lac_setting;

/// The index-th setting, NULL past the end. The first is rtol.
const lac_setting *lac_setting_get(size_t index);

/// A position that is a number.
lac_setting_value lac_setting_number(double value);

/// The label of the position that a case has.
void lac_setting_current(const lac_setting *setting, const lac_case *c,
                         char label[LAC_SETTING_LABEL]);

/// What a user wants to know of a scene.
typedef enum lac_quantity {
    LAC_QUANTITY_FAILURE = 0, ///< time of failure since the start [s]
    LAC_QUANTITY_LIMIT,       ///< time at which a limit of time.stop_when is reached [s]
    LAC_QUANTITY_SLIP,        ///< mean slip at the end [m]
    LAC_QUANTITY_RATE,        ///< mean slip rate at the end [m/s]
    LAC_QUANTITY_PEAK,        ///< largest slip rate of a cell at any record [m/s]
    LAC_QUANTITY_CRITICAL,    ///< Q_crit/Q_nom: of the cascade, of a run the largest Q/Q_nom [1]
    LAC_QUANTITY_EVENTS,      ///< events of the catalogue [1]
    LAC_QUANTITY_FRACTION,    ///< contact cells over all cells [1]
    LAC_QUANTITY_PRESSURE,    ///< mean normal pressure, where approach or dimension ask for it [Pa]
    LAC_QUANTITY_DIMENSION,   ///< box dimension of the contact [1]
    LAC_QUANTITY_WORK,        ///< frictional work of a contact's history [J]
    LAC_QUANTITIES
} lac_quantity;

/// What a quantity is called on the command line, its SI unit, and what it is.
typedef struct lac_quantity_about {
    const char *name, *unit, *doc;
    bool contact; ///< of a contact, not of a run
} lac_quantity_about;

extern const lac_quantity_about lac_quantities[]; ///< by lac_quantity; the name of the last is NULL

/// A setting with the positions that are to be tried.
typedef struct lac_trade_setting {
    const lac_setting *setting;
    size_t count; ///< positions
    size_t shown; ///< of which the first so many are tried; those after are for the reference only
    bool named;   ///< they are those that were asked for
    lac_setting_value value[LAC_SETTING_VALUES];
} lac_trade_setting;

/// Why a run is made.
enum { LAC_TRADE_TRIED = 1, LAC_TRADE_REFERENCE = 2, LAC_TRADE_CHECK = 4 };

/// How a run of a trade ended.
typedef enum lac_trade_end {
    LAC_TRADE_PENDING = 0,
    LAC_TRADE_DONE,
    LAC_TRADE_BROKEN,   ///< the computation failed
    LAC_TRADE_GIVEN_UP, ///< it took too long
    LAC_TRADE_REFUSED,  ///< the settings do not go together
    LAC_TRADE_TWIN,     ///< the same settings as another run
    LAC_TRADE_RUNNING,  ///< now
} lac_trade_end;

/// What was measured of a run: numbers all, so that they are kept as one row.
typedef struct lac_trade_measure {
    double wall_time, cpu_time;       ///< [s]
    double memory, output;            ///< peak, size of its file [bytes]
    double steps, evaluations, cells; ///< of the right-hand side; of a contact its solver's
                                      ///< iterations and elastic products
    double value[LAC_QUANTITIES];     ///< NaN: has none
} lac_trade_measure;

/// A combination of positions, and what came of it.
typedef struct lac_trade_run {
    const struct lac_trade *of;                  ///< once it is judged
    short at[LAC_SETTINGS];                      ///< [settings] position; -1: as the case has it
    int why;                                     ///< LAC_TRADE_*
    uint64_t key;                                ///< of the whole resolved case and its files
    char label[LAC_SETTINGS][LAC_SETTING_LABEL]; ///< of every setting, as its case has it
    lac_trade_end end;
    lac_trade_measure m;
    char message[240];  ///< what went wrong
    double value;       ///< of the quantity; NaN: has none
    double error;       ///< from the reference's, relative; NaN
    double uncertainty; ///< estimated error of the reference itself, relative; NaN: not known
    bool on_front;      ///< no other run errs and costs less
} lac_trade_run;

/// A trade. The reference has the finest position of every ladder and, of settings that change the
/// scene, the last one; for each ladder two more runs, one and two rungs coarser, tell how far it
/// is from its limit.
typedef struct lac_trade {
    lac_trade_of of; ///< what is computed; of a cascade, but where the fidelity is another one
    size_t settings, runs;
    lac_trade_setting setting[LAC_SETTINGS];
    char own[LAC_SETTINGS][LAC_SETTING_LABEL]; ///< their labels in the case as it is
    lac_trade_run *run;                        ///< [runs]
    size_t ladder; ///< setting whose rungs every other position is tried on; SIZE_MAX
    size_t finest; ///< run that is to be the reference
    size_t coarser[LAC_SETTINGS][2]; ///< those one and two rungs coarser; SIZE_MAX: there is none
    // What it came to, once it is judged.
    int quantity;
    const lac_trade_run *reference;   ///< the tightest that was done
    const lac_trade_run *recommended; ///< NULL: none does what was asked
    const lac_trade_run *closest;     ///< what comes closest
    size_t rows, refusals;
    const lac_trade_run **row; ///< [rows + refusals] those tried, in the order of a table; refused
    // What is told beside it.
    const char *title;   ///< NULL: none
    char sentence[1024]; ///< what to choose
    double wall_time;    ///< [s]
    const char *path;    ///< of its file
} lac_trade;

/// Plans a trade.
/// @param words     "rtol,method" or with positions of one's own, from coarse to fine,
///                  "rtol=1e-3:1e-6,levels"; NULL: all that do not change the scene
/// @param crossed   every position with every other; else each with those of the first ladder only
/// @return LAC_OK; LAC_EINPUT (no such setting, nothing to turn, a case with solver.accuracy ...);
///         LAC_ENOMEM
lac_status lac_trade_create(const lac_case *c, lac_trade_of of, const char *words, bool crossed,
                            lac_trade *out, lac_error *err);
void lac_trade_clear(lac_trade *trade);

/// What is computed by a run of the trade.
lac_trade_of lac_trade_of_run(const lac_trade *trade, const lac_trade_run *run);

/// Whether two runs differ in nothing but the rung of the ladder, and `a` is coarser.
bool lac_trade_is_coarser(const lac_trade *trade, const lac_trade_run *a, const lac_trade_run *b);

/// What is asked for.
typedef struct lac_trade_request {
    int quantity; ///< lac_quantity; -1: time of failure, else of the limit, else slip; of a cascade
                  ///< Q_crit/Q_nom; of a contact its fraction
    double reach; ///< relative error to reach [1]; NaN
    double within;    ///< the same as an amount; NaN
    double budget;    ///< time that a run may take [s]; NaN
    const char *unit; ///< SI unit of `within`, to be the quantity's; NULL: it is
} lac_trade_request;

/// Error of the finest of three values on a ladder, by Richardson's extrapolation, and at least a
/// twentieth of what the rung before the last changed; where they do not converge, what the last
/// one did.
/// @param coarse  NaN: only two values
/// @param ratio   that errors fall by more than this a rung is not believed
/// @return >= 0; NaN where `middle` or `fine` is
double lac_richardson_error(double coarse, double middle, double fine, double ratio);

/// Marks the tried runs that are not beaten: no other costs no more CPU time and errs no more, and
/// one of the two less. Errors below `floor` count as the same.
void lac_pareto_front(size_t n, lac_trade_run *run, double floor);

/// Judges the runs, and lists them.
/// @return LAC_OK; LAC_EINPUT where the reference has no such quantity, or it has another unit;
///         LAC_ENUMERIC where no run that could be the reference was done; LAC_ENOMEM
lac_status lac_trade_judge(lac_trade *trade, const lac_trade_request *ask, lac_error *err);

/// The command that the settings of a run are for, and one word for how it ended.
const char *lac_trade_command(const lac_trade_run *run);
const char *lac_trade_end_name(lac_trade_end end);

/// All settings of a run, as "solver.rtol=1e-05 solver.method=bdf"; those that differ from the
/// case's own, as `--set KEY=VALUE --set ...`, "" where none do.
const char *lac_trade_settings_text(const lac_trade_run *run, char text[LAC_TEXT_ROOM]);
const char *lac_trade_options(const lac_trade_run *run, char text[LAC_TEXT_ROOM]);

/// The variables of a trade that is judged, for a file or JSON; docs/format.md.
/// @param trade  must outlive the dataset
/// @return LAC_OK; LAC_ENOMEM
lac_status lac_trade_describe(const lac_trade *trade, lac_dataset **out, lac_error *err);
