// SPDX-License-Identifier: GPL-3.0-or-later
// Two rough faces that mate in their long waves: the surface is what is left between them.
#include "surface/surface.h"
#include "surface/synthesis.h"

// What the amplitude of a mode depends on.
typedef struct faces {
    lac_band band;
    uint64_t seed;
    double scale;
    double q_mating; // waves up to this wavenumber are common to the faces; 0: none [rad/m]
    double offset;   // of the lower face along x [m]
} faces;

// Upper face minus lower one: a_k - b_k exp(-i qx offset), with b_k = a_k where the faces mate.
static double _Complex mode(const void *of, double kx, double ky)
{
    const faces *f = of;
    const lac_band *b = &f->band;
    double q = hypot(kx * b->dqx, ky * b->dqy);
    double shift = kx * b->dqx * f->offset;
    double _Complex upper = lac_band_amplitude(b, f->seed, LAC_STREAM_SURFACE, kx, ky, f->scale);
    double _Complex lower = upper;
    if (q > f->q_mating) {
        lower = lac_band_amplitude(b, f->seed, LAC_STREAM_SURFACE_LOWER, kx, ky, f->scale);
    }
    return upper - lower * (cos(shift) - sin(shift) * I);
}

static lac_status generate(const void *params, const lac_grid *grid, lac_team *team,
                           double *heights, lac_surface_stats *report, lac_error *err)
{
    const lac_joint *p = params;
    (void)report;
    if (lac_grid_cells(grid) == 1) {
        heights[0] = 0.0; // one cell has no roughness
        return LAC_OK;
    }
    faces f = {.seed = (uint64_t)p->seed, .offset = p->offset};
    const lac_synthesis how = {"joint", p->hurst, p->rolloff,  p->shortest,
                               1.0,     0.0,      p->sampling, false};
    LAC_TRY_RETURN(lac_synthesis_band(&how, grid, &f.band, err));
    // Lengths carry rounding: a wave as long as `mating` is mated.
    f.q_mating = isnan(p->mating) ? 0.0 : (2.0 * M_PI) / p->mating * (1.0 + 1e-9);
    LAC_FAIL_IF(p->offset == 0.0 && f.q_mating >= f.band.q_shortest, err, LAC_EINPUT,
                "joint: faces mated down to %g m, with no shorter waves and no offset, fit "
                "exactly: there is no roughness between them",
                p->mating);
    f.scale = p->rms_height / sqrt(lac_band_sum(&f.band, 0));
    return lac_synthesise(&how, &f.band, grid, team, mode, &f, heights, err);
}

// Mated waves are left by the offset alone: no power law.
static lac_wave_range waves(const void *params, const lac_grid *grid)
{
    const lac_joint *p = params;
    (void)grid;
    return (lac_wave_range){fmin(p->rolloff, p->mating), p->shortest};
}

#define FIELD(name) offsetof(lac_joint, name)

static const lac_param joint_params[] = {
    LAC_REAL("hurst", "1", FIELD(hurst), 0.8, 0, 1, LAC_ABOVE_MIN, "Hurst exponent of each face"),
    LAC_REAL("rms_height", "m", FIELD(rms_height), NAN, 0, 1e6, LAC_ABOVE_MIN,
             "rms height of each face expected of its full band, rolloff to shortest"),
    LAC_REAL("rolloff", "m", FIELD(rolloff), NAN, 0, 1e9, LAC_OPTIONAL | LAC_ABOVE_MIN,
             "wavelength above which the spectrum of a face is flat; the longest side if absent"),
    LAC_REAL("shortest", "m", FIELD(shortest), NAN, 0, 1e9, LAC_OPTIONAL | LAC_ABOVE_MIN,
             "shortest wavelength of a face; if absent two cells of the grid, to which rms_height "
             "then refers"),
    LAC_SEED(FIELD(seed), 1, 0, "of the random numbers: the same faces at every resolution"),
    LAC_REAL("mating", "m", FIELD(mating), NAN, 0, 1e9, LAC_OPTIONAL | LAC_ABOVE_MIN,
             "wavelength from which on the faces are the same; shorter waves are independent, and "
             "all are if absent"),
    LAC_REAL("offset", "m", FIELD(offset), 0, -1e9, 1e9, 0,
             "by which the lower face is moved along x, the direction of slip"),
    LAC_SAMPLING_ROW(lac_joint),
};

const lac_surface_source lac_surface_joint = {
    .info =
        LAC_ABOUT("joint", "two self-affine faces, mated in their long waves: upper minus lower",
                  "Brown (1995), J. Geophys. Res. 100:5941, doi 10.1029/94JB02262",
                  LAC_ROWS(joint_params, lac_joint)),
    .generate = generate,
    .waves = waves,
    .shared = true,
};
