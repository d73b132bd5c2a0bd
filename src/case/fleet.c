// SPDX-License-Identifier: GPL-3.0-or-later
// The file of `lacuna watch`, read by tables of rows as a case is.
#include "case/fleet.h"

#include "case/levels.h"
#include "case/sections.h"

#define FLEET(field) offsetof(lac_fleet, field)

static const char *const stream_names[] = {"live", "replayed", NULL};
static const char *const truth[] = {"false", "true", NULL};

static const lac_param fleet_rows[] = {
    LAC_TEXT("station", FLEET(station), LAC_OPTIONAL, "column of stations: station"),
    LAC_TEXT("time", FLEET(time), LAC_OPTIONAL, "column of times: time"),
    LAC_TEXT("time_format", FLEET(time_format), LAC_OPTIONAL,
             "how times are written: iso, unix, excel, day, \"%d/%m/%Y %H:%M\" ..."),
    LAC_TEXT("clock", FLEET(clock), LAC_OPTIONAL,
             "column of the time of day, where dates have a column of their own"),
    LAC_COLUMN("displacement", FLEET(displacement), "m",
               "column of displacements, as \"column:unit\""),
    LAC_COLUMN("sigma", FLEET(sigma), "m",
               "column of the displacements' standard errors, as \"column:unit\""),
    LAC_OWN("columns", "[station, time, ...]: names in the order of lines that have no header"),
    LAC_INTEGER("most_stations", FLEET(most), 1000, 1, 1e6, 0,
                "so many stations at most: what memory is for"),
    LAC_OWN("window", "{count: 2000, time: 90 day}: what is known of a station"),
    LAC_OWN("ahead", "1 day: dates further ahead of the computer's clock are dropped; .inf: none"),
    LAC_TEXT("smooth", FLEET(smooth), LAC_OPTIONAL, "as --smooth of precursors"),
    LAC_TEXT("onset", FLEET(onset), LAC_OPTIONAL, "as --onset of precursors"),
    LAC_CHOICE("raw", FLEET(raw), 0, truth, 0, "true: as --raw of precursors"),
    LAC_OWN("levels", "FILE.yaml, or a mapping of its keys: as --levels of precursors"),
    LAC_REAL("horizon", "s", FLEET(levels.horizon), NAN, LAC_LEAST_HORIZON, 1e12, LAC_OPTIONAL,
             "of alarms, as --horizon of precursors"),
    LAC_PATH("prometheus", FLEET(prometheus), LAC_OPTIONAL,
             "FILE.prom, written anew as stations change"),
    LAC_OWN("checkpoint", "{lines: 1000, time: 10 s}: how often the state is kept"),
    LAC_CHOICE("stream", FLEET(stream), LAC_STREAM_LIVE, stream_names, 0,
               "standard input after a restart: live, what is new; replayed, from its beginning"),
    LAC_OWN("files", "{P1: p1.csv}, or \"prisms/*.csv\": files that grow, one a station"),
};
static const lac_param window_rows[] = {
    LAC_INTEGER("count", FLEET(window_count), 2000, 2, 1e6, 0, "the last so many readings"),
    LAC_REAL("time", "s", FLEET(window_time), NAN, 0, 1e12, LAC_OPTIONAL | LAC_ABOVE_MIN,
             "what is within so long before the last reading"),
};
static const lac_param checkpoint_rows[] = {
    LAC_INTEGER("lines", FLEET(checkpoint_lines), 1000, 1, 1e9, 0, "after so many lines"),
    LAC_REAL("time", "s", FLEET(checkpoint_time), 10, 0, 1e9, LAC_ABOVE_MIN,
             "and after so long, where there was a line"),
};

#define TABLE(title, text, rows) LAC_ABOUT(title, text, "", LAC_ROWS(rows, lac_fleet))
static const lac_model_info fleet_table = TABLE("fleet", "stations to watch", fleet_rows);
static const lac_model_info window_table = TABLE("window", "what is known", window_rows);
static const lac_model_info checkpoint_table = TABLE("checkpoint", "how often", checkpoint_rows);

