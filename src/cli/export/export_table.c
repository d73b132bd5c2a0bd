// SPDX-License-Identifier: GPL-3.0-or-later
// A table of comma-separated values: the columns that share dimensions, behind what says where each
// row stands. Numbers read back to the same bits; missing ones are empty.
#include "base/date.h"
#include "base/units.h"
#include "cli/export/export.h"

enum { TEXT = 600, LINE = 4096 };

// A variable in a table. `along`: the dimension whose place picks its value; -1: the row does.
typedef struct column {
    const cli_variable *of;
    int along;
    lac_stored_values values;
    char **text;         // of texts, instead
    bool dated;          // seconds since
    double start;        // which date
    char meanings[LINE]; // of the numbers 0, 1 ...
} column;

typedef struct table {
    const cli_tables *from;
    const lac_stored_shape *shape;
    size_t count;
    column *column; // [count]
} table;

bool cli_export_share(const lac_stored_shape *a, const lac_stored_shape *b)
{
    bool same = a->rank == b->rank;
    for (size_t d = 0; same && d < a->rank; d++) {
        same = strcmp(a->dim[d].name, b->dim[d].name) == 0;
    }
    return same;
}

static void put_text(FILE *out, const char *text)
{
    const bool quoted = text[strcspn(text, ",\"\r\n")] != '\0';
    (void)fputs(quoted ? "\"" : "", out);
    for (const char *c = text; *c != '\0'; c++) {
        (void)fprintf(out, *c == '"' ? "\"\"" : "%c", *c);
    }
    (void)fputs(quoted ? "\"" : "", out);
}

static void put_number(FILE *out, double value)
{
    char text[40];
    if (isfinite(value) && value == rint(value) && fabs(value) < 0x1p53) {
        (void)fprintf(out, "%.0f", value); // 80, not 8e+01
    } else if (isfinite(value)) {
        (void)fputs(lac_number_exact(value, 1, text, sizeof text), out);
    } else if (isinf(value)) {
        (void)fputs(value > 0.0 ? "inf" : "-inf", out);
    }
}

// The word number `which` of a list; empty where there is none.
static void put_word(FILE *out, const char *list, double which)
{
    for (double k = 0.0; *list != '\0'; k++) {
        const size_t length = strcspn(list, " ");
        if (k == which) {
            (void)fprintf(out, "%.*s", (int)length, list);
        }
        list += length + strspn(list + length, " ");
    }
}

static void put_value(FILE *out, const column *c, size_t at)
{
    char date[32];
    if (c->text != NULL) {
        put_text(out, c->text[at]);
        return;
    }
    const double value = c->values.value[at];
    put_number(out, value);
    if (c->dated) {
        (void)fprintf(out, ",%s",
                      isfinite(value) ? lac_date_format(c->start + value, date, sizeof date) : "");
    } else if (c->meanings[0] != '\0') {
        (void)fputs(",", out);
        put_word(out, c->meanings, value);
    }
}

static void put_head(FILE *out, const table *t, const column *c)
{
    char unit[TEXT], head[TEXT + LAC_STORED_NAME + 8];
    const bool has = lac_stored_file_text(t->from->file, c->of->name, "units", unit, sizeof unit);
    (void)snprintf(head, sizeof head, has && !c->of->shape.text ? "%s [%s]" : "%s", c->of->name,
                   unit);
    put_text(out, head);
    if (c->dated || c->meanings[0] != '\0') {
        (void)fprintf(out, ",%s%s", c->of->name, c->dated ? " (date UTC)" : " (meaning)");
    }
}

static lac_status read_column(const table *t, column *c, lac_error *err)
{
    static const char since[] = "seconds since ";
    const lac_stored_file *file = t->from->file;
    const char *name = c->of->name;
    char unit[TEXT];
    if (c->of->shape.text) {
        return lac_stored_file_texts(file, name, &c->of->shape, &c->text, err);
    }
    (void)lac_stored_file_text(file, name, "units", unit, sizeof unit);
    c->dated = strncmp(unit, since, sizeof since - 1) == 0 &&
               lac_date_parse(unit + sizeof since - 1, &c->start);
    (void)lac_stored_file_text(file, name, "flag_meanings", c->meanings, sizeof c->meanings);
    return lac_stored_file_values(file, name, &c->values, err);
}

// Whether a word stands in a list between spaces.
static bool lists(const char *list, const char *word)
{
    const size_t length = strlen(word);
    for (const char *at = list; (at = strstr(at, word)) != NULL; at += length) {
        if ((at == list || at[-1] == ' ') && (at[length] == ' ' || at[length] == '\0')) {
            return true;
        }
    }
    return false;
}

// Whether some wanted variable of the table names this one among its coordinates.
static bool is_named(const table *t, const char *name)
{
    char list[TEXT];
    for (size_t i = 0; i < t->from->count; i++) {
        const cli_variable *v = &t->from->variable[i];
        if (v->wanted && cli_export_share(&v->shape, t->shape) &&
            lac_stored_file_text(t->from->file, v->name, "coordinates", list, sizeof list) &&
            lists(list, name)) {
            return true;
        }
    }
    return false;
}

