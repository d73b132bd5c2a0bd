/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "fit/fit.h"
#include "run/sensitivity.h"

// Of derivatives, and of everything else: what a run's error moves the slip by is far below what is
// read.
#define LAC_FIT_TIGHT 1e-8
#define LAC_FIT_LOOSE 1e-7

// A copy of the case that can take other values, and the scene made of it.
typedef struct lac_fit_variant {
    lac_case *c;
    double *at[LAC_MOST_FITTED]; // where its parameters are
    lac_scene *scene;            // NULL: not made, or its values make none
} lac_fit_variant;

// What one thread needs to run the case with other values.
typedef struct lac_fit_model {
    const struct lac_fit *fit;
    lac_load_files *files;
    lac_fit_variant base;
    lac_points *points;      // of the base, the one that the readings are of; NULL: none named
    lac_fit_variant *nudged; // [2 parameters] a little less, a little more of each; NULL: not made
    double rtol;             // of its runs: LAC_FIT_TIGHT or LAC_FIT_LOOSE
    double *scratch;         // [5 readings] of the likelihood
} lac_fit_model;

enum { LAC_FIT_NODES = 24 }; // in the window of a time that is known within it only

// A row of the readings' file that was taken, as it stands there.
typedef struct lac_fit_seen {
    double time;         // since the start [s]
    double displacement; // [m], or friction [1]; NaN
    double sigma;        // what its error counts in [m]
    double velocity;     // [m/s]; NaN
    double most;         // that a velocity did not exceed [m/s]; NaN
    double rate_sigma;   // what the error of the logarithm of either counts in [1]
    double within;       // half the window of the time [s]
} lac_fit_seen;

// A velocity, or what it did not exceed, with an error and a window of its own (rates.c).
typedef struct lac_fit_rate {
    double value; // ln of m/s
    double sigma; // what its error counts in [1]
    bool bound;   // it was not exceeded anywhere in the window
    size_t row;   // of the file
    size_t count; // looks at the run
    size_t at[LAC_FIT_NODES];
} lac_fit_rate;

// The readings on the clock of the run, rising: one a look at the run, which sees either one row of
// the file, or a node of the window of a rate.
typedef struct lac_fit_data {
    size_t n;
    double *time;         // [n] since the start [s]
    double *displacement; // [n] [m], or friction [1]; NaN
    double *log_rate;     // [n] of m/s; NaN
    double *sigma;        // [n] what a displacement's error counts in [m]: 1 without a column
    double digit;         // what the last of a displacement counts [m]; 0: not known
    size_t displacements, velocities, outside, missing, not_positive;
    size_t bounds; // of the velocities
    size_t rows;   // of the file that were taken
    lac_fit_seen *seen;
    size_t rates; // 0: velocities are in log_rate; else in `rate`, and log_rate is NaN
    lac_fit_rate *rate;
    double weight[LAC_FIT_NODES]; // of the nodes of a window
} lac_fit_data;

// Errors of the data. Each is fixed by the case, or one of the unknowns.
typedef struct lac_fit_errors_at {
    double displacement; // of a displacement, or factor on its sigma
    double velocity;     // of ln v
    double time;         // over which errors of displacements are correlated [s]; 0: not
} lac_fit_errors_at;

// What the readings' errors come to.
typedef struct lac_fit_misfit {
    double log_likelihood;
    double peak;   // ln of the likelihood with the best offset, not integrated over it
    double offset; // best zero of the displacements [m]
} lac_fit_misfit;

// Which unknowns the sampler straightens, and what it needs of the law for it (line.c).
typedef struct lac_fit_straight {
    bool used;
    int dc, x, a, b;       // index among the unknowns; -1: held
    double held_a, held_b; // where held
} lac_fit_straight;

// What takes the bend out of the walkers' valley (shear.c).
typedef struct lac_fit_shear {
    bool used;
    size_t pivot, dimension;
    double mean, width;             // of the pivot
    double third, fourth, share;    // its moments, of which q2 and q3 are made
    double by[LAC_FIT_UNKNOWNS][2]; // what each coordinate has of q2 and q3
} lac_fit_shear;

