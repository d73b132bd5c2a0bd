// SPDX-License-Identifier: GPL-3.0-or-later
// How rough a surface is: slopes, JRC, and a Hurst exponent fitted to its spectrum.
#include "base/fft.h"
#include "base/statistics.h"
#include "surface/fit.h"

enum { SHELLS = 256, PER_OCTAVE = 4 };

// Power averaged over the directions, in shells a quarter of an octave wide.
typedef struct radial {
    double power[SHELLS], log_q[SHELLS], modes[SHELLS];
    double q_low, q_high;
    double dimensions; // 2, 1 for a line
    double tied;       // neighbouring waves that a window makes one
    double smear;      // by a window: see window_gain [rad2/m2]
} radial;

double lac_rms_slope(const lac_grid *grid, const double *h, bool along_x, size_t lag)
{
    size_t count = along_x ? grid->nx : grid->ny;
    size_t last = grid->periodic ? count : count - lag;
    size_t other = along_x ? grid->ny : grid->nx;
    double sum = 0.0;
    for (size_t j = 0; j < other; j++) {
        for (size_t i = 0; i < last; i++) {
            size_t k = (i + lag) % count;
            double d = along_x ? h[j * grid->nx + k] - h[j * grid->nx + i]
                               : h[k * grid->nx + j] - h[i * grid->nx + j];
            sum += d * d;
        }
    }
    double step = (double)lag * (along_x ? grid->dx : grid->dy);
    return last == 0 ? 0.0 : sqrt(sum / (double)(last * other)) / step;
}

static double hann(size_t i, size_t n)
{
    return n == 1 ? 1.0 : 0.5 - 0.5 * cos((2.0 * M_PI) * ((double)i + 0.5) / (double)n);
}

static void window(const lac_grid *grid, double *h)
{
    for (size_t i = 0; i < lac_grid_cells(grid); i++) {
        h[i] *= hann(i % grid->nx, grid->nx) * hann(i / grid->nx, grid->ny);
    }
}

static void add_modes(const lac_grid *grid, const lac_fft *fft, radial *r)
{
    double lx = (double)grid->nx * grid->dx;
    double ly = (double)grid->ny * grid->dy;
    for (size_t j = 0; j < fft->ny; j++) {
        double ky = lac_fft_frequency(j, fft->ny);
        for (size_t i = ky > 0.0 ? 0U : 1U; i < fft->nkx; i++) { // each wave once
            double q = (2.0 * M_PI) * hypot((double)i / lx, ky / ly);
            double s = floor(PER_OCTAVE * log2(q / r->q_low));
            if (q >= r->q_low && q <= r->q_high && s < SHELLS) {
                double a = cabs(fft->spectrum[j * fft->nkx + i]);
                r->power[(size_t)s] += a * a;
                r->log_q[(size_t)s] += log(q);
                r->modes[(size_t)s] += 1.0;
            }
        }
    }
}

// Log of what Hann's window makes of a power law q^-fall. It mixes the power of a wave with those
// of its neighbours along either direction, as 1/6, 2/3, 1/6: to second order 1 + the Laplacian
// / 6.
static double window_gain(const radial *r, double fall, double log_q)
{
    return log1p(r->smear * fall * (fall + 2.0 - r->dimensions) * exp(-2.0 * log_q));
}

// Weighted least squares of log power on log q. The mean power of n waves scatters by 1/sqrt(n)
// of itself and its log lies 1/(2n) low; `tied` waves of a window count as one.
static void fit(const radial *r, double fall, lac_surface_measures *m)
{
    double w = 0.0, wx = 0.0, wy = 0.0, wxx = 0.0, wxy = 0.0, wyy = 0.0;
    int shells = 0;
    for (size_t s = 0; s < SHELLS; s++) {
        double n = r->modes[s] / r->tied;
        if (n < 2.0 || r->power[s] <= 0.0) {
            continue;
        }
        double x = r->log_q[s] / r->modes[s];
        double y = log(r->power[s] / r->modes[s]) + 0.5 / n - window_gain(r, fall, x);
        w += n;
        wx += n * x;
        wy += n * y;
        wxx += n * x * x;
        wxy += n * x * y;
        wyy += n * y * y;
        shells++;
    }
    if (shells < 3) {
        return;
    }
    double sxx = wxx - wx * wx / w;
    double slope = (wxy - wx * wy / w) / sxx;
    double misfit = (wyy - wy * wy / w - slope * slope * sxx) / (shells - 2);
    m->hurst = -0.5 * (slope + r->dimensions);
    m->hurst_error = 0.5 * sqrt(fmax(1.0, misfit) / sxx);
    m->hurst_misfit = misfit;
}

