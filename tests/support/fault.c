// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/fault.h"
#include "lacuna/simulation.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/slot.h"
#include "support/trees.h"

static const double g = 30e9, shear_speed = 3000, f0 = 0.6, v0 = 1e-6;

const double fault_b1_events[4] = {5.922698259157e9, 8.809101683890e9, 1.1701013278305e10,
                                   1.4592844727375e10};
const double fault_b1_peaks[4] = {1.4001, 1.01025, 1.01135, 1.01134};
const double fault_c1_peaks[3] = {1.39670, 0.92993, 0.92938};
const double fault_c1_events[3] = {1.021608001364e9, 2.075715405762e9, 3.132055395233e9};

static void must(lac_status status, const lac_error *err)
{
    if (status != LAC_OK) {
        (void)fprintf(stderr, "fixture: %s\n", err->message);
        abort();
    }
}

static void make_transfer(const fault_def *def, tree *t)
{
    lac_error err;
    lac_model model = {0};
    for (size_t i = 0; lac_transfer_kind_get(i) != NULL; i++) {
        const lac_model_info *info = &lac_transfer_kind_get(i)->info;
        model.info = strcmp(info->name, "elastic") == 0 ? info : model.info;
    }
    lac_transfer_elastic params = {.mode = def->antiplane,
                                   .outside = def->creeping,
                                   .thickness = def->thickness,
                                   .tolerance = 1e-12,
                                   .newton_tolerance = def->newton_tolerance};
    model.params = &params;
    lac_transfer_scene from = {t->domain, t->hierarchy, g, 0.25, def->line, false, NULL};
    must(lac_transfer_create(&model, &from, &t->transfer, &err), &err);
}

static void make_domain(const fault_def *def, tree *t)
{
    lac_error err;
    size_t cells = lac_grid_cells(&def->grid);
    double *pressure = new_doubles(cells);
    for (size_t i = 0; i < cells; i++) {
        pressure[i] = def->pressure;
    }
    must(lac_domain_create(&def->grid, pressure, &t->domain, &err), &err);
    free(pressure);
    t->hierarchy = hierarchy_of(t->domain);
}

// From the order of the grid to that of the cells.
static double *ordered(const lac_domain *domain, const double *values)
{
    double *out = new_doubles(domain->n);
    for (size_t i = 0; i < domain->n; i++) {
        out[i] = values[domain->index[i]];
    }
    return out;
}

void fault_create(const fault_def *def, fault *f)
{
    lac_error err;
    *f = (fault){.load = test_slot_shear("back-slip")};
    tree *t = &f->parts;
    tree_def law = tree_default(0, 1);
    law.b = def->b;
    law.dc = def->dc;
    law.form = LAC_FORM_REGULARISED;
    test_slot_set(&f->load, "rate", def->plate_rate);
    f->loads = test_load_set(&(lac_load_models){.shear = &f->load, .shear_count = 1});
    make_domain(def, t);
    make_transfer(def, t);
    tree_make_friction(&law, t);
    double *a = ordered(t->domain, def->a);
    double *u = ordered(t->domain, def->log_rate), *w = ordered(t->domain, def->log_state);
    must(lac_friction_set(t->friction, "a", a, &err), &err);
    lac_problem_def problem = {.domain = t->domain,
                               .friction = t->friction,
                               .transfer = &t->transfer,
                               .loads = f->loads,
                               .damping = g / (2 * shear_speed),
                               .log_rate = u,
                               .log_state = w,
                               .formulation = def->formulation};
    must(lac_problem_create(&problem, &t->problem, &err), &err);
    free(a);
    free(u);
    free(w);
}

void fault_free(fault *f)
{
    tree_clear(&f->parts);
    lac_load_set_clear(&f->loads);
    lac_model_clear(&f->load);
}

