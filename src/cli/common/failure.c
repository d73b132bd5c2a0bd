// SPDX-License-Identifier: GPL-3.0-or-later
// Warnings where radiation damping leaves little or nothing between the start and failure.
#include "cli/common/failure.h"

#include "cli/common/words.h"
#include "lacuna/simulation.h"

const char *const cli_failure_lowered =
    "a p/eta: damping holds the joint below that of the case; judged by all cells as one";

void cli_failure_warn(const lac_failure *failure)
{
    // a decade: what accelerates by less has hardly left creep
    const double clear = 10.0;
    const cli_text reach = cli_amount(failure->reach, "m/s");
    const cli_text rate = cli_amount(failure->rate, "m/s");
    if (failure->lowered && failure->rate < clear * failure->start) {
        cli_note("warning: the failure rate, %s, is only %.2g times the slip rate at the start: "
                 "radiation damping holds so light a joint at some %s; give it its mass (inertia)",
                 rate.s, failure->rate / failure->start, reach.s);
    } else if (!failure->lowered && failure->reach > 0.0 && failure->reach < failure->rate) {
        cli_note("warning: time.failure.mean_slip_rate: %s is out of reach, radiation damping "
                 "holds the joint at some %s from the start; only time.failure.mean_slip counts, "
                 "or give it its mass (inertia)",
                 rate.s, reach.s);
    }
}
