// SPDX-License-Identifier: GPL-3.0-or-later
// Heights from a spectrum, and what becomes of waves too short for the grid.
#include "surface/synthesis.h"

const char *const lac_sampling_words[] = {"low-pass", "point", "block-mean", NULL};

// Waves of a band that are summed one by one.
static const double most_waves = 1e9;

typedef double _Complex (*mode_function)(const void *of, double kx, double ky);

// A wavenumber this close to the edge of the band is inside: lengths carry rounding.
static const double edge = 1.0 + 1e-9;
// Modes summed one by one for the variance of the band; those beyond are integrated.
static const double summed_modes = 1e6;

// Length of the wave vector with lengths along `direction` drawn in by the stretch.
static double drawn(const lac_band *b, double qx, double qy)
{
    if (b->stretch == 1.0) {
        return hypot(qx, qy);
    }
    return hypot(b->stretch * (qx * b->cosine + qy * b->sine), qy * b->cosine - qx * b->sine);
}

// C(q) up to a factor: flat to the rolloff, a power law to the shortest wave, zero beyond.
static double density(const lac_band *b, double q)
{
    if (q > b->q_shortest * edge) {
        return 0.0;
    }
    return q <= b->q_rolloff ? 1.0 : pow(q / b->q_rolloff, -b->power);
}

// C |q|^moment of mode (kx, ky)
static double term(const lac_band *b, double kx, double ky, int moment)
{
    double qx = kx * b->dqx, qy = ky * b->dqy;
    double c = density(b, drawn(b, qx, qy));
    return moment == 0 ? c : c * (qx * qx + qy * qy);
}

// Integral of q^(n-1) from a to c
static double flat_integral(double a, double c, int n)
{
    switch (n) {
    case 1:
        return c - a;
    case 2:
        return 0.5 * (c * c - a * a);
    default:
        return (pow(c, n) - pow(a, n)) / n;
    }
}

// Integral of q^(d+moment-1) C(q) from a to the shortest wave, in d dimensions.
static double integral(const lac_band *b, double a, int d, int moment)
{
    int n = d + moment;
    double sum = 0.0, q_r = b->q_rolloff, end = b->q_shortest;
    double flat = fmin(q_r, end);
    if (a < flat) {
        sum += flat_integral(a, flat, n);
        a = flat;
    }
    if (a < end) {
        double fall = 2.0 * b->hurst - moment;
        sum += fabs(fall) < 1e-9
                   ? pow(q_r, n) * log(end / a)
                   : pow(q_r, n) / fall * (pow(a / q_r, -fall) - pow(end / q_r, -fall));
    }
    return sum;
}

// The integral from |q| = a, averaged over the directions.
static double mean_integral(const lac_band *b, double a, int moment)
{
    enum { ANGLES = 1440 };
    if (b->stretch == 1.0) {
        return integral(b, a, 2, moment);
    }
    double sum = 0.0;
    for (int i = 0; i < ANGLES; i++) {
        double angle = (2.0 * M_PI) * (i + 0.5) / ANGLES;
        double g = drawn(b, cos(angle), sin(angle));
        sum += integral(b, a * g, 2, moment) / pow(g, 2 + moment);
    }
    return sum / ANGLES;
}

static double line_sum(const lac_band *b, int moment)
{
    double along_x = b->dqx > 0.0 ? 1.0 : 0.0;
    double dq = fmax(b->dqx, b->dqy);
    double modes = floor(b->q_shortest * edge / dq);
    double last = fmin(modes, summed_modes);
    double sum = 0.0;
    for (double k = 1.0; k <= last; k += 1.0) {
        sum += 2.0 * term(b, k * along_x, k * (1.0 - along_x), moment);
    }
    double g = drawn(b, along_x, 1.0 - along_x);
    double rest = integral(b, (last + 0.5) * dq * g, 1, moment) / pow(g, 1 + moment);
    return modes <= last ? sum : sum + 2.0 / dq * rest;
}

// From the half plane ky >= 0. Stretched waves are never shorter than q_shortest says.
static double plane_sum(const lac_band *b, int moment)
{
    double q_sum = sqrt(summed_modes * b->dqx * b->dqy * 2.0 / (2.0 * M_PI));
    bool all = b->q_shortest * edge <= q_sum;
    double end = all ? b->q_shortest * edge : q_sum;
    double sum = 0.0;
    for (double ky = 0.0; ky * b->dqy <= end; ky += 1.0) {
        double row = 0.0;
        for (double kx = ky > 0.0 ? 0.0 : 1.0; hypot(kx * b->dqx, ky * b->dqy) <= end; kx += 1.0) {
            row += term(b, kx, ky, moment) + (kx > 0.0 ? term(b, -kx, ky, moment) : 0.0);
        }
        sum += (ky > 0.0 ? 2.0 : 1.0) * row;
    }
    return all ? sum : sum + (2.0 * M_PI) / (b->dqx * b->dqy) * mean_integral(b, end, moment);
}

