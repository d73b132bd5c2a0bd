// SPDX-License-Identifier: GPL-3.0-or-later
// What the contact of a joint came to, as tables: maps, measures of surface and contact, and how it
// was solved.
#include "base/statistics.h"
#include "base/vsum.h"
#include "data/describe.h"
#include "scene/internal.h"

#define CONTACT const lac_scene_contact *c = of
#define FACE const lac_file_report *f = of

LAC_GETTER(double, place_x, CONTACT, ((double)at[0] + 0.5) * c->grid.dx)
LAC_GETTER(double, place_y, CONTACT, ((double)at[0] + 0.5) * c->grid.dy)

LAC_GETTER(double, cells, CONTACT, (double)c->domain->n)
LAC_GETTER(double, fraction, CONTACT, (double)c->domain->n / (double)lac_grid_cells(&c->grid))

// Over the cells that touch.
LAC_GETTER(double, real_pressure, CONTACT,
           lac_sum(c->domain->n, c->domain->pressure) / (double)c->domain->n)
LAC_GETTER(double, max_pressure, CONTACT, lac_vmost(c->domain->n, c->domain->pressure))

LAC_GETTER(double, report_fraction, CONTACT,
           (double)c->report.n_cells / (double)lac_grid_cells(&c->grid))
LAC_GETTER(double, penetration_size, CONTACT, fabs(c->report.penetration))
LAC_GETTER(double, jrc_in_range, CONTACT,
           c->surface.measures.jrc >= 0.0 && c->surface.measures.jrc <= 20.0)

static const char *const fit_words[] = {"cropped", "padded", "resampled"};
static const char *const boundaries[] = {"free", "periodic"};
static const char *const measured[] = {"interface", "file", "part", "composite"};

#define C(kind, field) LAC_HELD(kind, lac_scene_contact, field)
#define WHOLE .flags = LAC_WHOLE

static const lac_variable of_domain[] = {
    {.json = "n_cells", G(cells)},
    {.json = "grid", C(COUNT, grid.nx)},
    {.json = "grid", C(COUNT, grid.ny)},
    {.json = "cell_size_m", C(REAL, grid.dx)},
    {.json = "cell_width_m", C(REAL, grid.dy)},
    {.name = "boundary", .json = "boundary", C(BOOL, grid.periodic), .names = boundaries},
    {.json = "contact_fraction", G(fraction)},
    {.json = "max_pressure_Pa", G(max_pressure)},
    {.json = "mean_real_pressure_Pa", G(real_pressure)},
};

static const lac_variable of_contact[] = {
    LAC_ROW("y", "y", "m", "position of the cell's centre along y", G(place_y), .axis = "Y"),
    LAC_ROW("x", "x", "m", "position of the cell's centre along x, the direction of slip",
            G(place_x), .axis = "X"),
    LAC_ROW("heights", "y x", "m", "composite height of the two surfaces", C(REALS, heights),
            .comment = "peaks up; contact of the sum on a flat"),
    LAC_ROW("gap", "y x", "m", "gap between the surfaces under load", C(REALS, gap),
            .comment = "zero in contact, within the solver's tolerance"),
    LAC_ROW("pressure", "y x", "Pa", "normal contact pressure", C(REALS, pressure),
            .comment = "exactly zero outside the contact"),
    {.json = "mean_pressure_Pa", C(REAL, mean_pressure)},
};

#define S(kind, field) LAC_HELD(kind, lac_scene_contact, report.field)
#define M(name_, unit_, field)                                               \
    {                                                                        \
        .name = "surface_" name_, .json = "surface/" name_, .unit = (unit_), \
        LAC_HELD(REAL, lac_scene_contact, surface.measures.field)            \
    }
