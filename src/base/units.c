// SPDX-License-Identifier: GPL-3.0-or-later
// Quantities with units ("0.1 mm") to SI by UDUNITS-2. Units that it takes for something else than
// their writer means, such as months or `dday`, are refused.
#include "base/units.h"

#include <ctype.h>
#include <locale.h>
#include <udunits2.h>
#include <unistd.h>

enum { MAX_QUANTITY = 128, MAX_UNIT = 64, MAX_NAME = 32, MAX_EXPONENT_DIGITS = 2 };

struct lac_units {
    ut_system **system; ///< UDUNITS' database, read where a unit is not usual; NULL: not yet
    locale_t c_locale;  ///< numbers are read alike whatever LC_NUMERIC says
};

static const struct {
    const char *unit, *name;
} dimensions[] = {
    {"m", "a length such as \"1 m\""},
    {"s", "a time such as \"1 day\""},
    {"Pa", "a pressure such as \"1 MPa\""},
    {"m/s", "a speed such as \"1 mm/day\""},
    {"kg/m3", "a density such as \"2700 kg/m3\""},
    {"Pa/m", "a stiffness such as \"1 MPa/m\""},
    {"Pa/s", "a stress rate such as \"1 kPa/day\""},
    {"rad", "an angle such as \"30 degree\""},
    {"N", "a force such as \"1 kN\""},
    {"m/s2", "an acceleration such as \"1 m/s2\""},
    {"1/s", "a rate such as \"1 day-1\""},
    {"1", "a number such as 0.5"},
};

// "a length such as "1 m"" for the unit of a key.
static const char *dimension_text(const char *unit, char *text, size_t size)
{
    for (size_t i = 0; i < sizeof dimensions / sizeof dimensions[0]; i++) {
        if (strcmp(dimensions[i].unit, unit) == 0) {
            return dimensions[i].name;
        }
    }
    (void)snprintf(text, size, "a quantity such as \"1 %s\"", unit);
    return text;
}

static lac_status refuse(lac_error *err, const char *unit, const char *why)
{
    char text[96];
    return lac_fail(err, LAC_EINPUT, "must be %s%s%s", dimension_text(unit, text, sizeof text),
                    why[0] == '\0' ? "" : "; ", why);
}

// Whether a word is one of a list, between blanks.
static bool one_of(const char *word, const char *list)
{
    size_t n = strlen(word);
    for (const char *at = list; (at = strstr(at, word)) != NULL; at += n) {
        if ((at == list || at[-1] == ' ') && (at[n] == ' ' || at[n] == '\0')) {
            return true;
        }
    }
    return false;
}

static bool is_angle_name(const char *name)
{
    size_t n = strlen(name);
    return one_of(name,
                  "rad radian radians degree degrees arcdeg \xc2\xb0 arc_min arcmin arcminute "
                  "arc_minute arcsec arc_second arcsecond angular_degree angular_minute "
                  "angular_second circle turn revolution grade cycle sr steradian") ||
           (n == 4 && strcmp(name + 1, "rad") == 0);
}

// A prefix on a calendar unit is legal UDUNITS and never meant: "dday" is a deci-day.
static bool is_prefixed_calendar(const char *name)
{
    const size_t n = strlen(name);
    size_t length = 0;
    if (one_of(name, "arc_minute arcminute arcminutes angular_minute arcmin sidereal_day "
                     "sidereal_hour arc_min sidereal_minute")) {
        return false;
    }
    for (const char *unit =
             "day days hour hours week weeks min minute minutes fortnight fortnights";
         *unit != '\0'; unit += length + strspn(unit + length, " ")) {
        length = strcspn(unit, " ");
        if (n > length && strncmp(name + n - length, unit, length) == 0) {
            return true;
        }
    }
    return one_of(name, "dd md hd kd mh dh hh kh dad dah ud uh");
}

// Why a unit's name is refused although UDUNITS may know it; NULL where it isn't.
static const char *name_refused(const char *name)
{
    if (one_of(name, "a ka Ma Ga are ares")) {
        return "\"a\" is the are, an area: write year";
    }
    if (strstr(name, "month") != NULL) {
        return "a month has no fixed length: write days";
    }
    if (one_of(name, "ton tons")) {
        return "\"ton\" is ambiguous: write tonne";
    }
    if (is_prefixed_calendar(name)) {
        return "days, hours, minutes and weeks take no prefix";
    }
    return one_of(name, "since after from ref at") ? "a unit is needed, not a point in time" : NULL;
}