// How well a variable tells the places of a dimension: 3, of its name; 2, named as a coordinate; 1,
// a time; 0 not at all.
static int tells(const table *t, const cli_variable *v, const char *dim)
{
    const size_t length = strlen(v->name);
    if (v->shape.rank != 1 || strcmp(v->shape.dim[0].name, dim) != 0) {
        return 0;
    }
    return strcmp(v->name, dim) == 0 ? 3
           : is_named(t, v->name)    ? 2
                                     : length >= 4 && strcmp(v->name + length - 4, "time") == 0;
}

// The coordinates of a dimension: the variables that tell it best, of times the first; where there
// is none the number of the place.
static void add_coordinates(table *t, size_t d)
{
    const char *dim = t->shape->dim[d].name;
    const size_t before = t->count;
    int best = 0;
    for (size_t i = 0; i < t->from->count; i++) {
        const int how = tells(t, &t->from->variable[i], dim);
        best = how > best ? how : best;
    }
    for (size_t i = 0; best > 0 && i < t->from->count; i++) {
        const bool more = best == 2 || t->count == before;
        if (more && tells(t, &t->from->variable[i], dim) == best) {
            t->column[t->count++] = (column){.of = &t->from->variable[i], .along = (int)d};
        }
    }
    if (best == 0) {
        t->column[t->count++] = (column){.along = (int)d};
    }
}

static bool is_in(const table *t, const cli_variable *v)
{
    for (size_t c = 0; c < t->count; c++) {
        if (t->column[c].of == v) {
            return true;
        }
    }
    return false;
}

// Coordinates first, then the variables.
static lac_status collect(table *t, lac_error *err)
{
    t->column = calloc(t->shape->rank + t->from->count, sizeof *t->column);
    LAC_FAIL_MEMORY_IF(t->column == NULL, err);
    for (size_t d = 0; d < t->shape->rank; d++) {
        add_coordinates(t, d);
    }
    for (size_t i = 0; i < t->from->count; i++) {
        const cli_variable *v = &t->from->variable[i];
        if (v->wanted && cli_export_share(&v->shape, t->shape) && !is_in(t, v)) {
            t->column[t->count++] = (column){.of = v, .along = -1};
        }
    }
    for (size_t c = 0; c < t->count; c++) {
        if (t->column[c].of != NULL) {
            LAC_TRY_RETURN(read_column(t, &t->column[c], err));
        }
    }
    return LAC_OK;
}

static void put_row(FILE *out, const table *t, size_t row)
{
    size_t at[LAC_STORED_RANK] = {0}, rest = row;
    for (size_t d = t->shape->rank; d-- > 0; rest /= t->shape->dim[d].length) {
        at[d] = rest % t->shape->dim[d].length;
    }
    for (size_t i = 0; i < t->count; i++) {
        const column *c = &t->column[i];
        const size_t place = c->along >= 0 ? at[c->along] : row;
        (void)fputs(i > 0 ? "," : "", out);
        if (c->of == NULL) {
            (void)fprintf(out, "%zu", place);
        } else {
            put_value(out, c, place);
        }
    }
    (void)fputs("\n", out);
}

lac_status cli_export_write(const cli_tables *e, const lac_stored_shape *shape, FILE *out,
                            size_t *columns, lac_error *err)
{
    table t = {.from = e, .shape = shape};
    lac_status status;
    LAC_TRY(collect(&t, err));
    *columns = t.count;
    for (size_t c = 0; c < t.count; c++) {
        (void)fputs(c > 0 ? "," : "", out);
        if (t.column[c].of != NULL) {
            put_head(out, &t, &t.column[c]);
        } else {
            (void)fprintf(out, "%s (number)", shape->dim[t.column[c].along].name);
        }
    }
    (void)fputs("\n", out);
    for (size_t row = 0; row < shape->count; row++) {
        put_row(out, &t, row);
    }
out:
    for (size_t c = 0; c < t.count; c++) {
        lac_stored_values_clear(&t.column[c].values);
        free((void *)t.column[c].text);
    }
    free(t.column);
    return status;
}

void cli_export_attributes(const cli_tables *e, FILE *out, char *room, size_t size)
{
    char name[LAC_STORED_NAME * 2];
    (void)fputs("attribute,value\n", out);
    for (size_t i = 0; lac_stored_file_attribute(e->file, NULL, i, name, sizeof name); i++) {
        put_text(out, name);
        (void)fputs(",", out);
        if (lac_stored_file_text(e->file, NULL, name, room, size)) {
            put_text(out, room);
        } else {
            put_number(out, lac_stored_file_number(e->file, NULL, name));
        }
        (void)fputs("\n", out);
    }
}
