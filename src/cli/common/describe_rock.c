// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna describe rock [NAME]: what sources state of the friction of rocks, from the library's
// table.
#include "cli/common/describe.h"
#include "cli/common/words.h"

enum { MOST_ROCKS = 128 };

static const char *how_found(const lac_rock *rock)
{
    return rock->in_field ? "back-analysed in the field" : "laboratory";
}

static cli_text number(double value, const char *unit)
{
    return strcmp(unit, "1") == 0 ? cli_format("%.3g", value) : cli_amount(value, unit);
}

static const char *label_of(int which)
{
    return which == LAC_ROCK_A_B ? "a - b" : lac_rock_quantities[which].key;
}

static void print_value(const lac_rock *rock, int which)
{
    const lac_rock_quantity *of = &lac_rock_quantities[which];
    const lac_rock_value told = lac_rock_value_of(rock, which);
    if (isnan(told.value)) {
        cli_row(label_of(which), "not stated");
    } else if (told.low == told.high) {
        cli_row(label_of(which), "%s", number(told.value, of->unit).s);
    } else {
        cli_row(label_of(which), "%s, from %s to %s", number(told.value, of->unit).s,
                number(told.low, of->unit).s, number(told.high, of->unit).s);
    }
}

static void print_rock(const lac_rock *rock)
{
    printf("friction: {LAW: {rock: %s, ...}}\n", rock->name);
    cli_wrap("  ", rock->summary);
    for (int k = 0; k < LAC_ROCK_VALUES; k++) {
        print_value(rock, k);
    }
    cli_row("found", "%s", how_found(rock));
    cli_row_wrap("conditions", rock->conditions);
    puts("  source:");
    cli_wrap("    ", rock->source);
    printf("    read at %s\n", rock->read_at);
}

// What is told besides f0: ", a, b".
static cli_text others_of(const lac_rock *rock)
{
    cli_text text = {""};
    for (int k = LAC_ROCK_A; k < LAC_ROCK_VALUES; k++) {
        const bool told = !isnan(lac_rock_value_of(rock, k).value);
        lac_append(text.s, sizeof text.s, "%s%s", told ? ", " : "", told ? label_of(k) : "");
    }
    return text;
}

static void print_list(void)
{
    const lac_rock *rock;
    puts(CLI_ROCK ": " CLI_ROCK_SUMMARY "\n  f0, its range, and what else the source states");
    for (size_t i = 0; (rock = lac_rock_get(i)) != NULL; i++) {
        const lac_rock_value f0 = lac_rock_value_of(rock, LAC_ROCK_F0);
        const bool one = f0.low == f0.high;
        cli_row_wrap(rock->name,
                     cli_format("%.2f%s%s; %s%s", f0.value,
                                one ? "" : cli_format(" (%.2f-%.2f)", f0.low, f0.high).s,
                                others_of(rock).s, rock->summary,
                                rock->in_field ? "; back-analysed in the field" : "")
                         .s);
    }
}

static void write_rock(lac_json *json, const lac_rock *rock)
{
    lac_json_open(json, NULL, '{');
    lac_json_text(json, "name", rock->name);
    lac_json_text(json, "summary", rock->summary);
    lac_json_text(json, "found", how_found(rock));
    lac_json_text(json, "conditions", rock->conditions);
    lac_json_text(json, "source", rock->source);
    lac_json_text(json, "read_at", rock->read_at);
    for (int k = 0; k < LAC_ROCK_VALUES; k++) {
        const lac_rock_value told = lac_rock_value_of(rock, k);
        lac_json_open(json, lac_rock_quantities[k].key, '{');
        lac_json_text(json, "unit", lac_rock_quantities[k].unit);
        lac_json_number(json, "value", told.value);
        lac_json_number(json, "low", told.low);
        lac_json_number(json, "high", told.high);
        lac_json_close(json, '}');
    }
    lac_json_close(json, '}');
}

static lac_status find_rock(const char *name, const lac_rock **out, lac_error *err)
{
    const char *names[MOST_ROCKS];
    size_t n = 0;
    for (; n < MOST_ROCKS && (*out = lac_rock_get(n)) != NULL; n++) {
        names[n] = (*out)->name;
        if (strcmp(names[n], name) == 0) {
            return LAC_OK;
        }
    }
    return cli_unknown("describe: ", name, CLI_ROCK, names, n, err);
}

lac_status cli_describe_rock(const cli_request *request, lac_error *err)
{
    const lac_rock *rock = NULL, *one;
    lac_json json = {.out = stdout};
    LAC_FAIL_IF(request->pipe != 0, err, LAC_EINPUT,
                "describe: --pipe: prints models and sections; for rocks take --json");
    if (request->count > 1) {
        LAC_TRY_RETURN(find_rock(request->argument[1], &rock, err));
    }
    if (cli_given(request, CLI_OPT_JSON)) {
        lac_json_open(&json, NULL, '{');
        lac_json_open(&json, "rocks", '[');
        for (size_t i = 0; (one = lac_rock_get(i)) != NULL; i++) {
            if (rock == NULL || rock == one) {
                write_rock(&json, one);
            }
        }
        lac_json_close(&json, ']');
        lac_json_close(&json, '}');
    } else if (rock != NULL) {
        print_rock(rock);
    } else {
        print_list();
    }
    return LAC_OK;
}
