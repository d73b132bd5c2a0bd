// SPDX-License-Identifier: GPL-3.0-or-later
// The contact of a case, pressed from its surface or stated without one, and its fractal measures,
// for which coarser grids are solved under the same load.
#include "scene/internal.h"

lac_contact_def lac_scene_contact_def(const lac_scene_contact *contact)
{
    lac_contact_def def = lac_contact_default();
    def.grid = contact->grid;
    def.heights = contact->heights;
    def.e_star = contact->e_star;
    def.tolerance = contact->tolerance;
    def.mean_pressure = contact->mean_pressure;
    return def;
}

// The faces do not touch: by how much.
static lac_status fail_apart(const lac_contact_def *def, lac_error *err)
{
    return lac_fail(err, LAC_EINPUT,
                    "the faces do not touch: at an approach of %g m the highest peak, %g m above "
                    "the mean of the heights, is short of it",
                    def->approach, lac_contact_peak(def));
}

// Presses the surface; heights, pressure and, where it is kept, gap are allocated here: of ranks
// their rows.
static lac_status press(const lac_case *c, lac_scene_keep keep, lac_scene_contact *out,
                        lac_error *err)
{
    const lac_normal_load *normal = (const lac_normal_load *)c->normal.info;
    const size_t cells = lac_strip_rows(c->team, out->grid.ny).n * out->grid.nx + 1;
    const bool fields = keep != LAC_SCENE_DOMAIN;
    out->heights = malloc(cells * sizeof *out->heights);
    out->gap = fields ? malloc(cells * sizeof *out->gap) : NULL;
    out->pressure = malloc(cells * sizeof *out->pressure);
    LAC_FAIL_MEMORY_IF(
        out->heights == NULL || (fields && out->gap == NULL) || out->pressure == NULL, err);
    lac_status status =
        lac_surface_share(&c->surface, &out->grid, c->team, out->heights, &out->surface, err);
    LAC_TRY_RETURN(lac_fail_within(err, status, "interface.surface"));
    out->e_star = c->material.shear_modulus / (1.0 - c->material.poisson);
    out->tolerance = c->contact_tolerance;
    lac_contact_def def = lac_scene_contact_def(out);
    def.team = c->team;
    const bool near = normal != NULL && normal->approach != NULL;
    const bool dense = normal != NULL && normal->dimension != NULL;
    def.control = near ? LAC_CONTROL_APPROACH : LAC_CONTROL_LOAD;
    def.approach = near ? normal->approach(c->normal.params) : 0.0;
    status = dense ? lac_dimension_solve(&def, normal->dimension(c->normal.params), out->pressure,
                                         out->gap, &out->report, err)
                   : lac_contact_solve(&def, out->pressure, out->gap, &out->report, err);
    if (status == LAC_OK && out->report.n_cells == 0) {
        status = fail_apart(&def, err);
    }
    out->solved = status == LAC_OK;
    if (near || dense) {
        out->mean_pressure = out->report.mean_pressure;
    }
    return lac_fail_within(err, status, "contact");
}

static void drop_fields(lac_scene_contact *contact)
{
    free(contact->heights);
    free(contact->gap);
    free(contact->pressure);
    contact->heights = NULL;
    contact->gap = NULL;
    contact->pressure = NULL;
}

// The pressure of every cell of a domain that no surface made.
static lac_status scatter(lac_scene_contact *out, lac_error *err)
{
    out->pressure = calloc(lac_grid_cells(&out->grid), sizeof *out->pressure);
    LAC_FAIL_MEMORY_IF(out->pressure == NULL, err);
    for (size_t i = 0; i < out->domain->n; i++) {
        out->pressure[out->domain->index[i]] = out->domain->pressure[i];
    }
    return LAC_OK;
}

// The fields of all ranks, on the one that leads.
static lac_status gather(lac_team *team, lac_scene_contact *out, lac_error *err)
{
    const lac_strip rows = lac_strip_rows(team, out->grid.ny);
    const uint64_t wants[LAC_TEAM_MOST][2] = {{0, out->grid.ny}}; // of the first alone
    const size_t row = out->grid.nx * sizeof(double);
    double **const fields[] = {&out->heights, &out->gap, &out->pressure};
    for (size_t k = 0; k < sizeof fields / sizeof *fields; k++) {
        double *whole = lac_team_alloc(team, lac_team_leads(team) ? out->grid.ny * row : 0);
        LAC_FAIL_MEMORY_IF(whole == NULL, err);
        lac_strip_exchange(&rows, wants, row, *fields[k], whole);
        free(*fields[k]);
        *fields[k] = whole;
    }
    return LAC_OK;
}

static lac_status make_domain(const lac_case *c, lac_scene_keep keep, lac_scene_contact *out,
                              lac_error *err)
{
    if (c->surface.info != NULL) {
        LAC_TRY_RETURN(press(c, keep, out, err));
        LAC_TRY_RETURN(lac_domain_gather(&out->grid, c->team, out->pressure, &out->domain, err));
    } else {
        LAC_TRY_RETURN(lac_scene_domain_create(c, &out->domain, err));
    }
    if (keep == LAC_SCENE_DOMAIN) {
        drop_fields(out);
        return LAC_OK;
    }
    if (c->surface.info == NULL) {
        return scatter(out, err);
    }
    LAC_TRY_RETURN(c->team != NULL ? gather(c->team, out, err) : LAC_OK);
    lac_surface_stats *of =
        keep == LAC_SCENE_MEASURED && lac_team_leads(c->team) ? &out->surface : NULL;
    return lac_fail_within(err, lac_surface_look(&c->surface, &out->grid, out->heights, of, err),
                           "interface.surface");
}

