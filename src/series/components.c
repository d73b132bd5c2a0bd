// SPDX-License-Identifier: GPL-3.0-or-later
// A displacement in two or three components as one number: along a line of sight, or along the main
// direction of the motion. Its length would be that too, but the length of noise is never below 0:
// small displacements would seem larger by it, and their growth smaller.
#include "series/text.h"

enum { AXES = LAC_SERIES_AXES, FEW = 4, DOUBLED = 30 };
static const double straight = 0.8; // of the squares of the motion, along its main direction

// Splits "a:mm,b:mm" at its commas, and each at its last colon.
static lac_status read_columns(const lac_series_def *def, lac_components *out, lac_error *err)
{
    char *at = out->owned = strdup(def->components);
    LAC_FAIL_MEMORY_IF(at == NULL, err);
    bool fine = true;
    for (char *rest = at; fine && rest != NULL; out->count++) {
        char *end = strchr(rest, ',');
        fine = out->count < AXES;
        if (end != NULL) {
            *end++ = '\0';
        }
        char *name = lac_text_trim(rest), *colon = strrchr(name, ':');
        if (colon != NULL) {
            *colon = '\0';
        }
        fine = fine && *name != '\0' && (colon == NULL || colon[1] != '\0');
        if (fine) {
            out->name[out->count] = name;
            out->unit[out->count] = colon != NULL ? colon + 1 : NULL;
        }
        rest = end;
    }
    return fine && out->count >= 2
               ? LAC_OK
               : lac_fail(err, LAC_EINPUT,
                          "components \"%s\" must be two or three columns, east, north and up: "
                          "\"e:mm,n:mm,u:mm\"",
                          def->components);
}

static lac_status read_sight(const lac_series_def *def, lac_components *out, lac_error *err)
{
    const char *at = def->line_of_sight;
    double square = 0.0;
    size_t n = 0;
    bool more = true;
    for (; more && n < AXES; n++) {
        char *end = NULL;
        out->direction[n] = strtod(at, &end);
        if (end == at || !isfinite(out->direction[n])) {
            break;
        }
        square += out->direction[n] * out->direction[n];
        at = end + strspn(end, " ");
        more = *at == ',';
        at += more ? 1 : 0;
    }
    LAC_FAIL_IF(
        n != out->count || more || *at != '\0' || !(square > 0.0 && isfinite(square)), err,
        LAC_EINPUT,
        "line of sight \"%s\" must be a direction, a number for each of the %zu components: "
        "\"-0.62,-0.11,0.78\"",
        def->line_of_sight, out->count);
    for (size_t i = 0; i < AXES; i++) {
        out->direction[i] /= sqrt(square);
    }
    out->sighted = true;
    return LAC_OK;
}

lac_status lac_components_read(const lac_series_def *def, lac_components *out, lac_error *err)
{
    *out = (lac_components){0};
    LAC_FAIL_IF(def->components == NULL && def->line_of_sight != NULL, err, LAC_EINPUT,
                "%s: a line of sight goes with components", def->path);
    LAC_FAIL_IF(def->components != NULL && def->displacement != NULL, err, LAC_EINPUT,
                "%s: components make the displacement: name the one or the other", def->path);
    if (def->components == NULL) {
        return LAC_OK;
    }
    LAC_TRY_RETURN(read_columns(def, out, err));
    return def->line_of_sight != NULL ? read_sight(def, out, err) : LAC_OK;
}

static bool is_whole(const lac_series *s, size_t i)
{
    for (size_t k = 0; k < AXES; k++) {
        if (s->component[k] != NULL && isnan(s->component[k][i])) {
            return false;
        }
    }
    return true;
}

static double at_axis(const lac_series *s, size_t axis, size_t i)
{
    return s->component[axis] != NULL ? s->component[axis][i] - s->component[axis][s->first] : 0.0;
}

static double median_of_3(double a, double b, double c)
{
    return fmax(fmin(a, b), fmin(fmax(a, b), c));
}

// Sums over displacements [m].
typedef struct lac_spread {
    double n, order, mean[AXES], ordered[AXES], square[AXES][AXES];
} lac_spread;

static void add(lac_spread *sum, const double x[AXES])
{
    for (size_t i = 0; i < AXES; i++) {
        sum->mean[i] += x[i];
        sum->ordered[i] += sum->n * x[i];
        for (size_t k = 0; k < AXES; k++) {
            sum->square[i][k] += x[i] * x[k];
        }
    }
    sum->order += sum->n;
    sum->n += 1.0;
}

