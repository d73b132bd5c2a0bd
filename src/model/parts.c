// SPDX-License-Identifier: GPL-3.0-or-later
// The parts of a problem, handed to the engine that follows every cell at steps of its own.
#include "model/internal.h"

static bool all_linear(const lac_load *loads, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (!loads[i].kind->linear) {
            return false;
        }
    }
    return true;
}

lac_problem_parts lac_problem_parts_of(const lac_problem *problem)
{
    const lac_load_set *loads = &problem->loads;
    return (lac_problem_parts){.pressure = problem->pressure,
                               .traction = problem->traction0,
                               .friction = problem->friction,
                               .transfer = &problem->transfer,
                               .damping = {.cell = problem->damping,
                                           .mean = problem->mean_damping,
                                           .shared = problem->drag},
                               .linear = all_linear(loads->shear, loads->shear_count) &&
                                         all_linear(loads->pore, loads->pore_count)};
}

bool lac_problem_load_at(const lac_problem *problem, double t, lac_problem_load *load)
{
    lac_drive drive;
    bool pressed = lac_problem_drive(problem, t, &drive);
    *load = (lac_problem_load){.ratio = drive.ratio,
                               .ratio_rate = drive.ratio_rate,
                               .spring = drive.spring,
                               .spring_rate = drive.spring_rate,
                               .stiffness = drive.spring_stiffness,
                               .share = drive.share,
                               .share_rate = drive.share_rate};
    return pressed;
}