// Of a plane; the length of a line or a row. [cells]
static size_t shorter_side(const lac_grid *grid)
{
    if (grid->nx == 1 || grid->ny == 1) {
        return lac_grid_cells(grid);
    }
    return grid->nx < grid->ny ? grid->nx : grid->ny;
}

lac_status lac_scene_contact_count(lac_scene_contact *out, lac_error *err)
{
    out->blocks = lac_dyadic_count(out->domain);
    // Three box sides at least; a smaller grid has no dimension to speak of.
    if (shorter_side(&out->grid) < 64 || out->domain->n <= 1) {
        return LAC_OK;
    }
    const lac_box_def boxes = lac_box_default();
    lac_status status = lac_box_dimension(out->domain, &boxes, &out->boxes, err);
    out->counted = status == LAC_OK;
    return status;
}

lac_status lac_scene_contact_solve(const lac_case *c, lac_scene_keep keep, lac_scene_contact *out,
                                   lac_error *err)
{
    lac_status status = LAC_OK;
    *out = (lac_scene_contact){.grid = lac_interface_grid(&c->interface), .e_star = NAN};
    out->mean_pressure = lac_case_pressure(c);
    LAC_TRY(make_domain(c, keep, out, err));
    LAC_TRY(lac_scene_contact_count(out, err));
out:
    if (status != LAC_OK) {
        lac_scene_contact_clear(out);
    }
    return status;
}

void lac_scene_contact_clear(lac_scene_contact *contact)
{
    drop_fields(contact);
    lac_domain_free(contact->domain);
    contact->domain = NULL;
}

lac_scene_measure_def lac_scene_measure_default(void)
{
    static const double sizes[] = {0.05, 0.1, 0.2, 0.4, 1, 10, 100, 1000};
    lac_scene_measure_def def = {.scaling = lac_scaling_default(),
                                 .boxes = lac_box_default(),
                                 .sizes = sizeof sizes / sizeof sizes[0]};
    memcpy(def.size, sizes, sizeof sizes);
    return def;
}

static lac_status measure_clusters(lac_scene_contact *contact, lac_error *err)
{
    lac_clusters *clusters = NULL;
    LAC_TRY_RETURN(lac_clusters_create(contact->domain, &clusters, err));
    contact->fractal.clusters = lac_clusters_summarise(clusters, &contact->grid);
    contact->fractal.clustered = true;
    lac_clusters_free(clusters);
    return LAC_OK;
}

// Solves the coarser resolutions under the load of the finest, which is there.
static lac_status measure_scaling(const lac_scaling_def *how, lac_scene_contact *contact,
                                  lac_error *err)
{
    LAC_FAIL_IF(!contact->solved, err, LAC_EINPUT, "no surface is pressed");
    const lac_contact_def def = lac_scene_contact_def(contact);
    lac_scaling_def scaling = *how;
    scaling.finest = contact->pressure;
    lac_status status = lac_scaling_measure(&def, &scaling, &contact->fractal.scaling, err);
    double dimension = contact->fractal.scaling.dimension;
    LAC_FAIL_IF(status == LAC_OK && !(dimension > 0 && dimension <= 2), err, LAC_EINPUT,
                "the areas follow no law: it would be %.3g", dimension);
    return status;
}

static lac_status measure_sizes(const lac_scene_measure_def *def, lac_scene_contact *contact,
                                lac_error *err)
{
    lac_scene_fractal *fractal = &contact->fractal;
    const lac_grid *grid = &contact->grid;
    const lac_size_def size = {.dimension = fractal->scaling.dimension,
                               .error = fractal->scaling.error,
                               .size = sqrt(lac_grid_area(grid)),
                               .pressure = contact->mean_pressure};
    fractal->sizes = def->sizes;
    return lac_size_effect(&size, def->sizes, def->size, fractal->size, err);
}

static bool same_boxes(const lac_box_def *a, const lac_box_def *b)
{
    return a->smallest == b->smallest && a->largest == b->largest && a->origins == b->origins &&
           a->seed == b->seed;
}

lac_status lac_scene_contact_measure(const lac_scene_measure_def *def, lac_scene_contact *contact,
                                     lac_error *err)
{
    lac_scene_fractal *fractal = &contact->fractal;
    lac_box_def counted = lac_box_default();
    *fractal = (lac_scene_fractal){0};
    LAC_FAIL_IF(def->sizes > LAC_SCENE_SIZES, err, LAC_EINPUT,
                "size effect: %zu specimens; at most %d", def->sizes, LAC_SCENE_SIZES);
    if (!same_boxes(&def->boxes, &counted)) {
        contact->counted = false;
        LAC_TRY_RETURN(lac_box_dimension(contact->domain, &def->boxes, &contact->boxes, err));
        contact->counted = true;
    }
    LAC_TRY_RETURN(measure_clusters(contact, err));
    lac_status status = measure_scaling(&def->scaling, contact, &fractal->why);
    fractal->scaled = status == LAC_OK;
    LAC_FAIL_MEMORY_IF(status == LAC_ENOMEM, err);
    return fractal->scaled ? measure_sizes(def, contact, err) : LAC_OK;
}