// A quarter of the shorter side to four cells.
static lac_wave_range usual_range(const lac_grid *grid)
{
    double lx = grid->nx > 1 ? (double)grid->nx * grid->dx : INFINITY;
    double ly = grid->ny > 1 ? (double)grid->ny * grid->dy : INFINITY;
    double cell = fmax(grid->nx > 1 ? grid->dx : 0.0, grid->ny > 1 ? grid->dy : 0.0);
    return (lac_wave_range){fmin(lx, ly) / 4.0, 4.0 * cell};
}

static void measure_hurst(const lac_grid *grid, lac_fft *fft, lac_surface_measures *m)
{
    if (!(m->fit_longest > m->fit_shortest && m->fit_shortest > 0.0)) {
        return; // too small a grid: hurst stays NaN
    }
    radial r = {.q_low = (2.0 * M_PI) / m->fit_longest * (1.0 - 1e-9),
                .q_high = (2.0 * M_PI) / m->fit_shortest * (1.0 + 1e-9),
                .dimensions = grid->nx == 1 || grid->ny == 1 ? 1.0 : 2.0,
                .tied = 1.0};
    if (!grid->periodic) {
        const double tie = 1.0 + 2.0 * (4.0 / 9.0) + 2.0 / 36.0; // sum of squared correlations
        double dqx = grid->nx > 1 ? (2.0 * M_PI) / ((double)grid->nx * grid->dx) : 0.0;
        double dqy = grid->ny > 1 ? (2.0 * M_PI) / ((double)grid->ny * grid->dy) : 0.0;
        r.tied = pow(tie, r.dimensions);
        r.smear = (dqx * dqx + dqy * dqy) / (6.0 * r.dimensions);
        window(grid, fft->real);
    }
    lac_fft_forward(fft);
    add_modes(grid, fft, &r);
    enum { PASSES = 4 }; // each with the power law of the last; the gain changes little by it
    for (int pass = 0; pass < PASSES; pass++) {
        double fall = pass > 0 ? 2.0 * m->hurst + r.dimensions : 0.0;
        fit(&r, fmax(fall, 0.0), m);
    }
}

static double tse_cruden(double z2) { return z2 > 0.0 ? 32.2 + 32.47 * log10(z2) : (double)NAN; }

// The usual steps that a whole number of cells makes, to a tenth.
static void measure_profiles(const lac_grid *grid, const double *h, lac_surface_measures *m)
{
    static const double steps[LAC_PROFILE_STEPS] = {0.25e-3, 0.5e-3, 1e-3};
    const double fits = 0.1;
    for (size_t k = 0; k < LAC_PROFILE_STEPS; k++) {
        double lag = round(steps[k] / grid->dx);
        double step = lag * grid->dx;
        if (lag < 1.0 || lag >= (double)grid->nx || fabs(step / steps[k] - 1.0) > fits) {
            continue;
        }
        lac_profile_measure *profile = &m->profile[m->profiles++];
        profile->step = step;
        profile->z2 = lac_rms_slope(grid, h, true, (size_t)lag);
        profile->jrc = tse_cruden(profile->z2);
        profile->jrc_yu = k == 0 ? 60.32 * profile->z2 - 4.51 : (double)NAN;
    }
}

lac_status lac_surface_measure(const lac_grid *grid, const double *heights,
                               const lac_wave_range *known, lac_surface_measures *out,
                               lac_error *err)
{
    lac_fft *fft = NULL;
    lac_wave_range range = usual_range(grid);
    if (known != NULL) {
        range.longest = fmin(range.longest, known->longest);
        range.shortest = fmax(range.shortest, known->shortest);
    }
    lac_surface_measures m = {.hurst = NAN,
                              .hurst_error = NAN,
                              .hurst_misfit = NAN,
                              .fit_longest = range.longest,
                              .fit_shortest = range.shortest};
    LAC_TRY_RETURN(lac_fft_create(grid->nx, grid->ny, &fft, err));
    size_t n = lac_grid_cells(grid);
    memcpy(fft->real, heights, n * sizeof *heights);
    // a plane where the ends do not meet
    lac_detrend(grid->periodic ? LAC_DETREND_MEAN : LAC_DETREND_PLANE, grid, fft->real);
    m.rms_height = sqrt(lac_dot(n, fft->real, fft->real) / (double)n);
    m.rms_slope_x = lac_rms_slope(grid, fft->real, true, 1);
    m.rms_slope_y = lac_rms_slope(grid, fft->real, false, 1);
    m.z2 = m.rms_slope_x;
    m.z2_step = grid->dx;
    m.jrc = tse_cruden(m.z2);
    measure_profiles(grid, fft->real, &m);
    measure_hurst(grid, fft, &m);
    *out = m;
    lac_fft_free(fft);
    return LAC_OK;
}
