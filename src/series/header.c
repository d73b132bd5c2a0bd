// SPDX-License-Identifier: GPL-3.0-or-later
// The header of a monitoring file: which line it is, which columns it names, in which units.
#include "base/units.h"
#include "series/parser.h"

enum { ATTRIBUTION_MAX = 1 << 16, HEADER_WITHIN = 200, ABOVE_NUMBERS = 1 << 20, LIST = 512 };

lac_status lac_parser_fail(const lac_parser *p, lac_error *err, const char *column,
                           const char *value, const char *allowed)
{
    char shown[SHOWN];
    return lac_fail(err, LAC_EINPUT, "%s:%zu: %s: \"%s\" %s", p->lines.path, p->lines.number,
                    column, lac_text_show(value, shown, sizeof shown), allowed);
}

static lac_status add_attribution(lac_parser *p, const char *comment, lac_error *err)
{
    size_t length = strlen(comment);
    if (length == 0 || p->attribution_length + length + 2 > ATTRIBUTION_MAX) {
        return LAC_OK;
    }
    char *text = realloc(p->attribution, p->attribution_length + length + 2);
    LAC_FAIL_MEMORY_IF(text == NULL, err);
    if (p->attribution_length > 0) {
        text[p->attribution_length++] = ' ';
    }
    memcpy(text + p->attribution_length, comment, length + 1);
    p->attribution = text;
    p->attribution_length += length;
    return LAC_OK;
}

// What a line names, were it the header.
typedef struct lac_candidate {
    char *text, **name; ///< owned
    size_t line, fields;
    size_t found, words; ///< columns that were asked for; all, where none is a number
    size_t index[COLUMNS];
    size_t count[COLUMNS]; ///< how many names fit
    char separator, list[LIST];
    bool open, latin; ///< a quote does not end; was no UTF-8
} lac_candidate;

static void release(lac_candidate *c)
{
    free(c->text);
    free(c->name);
    c->text = NULL;
    c->name = NULL;
}

// Adds `, name` to the list of the columns there are, while it fits.
static void list_column(char *list, const char *name)
{
    char shown[SHOWN];
    lac_append(list, LIST, "%s%s", list[0] != '\0' ? ", " : "",
               lac_text_show(name, shown, sizeof shown));
}

static lac_status split(lac_candidate *c, const char *line, lac_error *err)
{
    size_t most = 2;
    bool number = false;
    double value = 0.0;
    c->separator = lac_text_separator(line);
    for (const char *at = line; *at != '\0'; at++) {
        most += *at == c->separator || *at == '\t' || *at == '\f' ? 1 : 0;
    }
    c->text = strdup(line);
    c->name = calloc(most, sizeof *c->name);
    LAC_FAIL_MEMORY_IF(c->text == NULL || c->name == NULL, err);
    for (char *rest = c->text; rest != NULL && !c->open; c->fields++) {
        char *name = lac_text_field(&rest, c->separator);
        c->open = name == NULL;
        c->name[c->fields] = name != NULL ? name : c->text;
        number = number || (name != NULL && lac_text_number(name, '.', &value));
        if (name != NULL) {
            list_column(c->list, name);
        }
    }
    c->words = number || c->open ? 0 : c->fields;
    return LAC_OK;
}

// Length of a name without the brackets that it ends in.
static size_t bare_length(const char *name)
{
    size_t n = strlen(name);
    const bool ends = n > 0 && (name[n - 1] == ']' || name[n - 1] == ')');
    const char *open = ends ? strrchr(name, name[n - 1] == ']' ? '[' : '(') : NULL;
    n = open != NULL ? (size_t)(open - name) : n;
    while (n > 0 && open != NULL && strchr(" _", name[n - 1]) != NULL) {
        n--;
    }
    return n;
}

// The columns of a name, or, where there is none, those of which it lacks only the brackets.
static void match(const lac_parser *p, lac_candidate *c, size_t column)
{
    const char *wanted = p->wanted[column].name;
    for (int bare = 0; bare < 2 && c->count[column] == 0; bare++) {
        for (size_t i = 0; i < c->fields; i++) {
            const size_t n = bare != 0 ? bare_length(c->name[i]) : strlen(c->name[i]);
            if (strlen(wanted) == n && strncmp(wanted, c->name[i], n) == 0) {
                c->index[column] = c->count[column] == 0 ? i : c->index[column];
                c->count[column]++;
            }
        }
    }
    c->found += c->count[column] > 0 ? 1 : 0;
}

static lac_status read_candidate(const lac_parser *p, const char *line, lac_candidate *c,
                                 lac_error *err)
{
    *c = (lac_candidate){.line = p->lines.number, .latin = p->lines.latin};
    LAC_TRY_RETURN(split(c, line, err));
    for (size_t i = 0; i < COLUMNS && !c->open; i++) {
        if (p->wanted[i].name != NULL) {
            match(p, c, i);
        }
    }
    return LAC_OK;
}