static bool starts_name(char c)
{
    return isalpha((unsigned char)c) || c == '%' || c == '_' || (unsigned char)c >= 0x80;
}

// Reads an exponent, [^][+-]digits or **digits, if there is one.
static bool read_exponent(const char **at)
{
    const char *p = *at;
    bool marked = *p == '^' || (p[0] == '*' && p[1] == '*');
    p += marked ? (*p == '^' ? 1 : 2) : 0;
    bool is_signed = *p == '-' || *p == '+';
    p += is_signed ? 1 : 0;
    size_t digits = 0;
    while (isdigit((unsigned char)p[digits])) {
        digits++;
    }
    if (digits == 0) {
        return !marked && !is_signed;
    }
    *at = p + digits;
    return digits <= MAX_EXPONENT_DIGITS;
}

// What a unit's text was found to hold.
typedef struct scan {
    bool angle;
    const char *why; ///< why it is refused; NULL
} scan;

static bool read_name(const char **at, scan *found)
{
    char name[MAX_NAME];
    size_t n = 0;
    while (starts_name((*at)[n])) {
        n++;
    }
    if (n == 0 || n >= sizeof name) {
        return false;
    }
    memcpy(name, *at, n);
    name[n] = '\0';
    *at += n;
    found->why = name_refused(name);
    found->angle = found->angle || is_angle_name(name);
    return found->why == NULL && read_exponent(at);
}

// Whether the text is a product of named units with whole exponents. UDUNITS reads much more:
// "m0.5" is 0.5 m, "10 m" a unit of ten metres, "" is 1.
static bool scan_unit(const char *text, scan *found)
{
    const char *at = text;
    bool wanted = true; // a factor must follow
    *found = (scan){.angle = false};
    if (strlen(text) > MAX_UNIT) {
        return false;
    }
    while (*at != '\0') {
        if (*at == ' ') {
            at++;
        } else if (*at == '/' || *at == '.' || *at == '*') {
            if (wanted) {
                return false;
            }
            wanted = true;
            at++;
        } else if (at == text && *at == '1' && strchr(" /", at[1]) != NULL) {
            wanted = false;
            at++;
        } else if (!starts_name(*at) || !read_name(&at, found)) {
            return false;
        } else {
            wanted = false;
        }
    }
    return !wanted;
}

// UDUNITS' own parser, in the C locale. NULL where it doesn't know the text.
static ut_unit *parse_unit(const lac_units *units, const char *text)
{
    locale_t before = uselocale(units->c_locale);
    ut_unit *unit = ut_parse(*units->system, text, UT_UTF8);
    (void)uselocale(before);
    return unit;
}

static lac_status fail_database(lac_error *err)
{
    return lac_fail(err, LAC_EIO, "the units database of UDUNITS-2 cannot be read");
}

lac_status lac_units_create(lac_units **out, lac_error *err)
{
    lac_status status = LAC_OK;
    lac_units *units = *out = calloc(1, sizeof *units);
    LAC_FAIL_MEMORY_IF(units == NULL, err);
    units->system = calloc(1, sizeof *units->system);
    units->c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    const bool room = units->system != NULL && units->c_locale != (locale_t)0;
    LAC_TRY(room ? LAC_OK : lac_fail_memory(err));
    (void)ut_set_error_message_handler(ut_ignore);
    ut_status known = UT_SUCCESS;
    const char *path = ut_get_path_xml(NULL, &known);
    if (path == NULL || access(path, R_OK) != 0) {
        LAC_TRY(fail_database(err));
    }
out:
    LAC_MADE(status, out, lac_units_free);
}

static lac_status read_database(const lac_units *units, lac_error *err)
{
    if (*units->system != NULL) {
        return LAC_OK;
    }
    locale_t before = uselocale(units->c_locale);
    *units->system = ut_read_xml(NULL);
    (void)uselocale(before);
    return *units->system != NULL ? LAC_OK : fail_database(err);
}

void lac_units_free(lac_units *units)
{
    if (units == NULL) {
        return;
    }
    if (units->system != NULL && *units->system != NULL) {
        ut_free_system(*units->system);
    }
    if (units->c_locale != (locale_t)0) {
        freelocale(units->c_locale);
    }
    free(units->system);
    free(units);
}

