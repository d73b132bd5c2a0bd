// SPDX-License-Identifier: GPL-3.0-or-later
// Random self-affine heights from the sum of their waves, skewed where the case asks for it.
#include "surface/surface.h"
#include "surface/synthesis.h"

// What the amplitude of a mode depends on.
typedef struct synthesis {
    lac_band band;
    uint64_t seed;
    double scale;
} synthesis;

// Shifted lognormal heights of unit variance: T(u) = sign (exp(s |u| - s^2/2) - 1) / root, |u| =
// sign u. Skewness = root^3 + 3 root with root^2 = exp(s^2) - 1 (Johnson 1949).
typedef struct translation {
    double sign, root, s;
} translation;

static translation translation_of(double skewness)
{
    double root = 2.0 * sinh(asinh(0.5 * fabs(skewness)) / 3.0);
    double s = root < 1e-8 ? root : sqrt(log1p(root * root)); // no underflow
    return (translation){copysign(1.0, skewness), root, s};
}

// rms slope of T(u) over that of u: u and its gradient are independent at a point.
static double steepening(translation t) { return t.s * sqrt(1.0 + t.root * t.root) / t.root; }

static double _Complex mode(const void *of, double kx, double ky)
{
    const synthesis *y = of;
    return lac_band_amplitude(&y->band, y->seed, LAC_STREAM_SURFACE, kx, ky, y->scale);
}

static lac_status check(const lac_self_affine *p, lac_error *err)
{
    LAC_FAIL_IF(isnan(p->rms_height) == isnan(p->rms_slope), err, LAC_EINPUT,
                "self-affine: give rms_height or rms_slope, %s",
                isnan(p->rms_height) ? "one of them" : "not both");
    LAC_FAIL_IF(p->skewness != 0.0 && p->sampling == LAC_SAMPLING_BLOCK_MEAN, err, LAC_EINPUT,
                "self-affine: skewness is of heights at points; sampling must not be block-mean");
    return LAC_OK;
}

// rms height of the full band [m]
static double rms_of(const lac_self_affine *p, const lac_band *b, double sum)
{
    if (!isnan(p->rms_height)) {
        return p->rms_height;
    }
    double rms = p->rms_slope * sqrt(sum / lac_band_sum(b, 2));
    return p->skewness == 0.0 ? rms : rms / steepening(translation_of(p->skewness));
}

// Gaussian heights of unit variance -> skewed ones of zero mean over the grid.
static void translate(double skewness, double rms, const lac_grid *grid, lac_team *team,
                      double *heights)
{
    const lac_strip rows = lac_strip_rows(team, grid->ny);
    const size_t n = rows.n * grid->nx;
    translation t = translation_of(skewness);
    for (size_t i = 0; i < n; i++) {
        double u = t.sign * heights[i];
        heights[i] = rms * t.sign * expm1(t.s * u - 0.5 * t.s * t.s) / t.root;
    }
    const double sum = lac_strip_sum(&rows, n, heights, 1.0);
    for (size_t i = 0; i < n; i++) {
        heights[i] -= sum / (double)lac_grid_cells(grid);
    }
}

// h(x) = sum over k of a_k exp(i q.x), with <|a_k|^2> = rms^2 C(q_k) / sum C.
static lac_status generate(const void *params, const lac_grid *grid, lac_team *team,
                           double *heights, lac_surface_stats *report, lac_error *err)
{
    const lac_self_affine *p = params;
    (void)report;
    size_t n = lac_grid_cells(grid);
    LAC_TRY_RETURN(check(p, err));
    if (n == 1) {
        heights[0] = 0.0; // one cell has no roughness
        return LAC_OK;
    }
    synthesis y = {.seed = (uint64_t)p->seed};
    const lac_synthesis how = {"self-affine", p->hurst,     p->rolloff,  p->shortest,
                               p->anisotropy, p->direction, p->sampling, p->skewness != 0.0};
    LAC_TRY_RETURN(lac_synthesis_band(&how, grid, &y.band, err));
    double sum = lac_band_sum(&y.band, 0);
    double rms = rms_of(p, &y.band, sum);
    y.scale = (p->skewness == 0.0 ? rms : 1.0) / sqrt(sum);
    LAC_TRY_RETURN(lac_synthesise(&how, &y.band, grid, team, mode, &y, heights, err));
    if (p->skewness != 0.0) {
        translate(p->skewness, rms, grid, team, heights);
    }
    return LAC_OK;
}

static lac_wave_range waves(const void *params, const lac_grid *grid)
{
    const lac_self_affine *p = params;
    (void)grid;
    return (lac_wave_range){p->rolloff, p->shortest * p->anisotropy};
}

#define FIELD(name) offsetof(lac_self_affine, name)

static const lac_param self_affine_params[] = {
    LAC_REAL("hurst", "1", FIELD(hurst), 0.8, 0, 1, LAC_ABOVE_MIN, "Hurst exponent"),
    LAC_REAL("rms_height", "m", FIELD(rms_height), NAN, 0, 1e6, LAC_OPTIONAL | LAC_ABOVE_MIN,
             "rms height expected of the full band, rolloff to shortest, also where a coarse grid "
             "leaves part of it out"),
    LAC_REAL("rms_slope", "1", FIELD(rms_slope), NAN, 0, 1e3, LAC_OPTIONAL | LAC_ABOVE_MIN,
             "rms slope (of the gradient) expected of the full band, instead of rms_height"),
    LAC_REAL("rolloff", "m", FIELD(rolloff), NAN, 0, 1e9, LAC_OPTIONAL | LAC_ABOVE_MIN,
             "wavelength above which the spectrum is flat; the longest side if absent"),
    LAC_REAL("shortest", "m", FIELD(shortest), NAN, 0, 1e9, LAC_OPTIONAL | LAC_ABOVE_MIN,
             "shortest wavelength of the interface; if absent two cells of the grid, to which "
             "rms_height then refers"),
    LAC_SEED(FIELD(seed), 1, 0, "of the random numbers: the same interface at every resolution"),
    LAC_REAL(
        "anisotropy", "1", FIELD(anisotropy), 1, 1, 100, 0,
        "correlation length along direction over that across, where rolloff and shortest hold"),
    LAC_REAL("direction", "rad", FIELD(direction), 0, -6.3, 6.3, 0,
             "of the longest correlation, from x (the direction of slip) towards y"),
    LAC_REAL("skewness", "1", FIELD(skewness), 0, -2, 2, 0,
             "of the heights expected of the full band; 0: Gaussian, otherwise shifted lognormal"),
    LAC_SAMPLING_ROW(lac_self_affine),
};

const lac_surface_source lac_surface_self_affine = {
    .info = LAC_ABOUT("self-affine", "random self-affine heights, periodic, by spectral synthesis",
                      "Jacobs, Junge & Pastewka (2017), Surf. Topogr. 5:013001, doi "
                      "10.1088/2051-672X/aa51f8; skewness: Johnson (1949), Biometrika 36:149, "
                      "doi 10.1093/biomet/36.1-2.149",
                      LAC_ROWS(self_affine_params, lac_self_affine)),
    .generate = generate,
    .waves = waves,
    .shared = true,
};