// What keeps a line from being the header.
static lac_status refuse(lac_parser *p, const lac_candidate *c, lac_error *err)
{
    p->lines.number = c->line;
    LAC_FAIL_IF(c->line == 0, err, LAC_EINPUT, "%s: has no header line%s", p->lines.path,
                p->skip > 0 ? " behind those that skip leaves out" : "");
    if (c->open) {
        return lac_parser_fail(p, err, "header", c->list, "has a quoted name that does not end");
    }
    for (size_t i = 0; i < COLUMNS; i++) {
        const char *name = p->wanted[i].name;
        LAC_FAIL_IF(name != NULL && c->count[i] == 0, err, LAC_EINPUT,
                    "%s:%zu: has no column \"%s\"; its columns are %s", p->lines.path, c->line,
                    name, c->list);
        if (name != NULL && c->count[i] > 1) {
            return lac_parser_fail(p, err, "header", name, "names two columns");
        }
    }
    return lac_fail(err, LAC_EINPUT,
                    "%s:%zu: the first column is asked for as a value, and is the time where no "
                    "other is named: --time COLUMN",
                    p->lines.path, c->line);
}

static bool is_whole(const lac_parser *p, const lac_candidate *c)
{
    for (size_t i = 0; i < COLUMNS; i++) {
        const bool asked = p->wanted[i].name != NULL;
        if (asked && (c->count[i] != 1 || (i > 0 && c->index[i] == 0 && !p->time_named))) {
            return false;
        }
    }
    return !c->open;
}

// Of several brackets in a name the one that is a unit, else one of another kind, else the last.
static void take_bracket(const lac_parser *p, lac_wanted *w, const char *name)
{
    char other[SHOWN] = "";
    double scale, offset;
    w->bracket[0] = '\0';
    for (const char *at = name; (at = strpbrk(at, "[(")) != NULL; at++) {
        const size_t n = strcspn(at + 1, "])");
        if (at[n + 1] != '\0' && n > 0 && n < sizeof w->bracket) {
            memcpy(w->bracket, at + 1, n);
            w->bracket[n] = '\0';
        }
        if (lac_units_convert(p->units, w->bracket, w->si, &scale, &offset, NULL) == LAC_OK) {
            return;
        }
        if (lac_parser_is_unit(p, w->bracket)) {
            memcpy(other, w->bracket, sizeof other);
        }
    }
    if (other[0] != '\0') {
        memcpy(w->bracket, other, sizeof other);
    }
}

static void take(lac_parser *p, lac_candidate *c)
{
    free(p->header);
    free(p->column);
    p->header = c->text;
    p->column = c->name;
    p->header_line = c->line;
    p->header_latin = c->latin;
    p->separator = c->separator;
    p->fields = c->fields;
    if (!p->time_named) { // the first column is the time then
        (void)lac_text_show(c->name[0], p->first_name, sizeof p->first_name);
        p->wanted[0].name = p->first_name;
    }
    for (size_t i = 0; i < COLUMNS; i++) {
        p->wanted[i].index =
            p->wanted[i].name != NULL && (i > 0 || p->time_named) ? c->index[i] : 0;
        if (p->wanted[i].name != NULL && p->wanted[i].si != NULL) {
            take_bracket(p, &p->wanted[i], c->name[p->wanted[i].index]);
        }
    }
    c->text = NULL;
    c->name = NULL;
}

static lac_status retake(lac_parser *p, const char *line, bool *taken, lac_error *err)
{
    lac_candidate c;
    const char *first = p->wanted[0].name;
    p->wanted[0].name = p->time_named ? first : NULL;
    lac_status status = read_candidate(p, line, &c, err);
    *taken = status == LAC_OK && is_whole(p, &c);
    p->wanted[0].name = first;
    if (*taken) {
        take(p, &c);
    }
    release(&c);
    return status;
}

// A logger that starts anew writes its header again; what stood before it may have been no header.
lac_status lac_parser_again(lac_parser *p, bool *found, lac_error *err)
{
    size_t c = 1;
    lac_wanted before[COLUMNS];
    while (c < VALUES && p->wanted[c].name == NULL) {
        c++;
    }
    *found = false;
    if (strstr(p->lines.text, p->wanted[c].name) == NULL) {
        return LAC_OK;
    }
    const size_t line = p->header_line;
    memcpy(before, p->wanted, sizeof before);
    LAC_TRY_RETURN(retake(p, p->lines.text, found, err));
    if (!*found || p->count == 0) {
        return LAC_OK;
    }
    p->header_line = line;
    p->again_line = p->headers_again++ == 0 ? p->lines.number : p->again_line;
    for (c = 0; c < COLUMNS; c++) {
        if (p->unit_line == 0 && strcmp(before[c].bracket, p->wanted[c].bracket) != 0) {
            return lac_parser_fail(p, err, p->wanted[c].name, p->wanted[c].bracket,
                                   "is another unit than in the header above");
        }
    }
    return LAC_OK;
}