// By UDUNITS, whose database is there. `why` is told where the text itself is to blame.
static cv_converter *find_converter(const lac_units *units, const char *from, const char *to,
                                    const char **why)
{
    scan found = {.angle = false};
    bool wants_angle = strcmp(to, "rad") == 0;
    bool known = scan_unit(from, &found);
    ut_unit *a = known ? parse_unit(units, from) : NULL;
    ut_unit *b = a != NULL ? parse_unit(units, to) : NULL;
    cv_converter *converter = NULL;
    // To UDUNITS an angle is a number; to a reader it is not.
    bool plain = strcmp(to, "1") == 0 || wants_angle;
    if (b != NULL && (!plain || found.angle == wants_angle)) {
        converter = ut_get_converter(a, b);
    }
    ut_free(b);
    ut_free(a);
    *why = found.why != NULL ? found.why : "";
    return converter;
}

lac_status lac_units_convert(const lac_units *units, const char *from, const char *to,
                             double *scale, double *offset, lac_error *err)
{
    const lac_usual_unit *usual = lac_units_usual_find(from, to);
    if (usual != NULL) {
        *scale = usual->scale;
        *offset = 0.0;
        return LAC_OK;
    }
    LAC_TRY_RETURN(read_database(units, err));
    const char *why = NULL;
    cv_converter *converter = find_converter(units, from, to, &why);
    if (converter == NULL) {
        return refuse(err, to, why);
    }
    *offset = cv_convert_double(converter, 0.0);
    *scale = cv_convert_double(converter, 1.0) - *offset;
    cv_free(converter);
    return LAC_OK;
}

lac_status lac_units_time(const lac_units *units, const char *text, double *scale, double *offset,
                          bool *dated, lac_error *err)
{
    char unit[MAX_UNIT];
    const char *since = strstr(text, " since ");
    size_t length = since != NULL ? (size_t)(since - text) : strlen(text);
    *dated = since != NULL;
    if (length >= sizeof unit || strlen(text) >= MAX_QUANTITY) {
        return refuse(err, "s", "");
    }
    memcpy(unit, text, length);
    unit[length] = '\0';
    lac_status status = lac_units_convert(units, unit, "s", scale, offset, err);
    if (status != LAC_OK || !*dated) {
        return status;
    }
    LAC_TRY_RETURN(read_database(units, err));
    ut_unit *from = parse_unit(units, text);
    ut_unit *to = parse_unit(units, "seconds since 1970-01-01 00:00:00 UTC");
    cv_converter *converter = from != NULL && to != NULL ? ut_get_converter(from, to) : NULL;
    if (converter == NULL) {
        status = lac_fail(err, LAC_EINPUT, "must be like \"days since 2015-06-07 12:00\"");
    } else {
        *offset = cv_convert_double(converter, 0.0);
    }
    cv_free(converter);
    ut_free(to);
    ut_free(from);
    return status;
}

// A decimal number, read in the C locale: no hex, no nan, no inf. NULL where there is none.
static const char *read_number(const lac_units *units, const char *text, double *number)
{
    const char *first = text + (*text == '-' || *text == '+' ? 1 : 0);
    char *end = NULL;
    if (!isdigit((unsigned char)first[*first == '.' ? 1 : 0])) {
        return NULL;
    }
    locale_t before = uselocale(units->c_locale);
    *number = strtod(text, &end);
    (void)uselocale(before);
    const bool hex = first[0] == '0' && (first[1] | 0x20) == 'x' && end > first + 1;
    return hex ? NULL : end;
}

lac_status lac_units_parse(const lac_units *units, const char *text, const char *unit,
                           double *value, lac_error *err)
{
    char copy[MAX_QUANTITY];
    text += strspn(text, " ");
    size_t n = strlen(text);
    while (n > 0 && text[n - 1] == ' ') {
        n--;
    }
    if (n == 0 || n >= sizeof copy) {
        return refuse(err, unit, "");
    }
    memcpy(copy, text, n);
    copy[n] = '\0';

    double number = NAN;
    errno = 0;
    const char *end = read_number(units, copy, &number);
    if (end == NULL) {
        return refuse(err, unit, "");
    }
    if (errno == ERANGE || !isfinite(number)) {
        return refuse(err, unit, "the number cannot be represented");
    }
    const char *tail = end + strspn(end, " ");
    double scale = 1.0, offset = 0.0;
    if (*tail != '\0') {
        LAC_TRY_RETURN(lac_units_convert(units, tail, unit, &scale, &offset, err));
    }
    if (offset != 0.0) {
        return refuse(err, unit, "");
    }
    double product = number * scale;
    if (!isfinite(product) || (fabs(product) < DBL_MIN && number != 0.0)) {
        return refuse(err, unit, "the number cannot be represented");
    }
    *value = product;
    return LAC_OK;
}
