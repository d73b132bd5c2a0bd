// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/slider.h"
#include "lacuna/simulation.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/slot.h"

const double slider_event_times[5] = {5.615967767843e6, 1.851449733346e7, 3.141302690505e7,
                                      4.431155647664e7, 5.721008604823e7};

static void must(lac_status status, const lac_error *err)
{
    if (status != LAC_OK) {
        (void)fprintf(stderr, "fixture: %s\n", err->message);
        abort();
    }
}

static void make_friction(slider *out)
{
    lac_error err;
    lac_model model = {0};
    const lac_friction_law *law = NULL;
    for (size_t i = 0; (law = lac_friction_law_get(i)) != NULL; i++) {
        if (strcmp(law->info.name, "aging") == 0) {
            break;
        }
    }
    must(lac_model_create(&law->info, &model, &err), &err);
    lac_friction_params *p = model.params;
    p->f0 = 0.6;
    p->a = 0.010;
    p->b = 0.015;
    p->dc = 1e-4;
    p->v0 = 1e-6;
    p->form = LAC_FORM_REGULARISED;
    must(lac_friction_create(&model, 1, &out->friction, &err), &err);
    lac_model_clear(&model);
}

void slider_create(lac_formulation formulation, slider *out)
{
    lac_error err;
    const double pressure = 10e6;
    *out = (slider){0};
    lac_grid grid = {.nx = 1, .ny = 1, .dx = 1.0, .dy = 1.0, .periodic = true};
    must(lac_domain_create(&grid, &pressure, &out->domain, &err), &err);
    must(lac_hierarchy_create(out->domain, &out->hierarchy, &err), &err);
    lac_transfer_scene scene = {out->domain, out->hierarchy, NAN, NAN, false, false, NULL};
    must(lac_transfer_create(&(lac_model){0}, &scene, &out->transfer, &err), &err);
    make_friction(out);
    out->spring = test_slot_shear("spring");
    test_slot_set(&out->spring, "stiffness", 1e8);
    test_slot_set(&out->spring, "speed", 1e-9);
    out->loads = test_load_set(&(lac_load_models){.shear = &out->spring, .shear_count = 1});
    out->start[0] = log(1e-10);
    out->start[1] = log(1e5);
    out->problem_def = (lac_problem_def){.domain = out->domain,
                                         .friction = out->friction,
                                         .transfer = &out->transfer,
                                         .loads = out->loads,
                                         .damping = 30e9 / (2.0 * 3000.0),
                                         .log_rate = &out->start[0],
                                         .log_state = &out->start[1],
                                         .formulation = formulation};
}

void slider_clear(slider *s)
{
    lac_load_set_clear(&s->loads);
    lac_model_clear(&s->spring);
    lac_friction_free(s->friction);
    lac_transfer_clear(&s->transfer);
    lac_hierarchy_free(s->hierarchy);
    lac_domain_free(s->domain);
}

lac_run_def slider_run(void)
{
    lac_run_def how = lac_run_default();
    how.end = 7e7;
    how.failure_rate = 10.0;
    return how;
}

static lac_status look(void *context, const lac_record *line, lac_error *err)
{
    slider_events *e = context;
    (void)err;
    double t = line->time_origin + line->time_local;
    double u = log(line->observation.max_rate);
    double limit = log(1e-3);
    if (e->begun && e->last_log_rate < limit && u >= limit) {
        double part = (limit - e->last_log_rate) / (u - e->last_log_rate);
        if (e->n < sizeof e->time / sizeof e->time[0]) {
            e->time[e->n] = e->last_time + part * (t - e->last_time);
        }
        e->n++;
    }
    e->begun = true;
    e->last_time = t;
    e->last_log_rate = u;
    return LAC_OK;
}

lac_sink slider_events_sink(slider_events *events)
{
    return (lac_sink){.context = events, .record = look};
}