// The line looked at last, and the best of those before it.
typedef struct lac_search {
    lac_candidate last, best;
} lac_search;

// Which line to name where none is the header: that which names most of what was asked for, then
// one above a row of as many numbers, then the longest.
static void choose(lac_search *search, const lac_candidate *c)
{
    lac_candidate *last = &search->last, *best = &search->best;
    if (last->words > 1 && c->words == 0 && c->fields == last->fields) {
        last->words += ABOVE_NUMBERS;
    }
    if (last->line > 0 && (best->line == 0 || last->found > best->found ||
                           (last->found == best->found && last->words > best->words))) {
        *best = *last;
    }
    *last = *c;
}

// Looks at one line: comments are the attribution, unless they are the header.
static lac_status look_at(lac_parser *p, lac_search *search, bool *found, lac_error *err)
{
    char *line = lac_text_trim(p->lines.text);
    const bool comment = *line == '#';
    lac_candidate c;
    if (*line == '\0') {
        return LAC_OK;
    }
    line = comment ? lac_text_trim(line + strspn(line, "#")) : p->lines.text;
    if (comment) {
        LAC_TRY_RETURN(add_attribution(p, line, err));
    } else if (p->first_line == 0) {
        p->first_line = p->lines.number;
    }
    const lac_status status = read_candidate(p, line, &c, err);
    *found = status == LAC_OK && is_whole(p, &c) && (!comment || p->skip == 0);
    if (*found) {
        take(p, &c);
    }
    release(&c);
    if (!comment) {
        choose(search, &c);
    }
    return status;
}

lac_status lac_parser_header(lac_parser *p, lac_error *err)
{
    lac_search search = {0};
    bool found = false;
    while (!found) {
        bool more = false;
        LAC_TRY_RETURN(lac_lines_next(&p->lines, &more, err));
        if (!more || p->lines.number > p->skip + HEADER_WITHIN ||
            (p->skip > 0 && search.last.line > 0)) {
            choose(&search, &(lac_candidate){0});
            return refuse(p, &search.best, err);
        }
        if (p->lines.number > p->skip) {
            LAC_TRY_RETURN(look_at(p, &search, &found, err));
        }
    }
    return LAC_OK;
}

static const char two_units[] = "%s:%zu: %s: the file says %s, and %s was named: which is it? name "
                                "the file's, or mend its header";

// Of a value of any kind, which has no SI unit to compare by: the file's must be what was named.
static lac_status check_other_unit(const lac_parser *p, lac_error *err)
{
    const lac_wanted *w = &p->wanted[OTHER];
    double scale = 1.0, offset = 0.0;
    if (w->unit == NULL || !lac_parser_is_unit(p, w->bracket)) {
        return LAC_OK;
    }
    const bool alike =
        lac_units_convert(p->units, w->bracket, w->unit, &scale, &offset, NULL) == LAC_OK;
    const double rounding = 1e-12;
    LAC_FAIL_IF(!alike || fabs(scale - 1.0) > rounding || offset != 0.0, err, LAC_EINPUT, two_units,
                p->lines.path, p->header_line, w->name, w->bracket, w->unit);
    return LAC_OK;
}

lac_status lac_parser_unit(lac_parser *p, size_t column, const char *text, bool strict,
                           lac_error *err)
{
    lac_wanted *w = &p->wanted[column];
    const char *path = p->lines.path;
    double scale = 1.0, offset = 0.0;
    if (column == OTHER) {
        return check_other_unit(p, err);
    }
    const bool known = lac_units_convert(p->units, text, w->si, &scale, &offset, NULL) == LAC_OK;
    LAC_FAIL_IF(
        !known && strict && w->taken != NULL, err, LAC_EINPUT,
        "%s:%zu: %s: \"%s\" is no unit of this kind (%s) that is known: name one, such as %s", path,
        p->header_line, w->name, text, w->si,
        column == 0               ? "--time-format day"
        : strcmp(w->si, "m") == 0 ? "COLUMN:mm"
                                  : "COLUMN:mm/day");
    LAC_FAIL_IF(known && w->taken == NULL && w->unit != NULL &&
                    (scale != w->scale || offset != w->offset),
                err, LAC_EINPUT, two_units, path, p->header_line, w->name, text, w->unit);
    LAC_FAIL_IF(!known && w->unit != NULL && column > 0 && lac_parser_is_unit(p, text), err,
                LAC_EINPUT,
                "%s:%zu: %s: the file says %s, and %s was named, a unit of another kind: name a "
                "column in %s, or mend its header",
                path, p->header_line, w->name, text, w->unit, w->unit);
    if (known && w->taken != NULL) {
        w->scale = scale;
        w->offset = offset;
        w->taken = NULL;
    }
    return LAC_OK;
}