static const lac_variable of_solved[] = {
    {.name = "n_cells", S(COUNT, n_cells), WHOLE},
    {.name = "contact_fraction", G(report_fraction)},
    {.name = "mean_pressure_Pa", .unit = "Pa", S(REAL, mean_pressure)},
    {.name = "max_pressure_Pa", .unit = "Pa", S(REAL, max_pressure)},
    {.name = "load_error", S(REAL, load_error)},
    {.name = "penetration_m", .unit = "m", S(REAL, penetration)},
    {.name = "iterations", .json = "iterations", S(INT64, iterations), WHOLE},
    {.name = "operator_products", .json = "products", S(INT64, products), WHOLE},
    {.name = "complementarity_error",
     .json = "complementarity_error",
     S(REAL, complementarity_error)},
    {.json = "penetration_m", G(penetration_size)},
    {.name = "approach_m", .unit = "m", .json = "approach_m", S(REAL, approach)},
    {.name = "surface_measured",
     .json = "surface/measured",
     C(INT, surface.measured),
     .names = measured},
    M("rms_height_m", "m", rms_height),
    M("rms_slope_x", NULL, rms_slope_x),
    M("rms_slope_y", NULL, rms_slope_y),
    M("hurst", NULL, hurst),
    M("hurst_error", NULL, hurst_error),
    M("hurst_misfit", NULL, hurst_misfit),
    M("hurst_shortest_m", "m", fit_shortest),
    M("hurst_longest_m", "m", fit_longest),
    M("z2", NULL, z2),
    M("z2_step_m", "m", z2_step),
    M("jrc", NULL, jrc),
    {.json = "surface/jrc_in_range", G(jrc_in_range), .flags = LAC_TRUTH},
};

#define P(json_, field) LAC_JSON("surface/profiles[]/" json_, REAL, lac_profile_measure, field)
static const lac_variable of_profiles[] = {P("step_m", step), P("z2", z2), P("jrc", jrc),
                                           P("jrc_yu_vayssade", jrc_yu)};

#define F(json_, kind, field) LAC_JSON("surface/files[]/" json_, kind, lac_file_report, field)
static const lac_variable of_files[] = {
    F("path", TEXT, path),
    F("format", TEXT, format),
    F("nx", COUNT, nx),
    F("ny", COUNT, ny),
    F("dx_m", REAL, dx),
    F("dy_m", REAL, dy),
    F("height_unit", CHARS, height_unit),
    F("lateral_unit", CHARS, lateral_unit),
    F("without_height", COUNT, masked),
    {.json = "surface/files[]/fit", LAC_HELD(INT, lac_file_report, fit), .names = fit_words},
};

static const lac_variable of_outcome[] = {
    {.name = "status", LAC_HELD(TEXT, lac_contact_outcome, status)}};

#define RESULT const lac_history_result *r = ((const lac_contact_outcome *)of)->result
#define AREA lac_grid_area(&((const lac_contact_outcome *)of)->contact->grid)
LAC_GETTER(bool, loaded, RESULT, r->loaded)
LAC_GETTER(double, slip_factor, RESULT, r->first_slip.factor)
LAC_GETTER(double, slip_load, RESULT, r->first_slip.load *AREA)
LAC_GETTER(double, slip_x, RESULT, r->first_place[0])
LAC_GETTER(double, slip_y, RESULT, r->first_place[1])
LAC_GETTER(double, slip_shift_x, RESULT, r->first_slip.shift[0])
LAC_GETTER(double, slip_shift_y, RESULT, r->first_slip.shift[1])
LAC_GETTER(double, planned, RESULT, (double)r->planned)

#define FIRST(name_, getter)                                                                \
    {                                                                                       \
        .name = "first_slip_" name_, .json = "first_slip/" name_, G(getter), .has = loaded, \
        .flags = LAC_LATE                                                                   \
    }
static const lac_variable of_history[] = {
    LAC_JSON("status", TEXT, lac_contact_outcome, status),
    {.name = "friction_coefficient", LAC_HELD(REAL, lac_contact_outcome, friction)},
    {.json = "friction_coefficient", LAC_HELD(REAL, lac_contact_outcome, friction)},
    {.json = "planned_steps", G(planned)},
    FIRST("q_over_fp", slip_factor),
    {.json = "first_slip/q_N", G(slip_load)},
    FIRST("x_m", slip_x),
    FIRST("y_m", slip_y),
    {.json = "first_slip/shift_m", G(slip_shift_x)},
    {.json = "first_slip/shift_y_m", G(slip_shift_y)},
};

