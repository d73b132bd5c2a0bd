// SPDX-License-Identifier: GPL-3.0-or-later
// In which regime a scene moves, in words for who set it up: whether its cells go as one, and with
// that what roughness, size, load and water can and cannot do in it.
#include <stdarg.h>

#include "scene/estimate.h"
#include "scene/internal.h"

const char *lac_regime_name(lac_regime regime)
{
    static const char *const names[] = {NULL,       "one block", "creep",
                                        "together", "patches",   "one by one"};
    return names[regime];
}

lac_regime lac_regime_of(const lac_estimate *e)
{
    return !e->integrated            ? LAC_REGIME_NONE
           : e->cells <= 1           ? LAC_REGIME_BLOCK
           : !(e->critical > 0)      ? LAC_REGIME_CREEP
           : e->stiffness_ratio <= 1 ? LAC_REGIME_SINGLE
           : e->patch < e->length    ? LAC_REGIME_PATCHES
                                     : LAC_REGIME_TOGETHER;
}

bool lac_scene_load_given(const lac_case *c)
{
    return isnan(c->initial.slip_rate) || c->initial.state == LAC_STATE_FROM_LOAD;
}

typedef struct words {
    char *text;
    size_t size, used;
} words;

static void __attribute__((format(printf, 2, 3))) add(words *w, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    const int more = vsnprintf(w->text + w->used, w->size - w->used, format, arguments);
    va_end(arguments);
    w->used = more < 0 || (size_t)more >= w->size - w->used ? w->size - 1 : w->used + (size_t)more;
}

// What roughness and size do where all cells move alike.
static void say_together(const lac_case *c, const lac_estimate *e, words *w)
{
    if (isfinite(e->patch)) {
        add(w, "A patch slips by itself from a width of some %.2g m on, and the joint is %.4g m: ",
            e->patch, e->length);
    }
    add(w, "all cells creep as one. Roughness and size act %s",
        c->friction_spread.count > 0
            ? "only through friction.spread, by what it makes of the patches."
            : "on nothing that decides when it fails. Name friction.spread, such as a dc by the "
              "size of the patch, and they do.");
    if (isfinite(e->patch)) {
        add(w, " With a dc below %.2g of this one, patches would slip by themselves.",
            e->length / e->patch);
    }
}

static void say_weakening(const lac_case *c, const lac_estimate *e, words *w)
{
    const lac_friction_params *law = c->friction.params;
    for (size_t i = 0; c->friction.info != NULL && i < c->weakening.count; i++) {
        const lac_weakening_kind *kind = (const void *)c->weakening.item[i].info;
        const lac_weakening_joint joint = {.normal = e->pressure,
                                           .f0 = law->f0,
                                           .excess = law->b - law->a,
                                           .cohesion = law->cohesion > 0 ? law->cohesion : 0};
        char text[400];
        kind->words(c->weakening.item[i].params, &joint, text, sizeof text);
        add(w, " %s", text);
    }
}

// The slip at which the dip comes down to that which friction at v0 holds dry; INFINITY: never.
static double slip_where_held(const lac_geometry *g, double from, double to, double f0)
{
    const int parts = 4000; // and no more than that of the way is told wrong
    for (int k = 0; k <= parts; k++) {
        const double slip = from + (to - from) * k / parts;
        if (tan(lac_geometry_at(g, slip).angle) <= f0) {
            return slip;
        }
    }
    return INFINITY;
}

static void say_geometry(const lac_case *c, words *w)
{
    const lac_geometry_def *def = &c->geometry;
    const lac_friction_params *law = c->friction.params;
    const double degrees = 180.0 / M_PI;
    lac_geometry *g;
    if (def->angles == 0 || law == NULL || lac_geometry_create(def, &g, NULL) != LAC_OK) {
        return;
    }
    const double start = lac_geometry_at(g, 0.0).angle;
    const double bent = isnan(def->radius) ? 0.0 : def->radius * (start + 1.5);
    const double far = fmax(def->angles > 1 ? def->slip[def->nodes - 1] : bent, 0.0);
    const double held = slip_where_held(g, 0.0, far, law->f0);
    add(w, " The base dips by %.4g degree", start * degrees);
    if (far > 0.0) {
        const double shown = isnan(def->radius) ? far : def->radius / 10.0;
        add(w, " at the start and %.4g after %.4g m of slip",
            lac_geometry_at(g, shown).angle * degrees, shown);
    }
    if (held > 0.0 && isfinite(held)) {
        add(w,
            ": dry, friction at v0 (%.3g degree) holds its weight from %.3g m on. There it slows, "
            "unless weakening or water carry it over.",
            atan(law->f0) * degrees, held);
    } else {
        add(w,
            held > 0.0 ? ": more than friction at v0 holds (%.3g degree), so that the base "
                         "arrests nothing."
                       : ": dry, friction at v0 (%.3g degree) holds its weight from the start.",
            atan(law->f0) * degrees);
    }
    lac_geometry_free(g);
}

void lac_regime_words(const lac_case *c, const lac_estimate *e, char text[static LAC_REGIME_ROOM])
{
    words w = {text, LAC_REGIME_ROOM, 0};
    const lac_regime regime = lac_regime_of(e);
    text[0] = '\0';
    if (regime == LAC_REGIME_BLOCK) {
        add(&w, "One cell has no roughness: load, water, friction and its state set the time.");
    } else if (regime == LAC_REGIME_CREEP) {
        add(&w, "b <= a: what slips faster is held more. The joint follows its load and does not "
                "run away by itself.");
    } else if (regime == LAC_REGIME_TOGETHER) {
        say_together(c, e, &w);
    } else if (regime == LAC_REGIME_PATCHES) {
        add(&w,
            "Patches wider than some %.2g m slip by themselves before the joint of %.4g m fails: "
            "roughness, size and dc set when.",
            e->patch, e->length);
    } else if (regime == LAC_REGIME_SINGLE) {
        add(&w, "Neighbours hold a cell less than it weakens: cells slip one by one before the "
                "joint fails. Roughness, size, dc and the size of cells set when.");
    }
    if (regime != LAC_REGIME_NONE && !lac_scene_load_given(c)) {
        add(&w, " The load at the start follows from initial.slip_rate and the state: what is "
                "there from the start (angle, weight, water) does not change when it fails. With a "
                "load.shear of kind slope or ratio in the place of initial.slip_rate it does.");
    }
    if (regime != LAC_REGIME_NONE) {
        say_geometry(c, &w);
        say_weakening(c, e, &w);
    }
}