struct lac_fit {
    const lac_case *source;
    const lac_fit_def *def;
    char *text; // of the case, from which copies are read
    lac_fit_data data;
    bool friction;               // it is in the place of displacements
    bool offset;                 // of displacements is unknown
    double held_error;           // of either [m], [1]; NaN: unknown
    bool moves_loads, moves_all; // parameters of loads, of what the contact is made of
    int threads;
    lac_fit_model *model; // [threads]
    size_t unknowns;
    int unknown_displacement, unknown_velocity, unknown_time; // index among the unknowns; -1: fixed
    double low[LAC_FIT_UNKNOWNS], high[LAC_FIT_UNKNOWNS];     // coordinates; infinite: no bound
    double best[LAC_FIT_UNKNOWNS];                            // coordinates
    double covariance[LAC_MOST_FITTED][LAC_MOST_FITTED];      // of the least squares
    int by[LAC_MOST_FITTED];
    int64_t runs;
    lac_fit_straight straight;
    lac_fit_shear shear;
    lac_chain *chain;
    double *kept; // arrays of the result
};

// model.c: a case with other values, run.
lac_status lac_fit_model_create(const lac_fit *fit, lac_fit_model *model, lac_error *err);
void lac_fit_model_clear(lac_fit_model *model);

// Runs the case at coordinates u up to `end` and looks at given times.
// @return LAC_OK (also where it fails on the way: out->reached tells); what a scene or a run
// returns
lac_status lac_fit_model_run(lac_fit_model *model, const double *u, double end, size_t n,
                             const double *time, lac_sensitivity *out, lac_error *err);

// What the case says at the readings, [n] each, at coordinates u.
// @return as lac_fit_model_run; LAC_ENUMERIC where the run fails before the last reading
lac_status lac_fit_model_read(lac_fit_model *model, const double *u, double *slip, double *log_rate,
                              lac_error *err);

// The readings with derivatives by every coordinate. @param by  [parameters] set: how
// @return LAC_OK; LAC_ENUMERIC where the run fails before the last reading; as above
lac_status lac_fit_model_differentiate(lac_fit_model *model, const double *u, lac_sensitivity *out,
                                       int *by, lac_error *err);

// The time of failure, to time.end, with derivatives; NaN by parameters that the run cannot be
// differentiated by. @param out  failure_by is [parameters]
lac_status lac_fit_model_failure(lac_fit_model *model, const double *u, lac_sensitivity *out,
                                 lac_error *err);

// Puts values at coordinates u into a case.
void lac_fit_put(const lac_fit_def *def, const double *u, double *const *at);

// likelihood.c
// Whitened residuals of the displacements and of what an offset would add, and ln of the
// determinant of their covariance.
double lac_fit_whiten(const lac_fit_data *data, const lac_fit_errors_at *errors, const double *r,
                      double *white);

// What an offset of 1 adds to them, and the best one taken out of them. @return its weight
void lac_fit_whiten_one(const lac_fit_data *data, const lac_fit_errors_at *errors, double *one);
double lac_fit_take_offset(size_t n, const double *one, double *white, double *offset);

// ln of the likelihood, the offset integrated out. @param scratch  [3 n]
lac_fit_misfit lac_fit_likelihood(const lac_fit *fit, const lac_fit_errors_at *errors,
                                  const double *slip, const double *log_rate, double *scratch);

// Errors at the unknowns x.
lac_fit_errors_at lac_fit_errors_of(const lac_fit *fit, const double *x);

// Sets the unknown errors among the coordinates x to those for which residuals are
// likeliest.
// @param r            [n] of displacements, before the offset
// @param by_log_rate  [n] of ln v; NaN where not given
// @param log_rate     [n] ln v of the run
// @param scratch      [2 n]
void lac_fit_likeliest_errors(const lac_fit *fit, const double *r, const double *by_log_rate,
                              const double *log_rate, double *scratch, double *x);

// rates.c
// Whether a case names what rates need.
bool lac_fit_has_rates(const lac_fit_def *def);