static void read_map(lac_reader *reader, const char *key, const char *allowed,
                     const lac_model_info *table, lac_fleet *f)
{
    const lac_node *node = lac_node_child(reader->root, key);
    if (node != NULL && !node->bad && lac_expect_map(reader, node, allowed)) {
        lac_read_table(reader, node, table, NULL, f);
    }
}

static size_t read_names(lac_reader *reader, const lac_node *node, const char *allowed,
                         char ***names)
{
    if (node->kind != LAC_NODE_LIST || node->count == 0) {
        lac_add_error(reader, node, "must be %s", allowed);
        return 0;
    }
    *names = lac_reader_array(reader, node->count, sizeof **names);
    for (size_t i = 0; *names != NULL && i < node->count; i++) {
        const lac_node *item = node->child[i];
        if (item->kind != LAC_NODE_SCALAR || item->text[0] == '\0') {
            lac_add_error(reader, item, "must be a name");
        } else {
            (*names)[i] = lac_reader_copy(reader, item->text, strlen(item->text));
        }
    }
    return *names != NULL ? node->count : 0;
}

static bool is_pattern(const char *text)
{
    const char *star = strchr(text, '*');
    return star != NULL && strchr(star + 1, '*') == NULL;
}

// A relative path is taken from the file's folder, as that of any row.
static void read_path(lac_reader *reader, const lac_node *node, char **path)
{
    const lac_param row = LAC_PATH("files", 0, LAC_OPTIONAL, "");
    (void)lac_read_param(reader, node, &row, path);
}

static void read_files(lac_reader *reader, lac_fleet *f)
{
    const lac_node *node = lac_node_child(reader->root, "files");
    if (node == NULL || node->bad) {
        return;
    }
    if (node->kind == LAC_NODE_SCALAR && is_pattern(node->text)) {
        read_path(reader, node, &f->files_pattern);
        (void)lac_refuse(reader,
                         f->files_pattern != NULL && strchr(strchr(f->files_pattern, '*'), '/'),
                         "files", "must have its * in the name of the file");
        return;
    }
    if (!lac_expect_map(reader, node,
                        "a mapping such as {P1: p1.csv}, or a path with one * for the station")) {
        return;
    }
    f->file = lac_reader_array(reader, node->count, sizeof *f->file);
    f->files = f->file != NULL ? node->count : 0;
    for (size_t i = 0; i < f->files; i++) {
        const lac_node *item = node->child[i];
        f->file[i].station = lac_reader_copy(reader, item->key, strlen(item->key));
        read_path(reader, item, &f->file[i].path);
    }
}

static void read_ahead(lac_reader *reader, lac_fleet *f)
{
    const lac_param row =
        LAC_REAL("ahead", "s", 0, 86400, 0, 1e12, 0, "ahead of the clock, that a date may be");
    const lac_node *node = lac_node_child(reader->root, "ahead");
    f->ahead = row.fallback;
    if (node != NULL && node->kind == LAC_NODE_SCALAR && strcmp(node->text, ".inf") == 0) {
        f->ahead = INFINITY;
    } else if (node != NULL && !node->bad) {
        (void)lac_read_param(reader, node, &row, &f->ahead);
    }
}

static bool has(const lac_fleet *f, const char *column)
{
    for (size_t i = 0; i < f->columns; i++) {
        if (f->column[i] != NULL && strcmp(f->column[i], column) == 0) {
            return true;
        }
    }
    return false;
}

// What no key sees alone.
static void check(lac_reader *reader, const lac_fleet *f)
{
    const bool followed = f->files > 0 || f->files_pattern != NULL;
    (void)lac_refuse(
        reader, f->displacement == NULL && lac_node_child(reader->root, "displacement") == NULL,
        "displacement", "is missing: the column and its unit, such as \"disp:mm\"");
    (void)lac_refuse(reader, followed && f->stream == LAC_STREAM_REPLAYED, "stream",
                     "is of standard input, which is not read where files are followed");
    (void)lac_refuse(reader, followed && f->station != NULL, "station",
                     "is a column of standard input; each of files is of one station");
    if (f->columns > 0) {
        const char *const need[] = {followed             ? NULL
                                    : f->station != NULL ? f->station
                                                         : "station",
                                    f->time != NULL ? f->time : "time", f->clock, f->displacement,
                                    f->sigma};
        for (size_t i = 0; i < sizeof need / sizeof *need; i++) {
            (void)lac_refuse(reader, need[i] != NULL && !has(f, need[i]), "columns", "lacks \"%s\"",
                             need[i]);
        }
    }
}