static lac_status watch(void *context, const lac_step *step, lac_error *err)
{
    fault_events *e = context;
    must(lac_slip_events_step(&e->all, step, err), err);
    e->count = e->all.count < MOST_EVENTS ? e->all.count : MOST_EVENTS;
    for (size_t k = 0; k < e->count; k++) {
        e->time[k] = e->all.event[k].start;
        e->crest[k] = e->all.event[k].max_rate;
    }
    if (e->count > 0) {
        e->peak[e->count - 1] = fmax(e->peak[e->count - 1], step->max_rate);
    }
    return LAC_OK;
}

lac_run_result fault_run(const fault *f, lac_method method, double end, double rtol,
                         fault_events *observation)
{
    lac_run_def how = lac_run_default();
    lac_sink sink = {.context = observation, .step = watch};
    lac_run_result result;
    lac_error err = {""};
    *observation = (fault_events){0};
    how.method = method;
    how.end = end;
    how.rtol = rtol;
    how.failure_rate = 1e3;
    must(lac_run(f->parts.problem, &how, &sink, &result, &err), &err);
    lac_slip_events_clear(&observation->all);
    return result;
}

// The start of B1 and C1: rate 1e-9 m/s and one traction everywhere, that of steady sliding at the
// largest a; theta = dc/v0 exp{(a/b) ln[2 v0/v sinh((tau - eta v)/(a sigma))] - f0/b}.
static void start_fault(fault_def *def, size_t n, fault *f)
{
    const double v = def->plate_rate;
    double *u = new_doubles(n), *w = new_doubles(n), most = 0;
    for (size_t i = 0; i < n; i++) {
        most = fmax(most, def->a[i]);
    }
    double held = most * asinh(v / (2 * v0) * exp((f0 + def->b * log(v0 / v)) / most));
    for (size_t i = 0; i < n; i++) {
        double a = def->a[i];
        u[i] = log(v);
        w[i] = log(def->dc / v0) + a / def->b * log(2 * v0 / v * sinh(held / a)) - f0 / def->b;
    }
    def->log_rate = u;
    def->log_state = w;
    fault_create(def, f);
    free(u);
    free(w);
}

void fault_b1(lac_formulation formulation, fault *f)
{
    enum { CELLS = 1024 };
    const double dx = 64;
    double a[CELLS];
    for (int i = 0; i < CELLS; i++) {
        double x = (i - CELLS / 2 + 0.5) * dx, inner = fmax(-8000, fmin(8000, x));
        double weak = 0.010 + 0.001 * (inner + 8000) / 16000;
        a[i] = weak + (0.025 - weak) * fmin(1, (fabs(x) - fabs(inner)) / 3000);
    }
    fault_def def = {.grid = {CELLS, 1, dx, 1, true},
                     .line = true,
                     .antiplane = true,
                     .thickness = 32768,
                     .plate_rate = 1e-9,
                     .pressure = 50e6,
                     .b = 0.015,
                     .dc = 0.016,
                     .a = a,
                     .newton_tolerance = 1e-3,
                     .formulation = formulation};
    start_fault(&def, CELLS, f);
}

void fault_c1(lac_formulation formulation, fault *f)
{
    enum { SIDE = 128 };
    const double dx = 100;
    double *a = new_doubles((size_t)SIDE * SIDE);
    for (int i = 0; i < SIDE * SIDE; i++) {
        double x = (i % SIDE + 0.5) * dx - 6400 - 300, y = (i / SIDE + 0.5) * dx - 6400 - 200;
        a[i] = fmax(0.008, fmin(0.022, 0.008 + 0.014 * (hypot(x, y) - 4000) / 500));
    }
    fault_def def = {.grid = {SIDE, SIDE, dx, dx, false},
                     .creeping = true,
                     .thickness = NAN,
                     .plate_rate = 1e-9,
                     .pressure = 50e6,
                     .b = 0.015,
                     .dc = 0.010,
                     .a = a,
                     .newton_tolerance = 1e-3,
                     .formulation = formulation};
    start_fault(&def, (size_t)SIDE * SIDE, f);
    free(a);
}
