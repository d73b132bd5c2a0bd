// SPDX-License-Identifier: GPL-3.0-or-later
// What drivers do to forecasts: wider intervals, or none.
#include "forecast/kinds.h"

static const double level = 0.05; // of all drivers together
// Of ln of the remaining time, where a slope fails while driven: tools/studies/driven_failures.py
static const double driven_spread = 1.0;

lac_status lac_driver_explain_all(const lac_forecast_def *def, lac_forecast_set *o, lac_error *err)
{
    o->effect = calloc(def->drivers + 1, sizeof *o->effect);
    LAC_FAIL_MEMORY_IF(o->effect == NULL, err);
    for (size_t k = 0; k < def->drivers; k++) {
        o->effects = k + 1;
        LAC_TRY_RETURN(lac_driver_explain(o->motion, &def->driver[k], level / (double)def->drivers,
                                          &o->effect[k], err));
    }
    return LAC_OK;
}

void lac_driver_effects_free(lac_forecast_set *o)
{
    for (size_t k = 0; k < o->effects; k++) {
        lac_driver_effect_clear(&o->effect[k]);
    }
    free(o->effect);
}

// In ln of the remaining time, about the median.
static void widen(lac_forecast *f)
{
    static const double normal50 = 0.6744897501960817, normal90 = 1.6448536269514722;
    const double now = f->issue_time;
    const double middle = log(f->time - now);
    double *const end[] = {&f->low90, &f->low50, &f->high50, &f->high90};
    for (size_t k = 0; k < sizeof end / sizeof *end && isfinite(middle); k++) {
        const double off = log(*end[k] - now) - middle;
        const double more = driven_spread * (k == 1 || k == 2 ? normal50 : normal90);
        *end[k] = now + exp(middle + copysign(hypot(off, more), k < 2 ? -1.0 : 1.0));
    }
}

void lac_driver_temper(const lac_forecast_set *o, lac_forecast *f)
{
    bool driven = false;
    // a model that a caller brings has no fit in its row
    for (size_t k = 0; k < o->effects && f->issued && !f->kind->baseline && f->kind->fit != NULL;
         k++) {
        const lac_driver_effect *e = &o->effect[k];
        driven = driven || e->verdict == LAC_EXPLAINS;
        if (lac_driver_withholds(e)) {
            f->issued = false;
            (void)lac_forecast_fit_refuse(&f->fit,
                                          "withheld: %.60s explains %.0f %% of the rate (p %.2g), "
                                          "and what remains does not accelerate",
                                          e->driver->name, 100.0 * e->share, e->p);
        }
    }
    if (driven && f->issued) {
        widen(f);
    }
}
