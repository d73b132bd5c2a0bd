// SPDX-License-Identifier: GPL-3.0-or-later
// The file of --levels, or the mapping `levels` of a fleet: read by one table of rows as a case is,
// and the default written as such a file.
#include "case/levels.h"

#include "case/sections.h"

#define LEVELS(field) offsetof(lac_levels, field)
#define NUMBER(field, low, high, bits, text) \
    LAC_REAL(#field, "1", LEVELS(field), NAN, low, high, LAC_OPTIONAL | (bits), text)

// A rate may be .inf, which no range allows: read_rate reads it. A number without its unit is in
// m/s: one that was meant as mm/day is mostly above the range.
#define RATE(field, text)                                                   \
    LAC_REAL(#field, "m/s", LEVELS(field), NAN, 0, 0.01,                    \
             LAC_OPTIONAL | LAC_ABOVE_MIN | LAC_OWN_FLAG,                   \
             "rate of the last day, or step where longer, that gives " text \
             " by itself: \"5 mm/day\"; .inf: none")

enum {
    WATCH_P,
    SURGE,
    ODDS,
    ODDS_DENSE,
    ODDS_SUDDEN,
    RUNNING,
    HOLD,
    HORIZON,
    CHANCE,
    AGREE,
    RATES
};

static const lac_param rows[] = {
    [WATCH_P] = NUMBER(watch_p, 0, 1, LAC_ABOVE_MIN,
                       "watch: chance, below 1, of so clear a rise where the rate is steady"),
    [SURGE] = NUMBER(surge, 1, 1e300, LAC_ABOVE_MIN,
                     "or the last readings go at so many times the rate that was usual before"),
    [ODDS] = NUMBER(odds, -50, 1000, 0,
                    "warning: ln odds of a law that ends in failure, at readings 10 days apart"),
    [ODDS_DENSE] = NUMBER(odds_dense, -50, 1000, 0,
                          "and so much more at readings a day apart, twice at a tenth of it"),
    [ODDS_SUDDEN] = NUMBER(odds_sudden, -50, 1000, 0,
                           "and so much more, likewise, where one reading alone does"),
    [RUNNING] = NUMBER(running, 1, 50, 0, "readings in a row that must say so"),
    [HOLD] = NUMBER(hold, 0, 50, 0, "readings that a level outlasts what gave it"),
    [HORIZON] =
        LAC_REAL("horizon", "s", LEVELS(horizon), NAN, LAC_LEAST_HORIZON, 1e12, LAC_OPTIONAL,
                 "alarm: failure within it, or within two intervals where longer"),
    [CHANCE] = NUMBER(chance, 0, 1, LAC_ABOVE_MIN, "with this chance by the pooled methods"),
    [AGREE] =
        NUMBER(agree, 0, 1, LAC_ABOVE_MIN, "and by this share of the methods that issue a time"),
    [RATES] = RATE(watch_rate, "watch"),
    RATE(warning_rate, "warning"),
    RATE(alarm_rate, "alarm"),
};

const lac_model_info lac_levels_table =
    LAC_ABOUT("levels", "thresholds of the level: quiet, watch, warning, alarm", "",
              LAC_ROWS(rows, lac_levels));

static double *value_of(size_t row, lac_levels *levels)
{
    return (double *)(void *)((char *)levels + rows[row].offset);
}

// A node of the mapping that was read and is not refused; NULL.
static const lac_node *node_of(const lac_node *map, size_t row)
{
    const lac_node *node = lac_node_child(map, rows[row].key);
    return node != NULL && !node->bad && !node->ignored ? node : NULL;
}

// @param least  of the rates of lower levels: a higher level asks no less [m/s]
static void read_rate(lac_reader *reader, const lac_node *node, size_t row, double *least,
                      lac_levels *out)
{
    static const char *const infinite[] = {".inf", ".Inf", ".INF", "+.inf"};
    double *value = value_of(row, out);
    for (size_t i = 0; i < sizeof infinite / sizeof *infinite; i++) {
        if (node->kind == LAC_NODE_SCALAR && strcmp(node->text, infinite[i]) == 0) {
            *value = INFINITY;
            return;
        }
    }
    if (lac_read_param(reader, node, &rows[row], value_of(0, out)) && *value < *least) {
        lac_add_error(reader, node, "must be >= the rate of the level below, %.4g mm/day",
                      *least * 86400e3);
    }
    *least = fmax(*least, *value);
}

void lac_read_levels(lac_reader *reader, const lac_node *map, lac_levels *out)
{
    double least = 0.0;
    lac_read_table(reader, map, &lac_levels_table, NULL, out);
    for (size_t i = RATES; i < lac_levels_table.param_count; i++) {
        const lac_node *node = node_of(map, i);
        if (node != NULL) {
            read_rate(reader, node, i, &least, out);
        }
    }
    const lac_node *p = node_of(map, WATCH_P);
    if (p != NULL && out->watch_p >= 1.0) {
        lac_add_error(reader, p, "must be < 1");
    }
    for (size_t i = RUNNING; i <= HOLD; i++) {
        const lac_node *node = node_of(map, i);
        if (node != NULL && *value_of(i, out) != floor(*value_of(i, out))) {
            lac_add_error(reader, node, "must be a whole number");
        }
    }
}

static void read_root(lac_reader *reader, void *out) { lac_read_levels(reader, reader->root, out); }

lac_status lac_levels_read(const char *path, const lac_units *units, lac_levels *out,
                           lac_error *err)
{
    lac_levels made = lac_levels_default();
    LAC_TRY_RETURN(lac_map_file_read(path, units, "horizon: \"7 day\"", read_root, &made, err));
    *out = made;
    return LAC_OK;
}

void lac_levels_put_default(FILE *out)
{
    lac_levels levels = lac_levels_default();
    char text[40];
    (void)fprintf(out, "# Thresholds of the level: what is left out has these.\n");
    for (size_t i = 0; i < lac_levels_table.param_count; i++) {
        const double value = *value_of(i, &levels);
        const double scale = i == HORIZON ? 86400.0 : i >= RATES ? 1.0 / 86400e3 : 1.0;
        const char *unit = i == HORIZON ? "day" : i >= RATES ? "mm/day" : NULL;
        (void)fprintf(out, "# %s\n%s: ", rows[i].doc, rows[i].key);
        if (isinf(value)) {
            (void)fprintf(out, ".inf\n");
        } else {
            (void)lac_number_exact(value / scale, 1, text, sizeof text);
            (void)fprintf(out, unit != NULL ? "\"%s %s\"\n" : "%s\n", text, unit);
        }
    }
}