double lac_band_sum(const lac_band *b, int moment)
{
    return b->dqx > 0.0 && b->dqy > 0.0 ? plane_sum(b, moment) : line_sum(b, moment);
}

static lac_status check_band(const lac_synthesis *how, const lac_band *b, lac_error *err)
{
    LAC_FAIL_IF(!(lac_band_sum(b, 0) > 0.0), err, LAC_EINPUT,
                "%s: no wave fits the interface: with anisotropy %g the shortest wavelength "
                "along the direction is %g m",
                how->source, how->anisotropy, how->anisotropy * (2.0 * M_PI) / b->q_shortest);
    return LAC_OK;
}

lac_status lac_synthesis_band(const lac_synthesis *how, const lac_grid *grid, lac_band *out,
                              lac_error *err)
{
    double lx = grid->nx > 1 ? (double)grid->nx * grid->dx : 0.0;
    double ly = grid->ny > 1 ? (double)grid->ny * grid->dy : 0.0;
    double cell = fmax(grid->nx > 1 ? grid->dx : 0.0, grid->ny > 1 ? grid->dy : 0.0);
    double longest = fmax(lx, ly);
    double rolloff = isnan(how->rolloff) ? longest : how->rolloff;
    double shortest = isnan(how->shortest) ? 2.0 * cell : how->shortest;
    LAC_FAIL_IF(shortest > longest * edge, err, LAC_EINPUT,
                "%s: the shortest wavelength, %g m, is longer than the interface, %g m",
                how->source, shortest, longest);
    LAC_FAIL_IF(rolloff < shortest, err, LAC_EINPUT,
                "%s: the rolloff, %g m, must not be shorter than the shortest wavelength, %g m%s",
                how->source, rolloff, shortest,
                isnan(how->shortest) ? " (two cells, as none is given)" : "");
    *out = (lac_band){
        .dqx = lx > 0.0 ? (2.0 * M_PI) / lx : 0.0,
        .dqy = ly > 0.0 ? (2.0 * M_PI) / ly : 0.0,
        .q_rolloff = (2.0 * M_PI) / rolloff,
        .q_shortest = (2.0 * M_PI) / shortest,
        .hurst = how->hurst,
        .power = 2.0 * how->hurst + (lx > 0.0 && ly > 0.0 ? 2.0 : 1.0),
        .stretch = how->anisotropy,
        .cosine = cos(how->direction),
        .sine = sin(how->direction),
    };
    return how->anisotropy == 1.0 ? LAC_OK : check_band(how, out, err);
}

double _Complex lac_band_amplitude(const lac_band *b, uint64_t seed, lac_stream stream, double kx,
                                   double ky, double scale)
{
    double c = term(b, kx, ky, 0);
    if (c == 0.0) {
        return 0.0;
    }
    double n[2];
    lac_random_normal(seed, stream, (uint64_t)(int64_t)kx, (uint64_t)(int64_t)ky, n);
    double size = scale * sqrt(0.5 * c);
    return size * n[0] + size * n[1] * I;
}

// Folds waves onto the wavenumbers of a grid.
typedef struct folding {
    mode_function mode;
    const void *of;
    double nx, ny;           // cells
    double kx_last, ky_last; // of the waves
    bool mean;               // over the cell; else at its node
} folding;

static lac_status check(const lac_synthesis *how, const lac_band *b, lac_error *err)
{
    if (how->sampling == LAC_SAMPLING_LOW_PASS) {
        return LAC_OK;
    }
    LAC_FAIL_IF(isnan(how->shortest), err, LAC_EINPUT,
                "%s: sampling needs shortest: without it the band ends with the waves of the grid",
                how->source);
    double waves_x = b->dqx > 0.0 ? 2.0 * b->q_shortest / b->dqx : 1.0;
    double waves_y = b->dqy > 0.0 ? 2.0 * b->q_shortest / b->dqy : 1.0;
    LAC_FAIL_IF(waves_x * waves_y > most_waves, err, LAC_EINPUT,
                "%s: sampling has to add %g waves; at most %g are added: choose a longer shortest, "
                "or low-pass",
                how->source, waves_x * waves_y, most_waves);
    return LAC_OK;
}