// In a file the steps are added as they come.
static lac_status add_history(lac_dataset *d, const lac_contact_outcome *o, lac_error *err)
{
    const lac_extent step = {"step", o->result->steps};
    const lac_laid laid[] = {{LAC_VARIABLES(of_history, "", 0), o},
                             {lac_history_steps(sizeof *o->record), o->record},
                             {lac_history_cells(o->keep), o->maps}};
    lac_status status = lac_dataset_add(d, laid, 1, err);
    if (status == LAC_OK && o->record != NULL) {
        status = lac_dataset_dims(d, &step, 1, err);
        status =
            status == LAC_OK ? lac_dataset_add(d, laid + 1, o->maps != NULL ? 2 : 1, err) : status;
    }
    return status;
}

static const char *face_text(const lac_file_report *file, char room[LAC_TEXT_ROOM])
{
    char apart[64] = "";
    if (!isnan(file->dx) && !isnan(file->dy)) {
        (void)snprintf(apart, sizeof apart, " %g x %g m apart", file->dx, file->dy);
    }
    (void)snprintf(room, LAC_TEXT_ROOM,
                   "%s, %zu x %zu samples%s, heights in %s, %zu without height, %s", file->format,
                   file->nx, file->ny, apart, file->height_unit, file->masked,
                   fit_words[file->fit]);
    return room;
}
LAC_TEXT_GETTER(face, FACE, face_text(f, room))

static lac_status add_faces(lac_dataset *d, const lac_surface_stats *s, lac_error *err)
{
    static const lac_variable rows[] = {{.dims = "", LAC_HELD(TEXT, lac_file_report, path)},
                                        {.dims = "", T(face)}};
    lac_status status = LAC_OK;
    for (size_t i = 0; i < 2 * s->files && status == LAC_OK; i++) {
        const char *which = s->files < 2 ? "file" : i < 2 ? "upper" : "lower";
        char name[40];
        (void)snprintf(name, sizeof name, "surface_%s%s", which, i % 2 == 0 ? "_path" : "");
        const lac_named named = {.name = name, .long_name = ""};
        status = lac_dataset_add_named(d, &rows[i % 2], &named, &s->file[i / 2], err);
    }
    return status;
}

lac_status lac_contact_describe(const lac_contact_outcome *o, lac_dataset **out, lac_error *err)
{
    const lac_scene_contact *c = o->contact;
    const lac_surface_stats *s = c->solved ? &c->surface : NULL;
    const lac_extent dims[] = {{"y", c->grid.ny},
                               {"x", c->grid.nx},
                               {"profile", s != NULL ? s->measures.profiles : 0},
                               {"face", s != NULL ? s->files : 0}};
    const lac_laid domain = {LAC_VARIABLES(of_domain, "", 0), c};
    const lac_laid laid[] = {
        {LAC_VARIABLES(of_contact, "", 0), c},
        {LAC_VARIABLES(of_solved, "", 0), c->solved ? c : NULL},
        {LAC_VARIABLES(of_profiles, "profile", sizeof(lac_profile_measure)),
         s != NULL ? s->measures.profile : NULL},
        {LAC_VARIABLES(of_files, "face", sizeof(lac_file_report)), s != NULL ? s->file : NULL},
        {LAC_VARIABLES(of_outcome, "", 0), o}};
    lac_status status;
    LAC_TRY(lac_dataset_create(
        o->result != NULL
            ? "Contact of a rough rock joint through a history of normal and shear load: forces, "
              "shifts and frictional work of each step, and which cells stick or slip."
            : "Contact of a rough rock joint under normal load: maps over the interface, and the "
              "fractal measures of the contact domain.",
        out, err));
    LAC_TRY(lac_dataset_dims(*out, dims, sizeof dims / sizeof *dims, err));
    LAC_TRY(lac_dataset_add(*out, &domain, 1, err));
    LAC_TRY(lac_describe_dimension(c, *out, err));
    if (o->brief) {
        goto out;
    }
    LAC_TRY(lac_dataset_add(*out, laid, sizeof laid / sizeof *laid, err));
    LAC_TRY(s != NULL ? add_faces(*out, s, err) : LAC_OK);
    LAC_TRY(lac_describe_fractal(c, *out, err));
    LAC_TRY(o->result != NULL ? add_history(*out, o, err) : LAC_OK);
out:
    LAC_MADE(status, out, lac_dataset_free);
}
