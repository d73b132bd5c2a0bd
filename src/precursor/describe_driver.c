// SPDX-License-Identifier: GPL-3.0-or-later
// What drivers explain of a motion, as tables: variables on the readings' times, and JSON.
#include "data/describe.h"
#include "precursor/precursor.h"

enum { NAME = 80, TITLE = 160 };

#define SET const lac_forecast_set *s = of
#define EFFECT const lac_driver_effect *e = of
#define E(kind_, field) LAC_HELD(kind_, lac_driver_effect, field)

static const char *const verdicts[] = {"cannot tell", "explains", "does not explain"};
static const char *const answers[] = {"lag", "memory", "change"};
static const char *const rests[] = {"cannot tell", "accelerates", "does not accelerate"};

LAC_TEXT_GETTER(driver_name, EFFECT, e->driver->name)
LAC_TEXT_GETTER(driver_unit, EFFECT, e->driver->unit)
LAC_GETTER(double, driver_sum, EFFECT, e->driver->sum ? 1.0 : 0.0)
LAC_TEXT_GETTER(verdict, EFFECT, verdicts[e->verdict])
LAC_TEXT_GETTER(answer, EFFECT, isnan(e->p) ? NULL : answers[e->response])
LAC_TEXT_GETTER(remains, EFFECT, e->verdict == LAC_EXPLAINS ? rests[e->remains] : NULL)
LAC_GETTER(double, withholds, EFFECT, lac_driver_withholds(e) ? 1.0 : 0.0)

LAC_GETTER(double, value_at, SET, s->effect[at[1]].value[at[0]])
LAC_GETTER(double, part_at, SET, s->effect[at[1]].part[at[0]])
LAC_TEXT_GETTER(verdict_of, SET, verdicts[s->effect[at[0]].verdict])
LAC_TEXT_GETTER(reason_of, SET, s->effect[at[0]].reason)
LAC_TEXT_GETTER(answer_of, SET, answer(&s->effect[at[0]], at, room))
LAC_TEXT_GETTER(remains_of, SET, remains(&s->effect[at[0]], at, room))
LAC_GETTER(double, p_of, SET, s->effect[at[0]].p)
LAC_GETTER(double, share_of, SET, s->effect[at[0]].share)
LAC_GETTER(double, scale_of, SET, s->effect[at[0]].scale)
LAC_GETTER(double, slope_of, SET, s->effect[at[0]].slope)

// JSON of each.
static const lac_variable of_drivers[] = {
    {.json = "drivers[]/driver", T(driver_name)},
    {.json = "drivers[]/unit", T(driver_unit)},
    {.json = "drivers[]/sum", G(driver_sum), .flags = LAC_TRUTH},
    {.json = "drivers[]/verdict", T(verdict)},
    {.json = "drivers[]/reason", E(CHARS, reason), .flags = LAC_MISSING},
    {.json = "drivers[]/intervals", E(COUNT, intervals)},
    {.json = "drivers[]/p", E(REAL, p)},
    {.json = "drivers[]/share", E(REAL, share)},
    {.json = "drivers[]/response", T(answer)},
    {.json = "drivers[]/response_time_s", E(REAL, scale)},
    {.json = "drivers[]/rate_per_response", E(REAL, slope)},
    {.json = "drivers[]/what_remains", T(remains)},
    {.json = "drivers[]/withholds", G(withholds), .flags = LAC_TRUTH},
};

// Attributes of a driver's variable.
static const lac_variable beside[] = {
    {.name = "explains_the_rate", T(verdict_of)},
    {.name = "reason", T(reason_of)},
    {.name = "p", G(p_of)},
    {.name = "share", G(share_of)},
    {.name = "response", T(answer_of)},
    {.name = "response_time_s", .unit = "s", G(scale_of)},
    {.name = "rate_per_response", G(slope_of)},
    {.name = "what_remains", T(remains_of)},
};

// "pore pressure (kPa)" as a name that every tool takes.
static void name_of(const char *driver, const char *end, char name[NAME])
{
    (void)snprintf(name, NAME, "driver_%.60s%s", driver, end);
    for (char *c = name; *c != '\0'; c++) {
        const bool plain = (*c >= 'a' && *c <= 'z') || (*c >= 'A' && *c <= 'Z') ||
                           (*c >= '0' && *c <= '9') || *c == '_';
        *c = plain ? *c : '_';
    }
}

// The unit of what is on the readings' times: of amounts, how much in a second.
static lac_status add(lac_dataset *d, const lac_forecast_set *s, size_t k, lac_error *err)
{
    static const lac_variable value = {
        .dims = "reading", G(value_at), .coordinates = "reading_time", .flags = LAC_MISSING};
    static const lac_variable part = {
        .dims = "reading", G(part_at), .coordinates = "reading_time", .flags = LAC_MISSING};
    static const char *const since = "since the reading before";
    const lac_driver *driver = s->effect[k].driver;
    const lac_laid attributes = {LAC_VARIABLES(beside, "", 0), s};
    char name[NAME], title[TITLE], unit[NAME];
    name_of(driver->name, "", name);
    (void)snprintf(title, sizeof title, "mean of %.60s", driver->name);
    (void)snprintf(unit, sizeof unit, driver->sum ? "(%.60s) s-1" : "%.60s", driver->unit);
    const lac_named of_value = {
        .name = name, .long_name = title, .unit = unit, .comment = since, .which = k};
    LAC_TRY_RETURN(lac_dataset_add_named(d, &value, &of_value, s, err));
    lac_dataset_attributes(d, &attributes);
    if (s->effect[k].verdict != LAC_EXPLAINS) {
        return LAC_OK;
    }
    name_of(driver->name, "_rate", name);
    (void)snprintf(title, sizeof title, "part of the velocity that answers to %.60s", driver->name);
    const lac_named of_part = {
        .name = name, .long_name = title, .unit = "m s-1", .comment = since, .which = k};
    return lac_dataset_add_named(d, &part, &of_part, s, err);
}

lac_status lac_drivers_describe(const lac_forecast_set *s, bool json, lac_dataset *d,
                                lac_error *err)
{
    const lac_extent dim = {"driver", s->effects};
    const lac_laid told = {LAC_VARIABLES(of_drivers, "driver", sizeof *s->effect), s->effect};
    LAC_TRY_RETURN(lac_dataset_dims(d, &dim, 1, err));
    for (size_t k = 0; k < s->effects; k++) {
        LAC_TRY_RETURN(add(d, s, k, err));
    }
    return json ? lac_dataset_add(d, &told, 1, err) : LAC_OK;
}