// Mean of exp(i q x) over a cell, over its value at the node the cell begins at.
static double _Complex cell_mean(double turn)
{
    double half = M_PI * turn;
    double part = half == 0.0 ? 1.0 : sin(half) / half;
    return part * cos(half) + part * sin(half) * I;
}

static double _Complex wave(const folding *f, double kx, double ky)
{
    bool given = kx > 0.0 || (kx == 0.0 && ky > 0.0);
    if (kx == 0.0 && ky == 0.0) {
        return 0.0;
    }
    // the field is real
    double _Complex a = given ? f->mode(f->of, kx, ky) : conj(f->mode(f->of, -kx, -ky));
    return f->mean ? a * cell_mean(kx / f->nx) * cell_mean(ky / f->ny) : a;
}

// The first of k, k + n, k + 2 n ... at or above -last; a direction of one cell has no waves.
static double lowest(double k, double n, double last)
{
    return n > 1.0 ? k + n * ceil((-last - k) / n) : k;
}

static double _Complex folded(const folding *f, double kx, double ky)
{
    double _Complex sum = 0.0;
    double step_x = f->nx > 1.0 ? f->nx : 1.0;
    double step_y = f->ny > 1.0 ? f->ny : 1.0;
    for (double y = lowest(ky, f->ny, f->ky_last); y <= f->ky_last; y += step_y) {
        for (double x = lowest(kx, f->nx, f->kx_last); x <= f->kx_last; x += step_x) {
            sum += wave(f, x, y);
        }
    }
    return sum;
}

// The last wave along a direction: of a band, or of those that the grid resolves, whose Nyquist
// lines stay empty.
static double last_wave(const lac_synthesis *how, const lac_band *b, double dq, size_t n)
{
    if (how->sampling == LAC_SAMPLING_LOW_PASS) {
        return (double)((n - 1) / 2);
    }
    return dq > 0.0 ? floor(edge * b->q_shortest / dq) : 0.0;
}

static void fold(lac_fft *fft, const folding *f)
{
    ptrdiff_t rows = (ptrdiff_t)fft->strip.n;
#pragma omp parallel for schedule(static) if (fft->nkx * fft->ny > 16384)
    for (ptrdiff_t j = 0; j < rows; j++) {
        double ky = lac_fft_frequency(fft->strip.first + (size_t)j, fft->ny);
        for (size_t i = 0; i < fft->nkx; i++) {
            fft->spectrum[(size_t)j * fft->nkx + i] = folded(f, (double)i, ky);
        }
    }
}

// The rows of this rank, without the mean that short waves may have.
static void take(const lac_synthesis *how, const lac_fft *fft, const lac_grid *grid,
                 double *heights)
{
    const lac_strip rows = lac_strip_rows(fft->strip.team, grid->ny);
    const size_t n = rows.n * grid->nx;
    memcpy(heights, fft->real, n * sizeof *heights);
    bool none = how->sampling == LAC_SAMPLING_LOW_PASS;
    const double sum = none || how->with_mean ? 0.0 : lac_strip_sum(&rows, n, heights, 1.0);
    for (size_t i = 0; !none && !how->with_mean && i < n; i++) {
        heights[i] -= sum / (double)lac_grid_cells(grid);
    }
}

lac_status lac_synthesise(const lac_synthesis *how, const lac_band *band, const lac_grid *grid,
                          lac_team *team,
                          double _Complex (*mode)(const void *of, double kx, double ky),
                          const void *of, double *heights, lac_error *err)
{
    lac_fft *fft = NULL;
    LAC_TRY_RETURN(check(how, band, err));
    LAC_TRY_RETURN(lac_fft_share(grid->nx, grid->ny, team, &fft, err));
    const folding f = {
        .mode = mode,
        .of = of,
        .nx = (double)grid->nx,
        .ny = (double)grid->ny,
        .kx_last = last_wave(how, band, band->dqx, grid->nx),
        .ky_last = last_wave(how, band, band->dqy, grid->ny),
        .mean = how->sampling == LAC_SAMPLING_BLOCK_MEAN,
    };
    fold(fft, &f);
    lac_fft_inverse(fft);
    take(how, fft, grid, heights);
    lac_fft_free(fft);
    return LAC_OK;
}
