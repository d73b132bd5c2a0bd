// SPDX-License-Identifier: GPL-3.0-or-later
// What is wrong with the weakening that a case names, beside its friction law, inertia and fields.
#include "case/sections.h"

static void check_fields(lac_reader *reader, const lac_case *c, const lac_weakening_set *set)
{
    const struct {
        bool there;
        unsigned bit;
        const char *of;
    } fields[] = {
        {set->pore, LAC_FIELD_EXCESS,
         "excess_pore_pressure needs dilatancy or "
         "thermal-pressurization in weakening"},
        {set->warm, LAC_FIELD_TEMPERATURE, "temperature needs thermal-pressurization in weakening"},
        {set->bridges, LAC_FIELD_BROKEN, "broken_cohesion needs bridges in weakening"},
    };
    for (size_t i = 0; i < sizeof fields / sizeof fields[0]; i++) {
        (void)lac_refuse(reader, (c->fields & fields[i].bit) != 0 && !fields[i].there,
                         "output.fields", "%s", fields[i].of);
    }
}

// Heat and water that even out across a thin layer hold explicit methods to steps as short.
static void warn_explicit(lac_reader *reader, const lac_case *c)
{
    const double many = 1e5; // steps
    lac_weakening_set set;
    double fastest = 0;
    if (c->run.method == LAC_BDF ||
        lac_weakening_set_create(c->weakening.item, c->weakening.count, &set, NULL) != LAC_OK) {
        return;
    }
    for (size_t k = 0; k < set.count; k++) {
        for (size_t j = 0; j < set.item[k].modes.n; j++) {
            fastest = fmax(fastest, set.item[k].modes.decay[j]);
        }
    }
    if (fastest * c->run.end > 3 * many) {
        lac_warn(reader, "solver.method",
                 "takes steps of about %.2g s, in which weakening evens out; bdf does not",
                 3 / fastest);
    }
}

void lac_check_weakening(lac_reader *reader, lac_case *c)
{
    const lac_friction_params *law = c->friction.params;
    lac_weakening_set set = {.count = 0};
    char key[LAC_KEY_LENGTH];
    if (law != NULL && !isnan(law->flash_rate)) { // friction that falls at once, at a given state
        (void)snprintf(key, sizeof key, "friction.%s.flash_rate", c->friction.info->name);
        (void)lac_refuse(reader, !HAS("inertia"), key,
                         "needs the section inertia, such as inertia: {mass_per_area: \"5e5 "
                         "kg/m2\"}: where friction falls at once no slip rate balances the load");
    }
    if (!lac_clean(reader, "weakening")) {
        return;
    }
    for (size_t i = 0; i < c->weakening.count; i++) {
        const lac_weakening_kind *kind = (const void *)c->weakening.item[i].info;
        bool twice = false;
        for (size_t k = 0; k < i; k++) {
            twice = twice || c->weakening.item[k].info == c->weakening.item[i].info;
        }
        (void)snprintf(key, sizeof key, "weakening.%zu.%s", i, kind->info.name);
        set.pore = set.pore || kind->pore;
        set.warm = set.warm || kind->warm;
        set.bridges = set.bridges || !kind->pore;
        (void)lac_refuse(reader, twice, key, "stands twice: each mechanism acts once");
        (void)lac_refuse(reader, c->friction.info != NULL && !kind->pore && !(law->cohesion > 0),
                         key, "needs a cohesion that can break: friction.LAW.cohesion");
        (void)lac_refuse(reader, c->friction.info != NULL && kind->pore && law->alpha > 0, key,
                         "does not go with alpha of the friction law: the state would answer at "
                         "once to a pressure that follows from it");
    }
    check_fields(reader, c, &set);
    warn_explicit(reader, c);
}