// A file of its own, or its mapping.
static void read_levels(lac_reader *reader, lac_fleet *f)
{
    const lac_node *node = lac_node_child(reader->root, "levels");
    lac_error err = {""};
    char *path = NULL;
    if (node == NULL || node->bad) {
        return;
    }
    if (node->kind == LAC_NODE_SCALAR) {
        read_path(reader, node, &path);
        if (path != NULL && lac_levels_read(path, reader->units, &f->levels, &err) != LAC_OK) {
            lac_add_error(reader, node, "is wrong: %s", err.message);
        }
        free(path);
    } else if (lac_expect_map(reader, node, "a file name, or a mapping such as {watch_p: 0.01}")) {
        lac_read_levels(reader, node, &f->levels);
    }
}

static void read_fleet(lac_reader *reader, void *out)
{
    lac_fleet *f = out;
    const lac_node *columns = lac_node_child(reader->root, "columns");
    const lac_node *smooth = lac_node_child(reader->root, "smooth");
    const lac_node *onset = lac_node_child(reader->root, "onset");
    read_levels(reader, f); // before `horizon`, which wins
    lac_read_table(reader, reader->root, &fleet_table, NULL, f);
    read_map(reader, "window", "a mapping such as {count: 2000, time: 90 day}", &window_table, f);
    read_map(reader, "checkpoint", "a mapping such as {lines: 1000, time: 10 s}", &checkpoint_table,
             f);
    if (columns != NULL && !columns->bad) {
        f->columns =
            read_names(reader, columns, "a list such as [station, time, disp]", &f->column);
    }
    f->window_time = isnan(f->window_time) ? INFINITY : f->window_time;
    f->smooth_line = smooth != NULL ? smooth->line : 0;
    f->onset_line = onset != NULL ? onset->line : 0;
    read_ahead(reader, f);
    read_files(reader, f);
    if (reader->report->errors == 0) {
        check(reader, f);
    }
}

lac_status lac_fleet_read(const char *path, const lac_units *units, lac_fleet **out, lac_error *err)
{
    lac_status status;
    lac_fleet *f = *out = calloc(1, sizeof *f);
    LAC_FAIL_MEMORY_IF(f == NULL, err);
    lac_table_reset(&fleet_table, f);
    lac_table_reset(&window_table, f);
    lac_table_reset(&checkpoint_table, f);
    f->levels = lac_levels_default();
    LAC_TRY((f->path = strdup(path)) != NULL ? LAC_OK : lac_fail_memory(err));
    LAC_TRY(lac_map_file_read(path, units, "displacement: \"disp:mm\"", read_fleet, f, err));
out:
    LAC_MADE(status, out, lac_fleet_free);
}

static void free_names(size_t n, char **names)
{
    for (size_t i = 0; i < n; i++) {
        free(names[i]);
    }
    free(names);
}

void lac_fleet_free(lac_fleet *f)
{
    if (f == NULL) {
        return;
    }
    lac_table_clear(&fleet_table, f);
    free_names(f->columns, f->column);
    for (size_t i = 0; i < f->files; i++) {
        free(f->file[i].station);
        free(f->file[i].path);
    }
    free(f->file);
    free(f->files_pattern);
    free(f->path);
    free(f);
}

bool lac_fleet_matches(const char *pattern, const char *name, size_t *star, size_t *length)
{
    const size_t before = strcspn(pattern, "*");
    const char *after = pattern + before + 1;
    const size_t n = strlen(name), behind = strlen(after);
    if (n < before + behind || strncmp(pattern, name, before) != 0 ||
        strcmp(name + n - behind, after) != 0) {
        return false;
    }
    *star = before;
    *length = n - before - behind;
    return true;
}