// Of the medians of each three in a row, which have no single wrong readings; of few, all.
static void add_all(const lac_series *s, size_t n, lac_spread *sum)
{
    double last[2][AXES] = {{0.0}}, x[AXES], middle[AXES];
    size_t seen = 0;
    for (size_t i = 0; i < n; i++) {
        if (!is_whole(s, i)) {
            continue;
        }
        for (size_t k = 0; k < AXES; k++) {
            x[k] = at_axis(s, k, i);
            middle[k] = median_of_3(last[0][k], last[1][k], x[k]);
        }
        if (seen++ >= 2) {
            add(sum, middle);
        }
        memcpy(last[0], last[1], sizeof x);
        memcpy(last[1], x, sizeof x);
    }
    if (seen < FEW) {
        *sum = (lac_spread){0};
        add(sum, (const double[AXES]){0.0});
        add(sum, last[1]);
    }
}

// M to a high power is v vᵀ of its greatest eigenvalue: v is its longest column.
static void raise(double m[AXES][AXES])
{
    for (int doubled = 0; doubled < DOUBLED; doubled++) {
        double power[AXES][AXES] = {{0.0}};
        const double trace = m[0][0] + m[1][1] + m[2][2];
        for (size_t i = 0; i < AXES; i++) {
            for (size_t k = 0; k < AXES; k++) {
                for (size_t j = 0; j < AXES; j++) {
                    power[i][k] += m[i][j] / trace * (m[j][k] / trace);
                }
            }
        }
        memcpy(m, power, sizeof power);
    }
}

// The direction in which displacements spread most, from the early to the late ones.
// @return the part of the sum of squares that lies along it; 0 where nothing moves
static double find_direction(lac_spread *sum, double direction[AXES])
{
    double m[AXES][AXES], rises = 0.0, length = 0.0;
    size_t longest = 0;
    for (size_t i = 0; i < AXES; i++) {
        for (size_t k = 0; k < AXES; k++) {
            sum->square[i][k] -= sum->mean[i] * sum->mean[k] / sum->n;
            m[i][k] = sum->square[i][k];
        }
    }
    const double trace = m[0][0] + m[1][1] + m[2][2];
    if (!(trace > 0.0)) {
        memcpy(direction, (const double[AXES]){1.0, 0.0, 0.0}, AXES * sizeof *direction);
        return 0.0;
    }
    raise(m);
    for (size_t k = 1; k < AXES; k++) {
        longest = m[k][k] > m[longest][longest] ? k : longest;
    }
    for (size_t k = 0; k < AXES; k++) {
        length = hypot(length, m[k][longest]);
        rises += m[k][longest] * (sum->ordered[k] - sum->mean[k] * sum->order / sum->n);
    }
    double along = 0.0;
    for (size_t i = 0; i < AXES; i++) {
        direction[i] = (rises < 0.0 ? -1.0 : 1.0) * m[i][longest] / length;
    }
    for (size_t i = 0; i < AXES; i++) {
        for (size_t k = 0; k < AXES; k++) {
            along += direction[i] * sum->square[i][k] * direction[k];
        }
    }
    return along / trace;
}

const char *lac_series_direction(const lac_series *s, char *text, size_t size)
{
    const double *d = s->direction;
    (void)snprintf(text, size, "%.3f,%.3f", d[0], d[1]);
    if (s->component[2] != NULL) {
        lac_append(text, size, ",%.3f", d[2]);
    }
    return text;
}

static void say_direction(lac_series *s, double share)
{
    char text[LAC_SERIES_DIRECTION];
    s->doubts -= s->projected ? 1 : 0;
    s->projected = s->doubts < LAC_SERIES_DOUBTS;
    lac_series_doubt(s,
                     "displacement is taken along the main direction of motion, %s: "
                     "%.0f %% of the motion%s",
                     lac_series_direction(s, text, sizeof text), 100.0 * share,
                     share < straight ? ", which is not straight or is noise" : "");
}

void lac_series_project(lac_series *s, size_t n)
{
    s->first = 0;
    while (s->first + 1 < n && !is_whole(s, s->first)) {
        s->first++;
    }
    if (!s->sighted) {
        lac_spread sum = {0};
        add_all(s, n, &sum);
        say_direction(s, find_direction(&sum, s->direction));
    }
    for (size_t i = 0; i < s->n; i++) {
        s->displacement[i] = is_whole(s, i) ? 0.0 : NAN;
        for (size_t k = 0; k < AXES && !isnan(s->displacement[i]); k++) {
            s->displacement[i] += s->direction[k] * at_axis(s, k, i);
        }
    }
}