// Makes rates of the rows, and the looks at a run up to `end` that these and displacements need.
lac_status lac_fit_look_at_rates(lac_fit_data *data, double end, lac_error *err);

// ln of their likelihood. @param error  factor on their sigmas  @param log_rate  [n] of a run
double lac_fit_rates_likelihood(const lac_fit_data *data, double error, const double *log_rate);

// What least squares see of one: its square is -2 ln of the likelihood but for the constant of a
// normal density; and its derivative from those of log_rate, by[i stride].
double lac_fit_rate_residual(const lac_fit_data *data, const lac_fit_rate *rate, double error,
                             const double *log_rate);
double lac_fit_rate_slope(const lac_fit_data *data, const lac_fit_rate *rate, double error,
                          const double *log_rate, const double *by, size_t stride);

// ln(read/run) where in the window it is likeliest to have been read; of a bound what it is
// exceeded by, <= 0.
double lac_fit_rate_off(const lac_fit_data *data, const lac_fit_rate *rate, double error,
                        const double *log_rate);

// The share of readings that would lie below this one; of a bound, how likely it is kept.
double lac_fit_rate_rank(const lac_fit_data *data, const lac_fit_rate *rate, double error,
                         const double *log_rate);

// ln of the likeliest error between ln low and ln high.
double lac_fit_likeliest_rate_error(const lac_fit_data *data, const double *log_rate, double low,
                                    double high);

// Off the centre of a normal prior, in its widths; 0 where the prior is none.
double lac_fit_prior_residual(const lac_fit_parameter *p, double u);

// ln of the prior, up to a constant; -INFINITY outside the ranges.
double lac_fit_log_prior(const lac_fit *fit, const double *x);

// least_squares.c: starts, then the trust region from the best of them; sets fit->best and
// fit->covariance.
lac_status lac_fit_least_squares(lac_fit *fit, const lac_fit_watch *watch, lac_fit_result *result,
                                 lac_error *err);

// A draw from the prior; `which` tells one from another. @param x  [unknowns]
void lac_fit_draw_prior(const lac_fit *fit, uint64_t which, double *x);

// judge.c: residuals and time of failure of the best fit.
lac_status lac_fit_judge(lac_fit *fit, lac_fit_result *result, lac_error *err);

// Correlations, principal axes and the shape of one block.
lac_status lac_fit_identify(lac_fit *fit, lac_fit_result *result, lac_error *err);

// line.c: the coordinates that walkers live in, z, all of them over the whole line.
// Whether the case is a block under the aging law whose rate and ratio at the start are given.
bool lac_fit_is_one_block(const lac_case *c);
lac_fit_straight lac_fit_straighten(const lac_fit *fit);
// @return ln of |du/dz|
double lac_fit_from_line(const lac_fit *fit, const double *z, double *u);
void lac_fit_to_line(const lac_fit *fit, const double *u, double *z);

// The shear of the places where a chain ended; none where it would gain little.
lac_status lac_fit_find_shear(lac_fit *fit, lac_error *err);

// Onto sheared coordinates, or with sign -1 back.
void lac_fit_shear_to(const lac_fit_shear *shear, double sign, double *z);

// posterior.c: the sampler, its quantiles and what follows from the draws.
lac_status lac_fit_sample(lac_fit *fit, const lac_fit_watch *watch, lac_fit_result *result,
                          lac_error *err);

// predict.c
lac_status lac_fit_predict(lac_fit *fit, const lac_fit_watch *watch, lac_fit_result *result,
                           lac_error *err);

static inline bool lac_fit_bounded(const lac_fit *fit, size_t k)
{
    return isfinite(fit->high[k] - fit->low[k]);
}

// The value of a coordinate.
static inline double lac_fit_value(bool log_scale, double u) { return log_scale ? exp(u) : u; }

// Quantiles of the result, of n numbers, which are sorted; INFINITY counts as a number.
void lac_fit_quantiles(size_t n, double *x, double quantile[LAC_FIT_QUANTILES]);
