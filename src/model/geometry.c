// SPDX-License-Identifier: GPL-3.0-or-later
// What a base whose dip and thickness follow the mean slip does to the cells: all pressures go with
// the normal force, and the pull of the weight is shared as they are; docs/theory/loads.md.
#include "model/internal.h"

lac_status lac_problem_geometry_init(lac_problem *problem, lac_error *err)
{
    const lac_geometry *geometry = problem->loads.geometry;
    if (geometry == NULL) {
        return LAC_OK;
    }
    LAC_FAIL_IF(!problem->kind->has_slip, err, LAC_EINPUT,
                "the formulation \"%s\" does not hold the slip that interface.geometry follows",
                problem->kind->name);
    LAC_FAIL_IF(problem->friction->response.value != NULL, err, LAC_EINPUT,
                "interface.geometry: the normal stress changes with slip, and friction's response "
                "to that (alpha) is not followed");
    LAC_FAIL_IF(problem->across != NULL, err, LAC_EINPUT,
                "interface.geometry: slip in two directions is not followed on a base that bends");
    LAC_FAIL_IF(problem->weak != NULL, err, LAC_EINPUT,
                "interface.geometry: weakening is not followed on a base that bends");
    problem->pull0 = lac_geometry_at(geometry, 0.0).pull;
    if (problem->at_start.lake.unit_weight > 0.0) {
        const lac_buoyancy b =
            lac_geometry_float(geometry, 0.0, problem->loads.length, &problem->at_start.lake);
        problem->pull0 -= b.back / problem->mean_pressure;
    }
    problem->slide =
        problem->mean_pressure * problem->spring_share * lac_geometry_steepest(geometry);
    return LAC_OK;
}

lac_gone lac_problem_gone(const lac_problem *problem, const double *slip, double rate)
{
    if (problem->loads.geometry == NULL) {
        return (lac_gone){0};
    }
    return (lac_gone){lac_problem_mean(problem, slip), rate};
}

// What slides round a bend presses on it with m v^2 times its curvature, -d alpha/d slip.
static void press_round(const lac_problem *problem, double rate, const lac_slab *slab,
                        lac_problem_loads_at *drive)
{
    const double mass = problem->mass / problem->spring_share; // per nominal area
    const double by = mass * rate / problem->mean_pressure;
    drive->normal -= by * rate * slab->angle_slope;
    drive->share_slope -= by * rate * slab->angle_bend;
    drive->share_by_rate = -2.0 * by * slab->angle_slope;
}

// A lake takes its part off the weight, of what presses and of what pulls.
static void let_float(const lac_problem *problem, double slip, lac_load_state *now,
                      lac_problem_loads_at *drive)
{
    const lac_load_set *loads = &problem->loads;
    const lac_buoyancy b = lac_geometry_float(loads->geometry, slip, loads->length, &now->lake);
    const double p = problem->mean_pressure;
    now->pore += b.lift;
    drive->share_slope -= b.lift_slope / p;
    drive->ratio -= b.back / p;
    drive->ratio_slope -= b.back_slope / p;
}

void lac_problem_bend(const lac_problem *problem, lac_gone gone, lac_load_state *now,
                      lac_problem_loads_at *drive)
{
    const lac_slab slab = lac_geometry_at(problem->loads.geometry, gone.slip);
    drive->normal = slab.normal;
    drive->share_slope = slab.normal_slope;
    drive->ratio += slab.pull - problem->pull0;
    drive->ratio_slope = slab.pull_slope;
    if (now->lake.unit_weight > 0.0) {
        let_float(problem, gone.slip, now, drive);
    }
    if (problem->mass > 0.0) {
        press_round(problem, gone.rate, &slab, drive);
    }
}

bool lac_problem_bends(const lac_problem *problem) { return problem->loads.geometry != NULL; }

bool lac_problem_settles(const lac_problem *problem, double t, const double *y, double *work)
{
    size_t cell;
    double mean, max;
    if (!lac_problem_bends(problem) || !lac_problem_rests(problem, t, y, &cell, work)) {
        return false;
    }
    lac_problem_speed(problem, t, y, false, &mean, &max, work);
    return max < LAC_NOTHING;
}
