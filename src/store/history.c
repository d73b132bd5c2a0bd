// SPDX-License-Identifier: GPL-3.0-or-later
// The steps of a history in the file of a solved contact, written one by one.
#include <assert.h>

#include "data/describe.h"
#include "store/writer.h"

enum { CHUNK_STEPS = 256 };

// What is put out now.
typedef struct step {
    lac_history_record record;
    lac_history_maps maps;
} step;

struct lac_history_store {
    lac_nc file;
    lac_writer writer;
    lac_history_keep keep;
    step now;
};

#define STEP const lac_history_record *r = of
#define R(kind, field) LAC_HELD(kind, lac_history_record, field)

LAC_GETTER(double, normal_force, STEP, r->pressure * r->area)
LAC_GETTER(double, shear_force_x, STEP, r->shear.traction[0] * r->area)
LAC_GETTER(double, shear_force_y, STEP, r->shear.traction[1] * r->area)
LAC_GETTER(double, highest_ratio, STEP, isnan(r->highest[0]) ? (double)NAN : r->shear.highest_ratio)
LAC_GETTER(bool, is_pressed, const lac_history_maps *m = of, m->pressed)

#define J(key) .json = "steps[]/" key
#define WHOLE .flags = LAC_WHOLE
#define MISSING .flags = LAC_MISSING

static const lac_variable of_step[] = {
    LAC_ROW("step", NULL, "1", "number of the step, increments counted", R(COUNT, number), WHOLE,
            .comment = "from 1; 0 is the start, which is not written"),
    LAC_ROW("normal_force", NULL, "N", "normal force on the interface", G(normal_force), J("p_N")),
    LAC_ROW("shear_force_x", NULL, "N", "shear force on the interface along x", G(shear_force_x),
            J("q_N")),
    LAC_ROW("shear_force_y", NULL, "N", "shear force on the interface along y", G(shear_force_y),
            J("q_y_N")),
    LAC_ROW("shift_x", NULL, "m", "shift of one body against the other along x, far away",
            R(REAL, shear.shift[0]), J("shift_m")),
    LAC_ROW("shift_y", NULL, "m", "shift of one body against the other along y, far away",
            R(REAL, shear.shift[1]), J("shift_y_m")),
    {J("contact_cells"), R(COUNT, shear.contact_cells)},
    LAC_ROW("stick_cells", NULL, "1", "contact cells that stick", R(COUNT, shear.stick_cells),
            WHOLE, J("stick_cells")),
    LAC_ROW("slip_cells", NULL, "1", "contact cells that slip", R(COUNT, shear.slip_cells), WHOLE,
            J("slip_cells")),
    LAC_ROW("dissipation", NULL, "J", "frictional work of the step", R(REAL, shear.dissipation),
            J("dissipation_J")),
    LAC_ROW("cumulative_dissipation", NULL, "J", "frictional work since the start",
            R(REAL, dissipated), J("cumulative_dissipation_J")),
    LAC_ROW("cycle_start", NULL, "1", "earlier step to whose loads this one comes back",
            R(COUNT, cycle_start), .flags = LAC_WHOLE | LAC_MISSING, J("cycle_start"),
            .comment = "missing where it comes back to none; 0: the start"),
    LAC_ROW("cycle_dissipation", NULL, "J", "frictional work since that step",
            R(REAL, cycle_dissipation), MISSING, J("cycle_dissipation_J"),
            .comment = "missing where the step ends no cycle"),
    LAC_ROW("cycle_shift", NULL, "m", "shift left over since that step", R(REAL, cycle_shift),
            MISSING, J("cycle_shift_m"),
            .comment = "0: a closed loop; missing where the step ends no cycle"),
    LAC_ROW("highest_ratio", NULL, "1", "highest q/(f p) of the cells that stick", G(highest_ratio),
            MISSING, J("highest_ratio"), .comment = "missing where none does"),
    LAC_ROW("highest_x", NULL, "m", "where it is along x", R(REAL, highest[0]), MISSING,
            J("highest_x_m")),
    LAC_ROW("highest_y", NULL, "m", "where it is along y", R(REAL, highest[1]), MISSING,
            J("highest_y_m")),
    LAC_ROW("shear_iterations", NULL, "1", "iterations of the shear solver",
            R(INT64, shear.iterations), WHOLE, J("iterations")),
    LAC_ROW("shear_products", NULL, "1", "applications of the elastic operator",
            R(INT64, shear.products), WHOLE, J("products")),
    {J("contact_iterations"), R(INT64, contact_iterations)},
    LAC_ROW("shear_residual", NULL, "1", "how far the conditions of the solution are from holding",
            R(REAL, shear.residual), J("residual")),
    LAC_ROW("contact_iterations", NULL, "1", "iterations of the normal contact solver",
            R(INT64, contact_iterations), WHOLE, .comment = "0 where the pressure did not change"),
};

lac_variables lac_history_steps(size_t stride)
{
    return (lac_variables)LAC_VARIABLES(of_step, "step", stride);
}

#define MAP(kind, field) LAC_HELD(kind, lac_history_maps, field), .flags = LAC_CELLS | LAC_LATE
static const lac_variable of_maps[] = {
    LAC_ROW("traction_x", NULL, "Pa", "shear traction along x", MAP(REALS, traction[0])),
    LAC_ROW("traction_y", NULL, "Pa", "shear traction along y", MAP(REALS, traction[1])),
    LAC_ROW("slip_x", NULL, "m", "slip along x since the start", MAP(REALS, slip[0])),
    LAC_ROW("slip_y", NULL, "m", "slip along y since the start", MAP(REALS, slip[1])),
    LAC_ROW("state", NULL, "1", "whether a cell is open, sticks or slips", MAP(BYTES, state),
            .meanings = "open stick slip"),
    LAC_ROW("step_pressure", NULL, "Pa", "normal contact pressure of the step",
            MAP(REALS, pressure), .has = is_pressed, .comment = "`pressure` is that of the start"),
};

lac_variables lac_history_cells(lac_history_keep keep)
{
    return (lac_variables)LAC_VARIABLES(of_maps, keep == LAC_KEEP_ALL ? "step y x" : "y x", 0);
}

static lac_status describe(const lac_history_store_def *def, const step *now, lac_error *err)
{
    const lac_extent dim = {"step", LAC_GROWS};
    const lac_laid laid[] = {{lac_history_steps(0), &now->record},
                             {lac_history_cells(def->keep), &now->maps}};
    LAC_TRY_RETURN(lac_dataset_dims(def->contact, &dim, 1, err));
    return lac_dataset_add(def->contact, laid, def->keep == LAC_KEEP_NONE ? 1 : 2, err);
}

static lac_status begin_file(lac_history_store *s, const lac_history_store_def *def, lac_error *err)
{
    LAC_TRY_RETURN(lac_nc_create(&s->file, def->path, def->force, err));
    LAC_TRY_RETURN(lac_provenance_put(&def->provenance, def->contact->summary, lac_nc_put_attribute,
                                      &s->file, err));
    LAC_TRY_RETURN(lac_writer_begin(&s->writer, err));
    LAC_TRY_RETURN(lac_nc_text(&s->file, NC_GLOBAL, "status", "running", err));
    LAC_TRY_RETURN(lac_nc_sync(&s->file, err));
    LAC_TRY_RETURN(lac_nc_keep_journal(&s->file, err));
    LAC_TRY_RETURN(lac_nc_publish(&s->file, err));
    return LAC_OK;
}

lac_status lac_history_store_create(const lac_history_store_def *def, lac_history_store **out,
                                    lac_error *err)
{
    lac_status status;
    lac_history_store *s = *out = calloc(1, sizeof *s);
    LAC_FAIL_MEMORY_IF(s == NULL, err);
    s->file.fd = -1;
    s->keep = def->keep;
    s->now.maps.pressed = def->pressed;
    s->writer = (lac_writer){
        .file = &s->file, .dataset = def->contact, .deflate = 1, .chunk = CHUNK_STEPS, .batch = 1};
    LAC_TRY(describe(def, &s->now, err));
    LAC_TRY(begin_file(s, def, err));
out:
    LAC_MADE(status, out, lac_history_store_free);
}

static lac_status put(lac_history_store *store, lac_error *err)
{
    LAC_TRY_RETURN(lac_writer_put(&store->writer, "step", NULL, err));
    return lac_writer_sync(&store->writer, err);
}

// Where its maps come next both are written together: no step without its maps is left by a kill.
lac_status lac_history_store_step(lac_history_store *store, const lac_history_record *record,
                                  lac_error *err)
{
    store->now.record = *record;
    return store->keep != LAC_KEEP_ALL ? put(store, err) : LAC_OK;
}

lac_status lac_history_store_maps(lac_history_store *store, const lac_history_maps *maps,
                                  lac_error *err)
{
    assert(store->keep != LAC_KEEP_NONE && store->now.record.number > 0);
    store->now.maps = *maps;
    if (store->keep == LAC_KEEP_ALL) {
        return put(store, err);
    }
    LAC_TRY_RETURN(lac_writer_put_late(&store->writer, err));
    return lac_writer_sync(&store->writer, err);
}

lac_status lac_history_store_finish(lac_history_store *store, const char *status, lac_error *err)
{
    assert(store->file.open);
    lac_status first = lac_dataset_put_attributes(store->writer.dataset, true, lac_nc_put_attribute,
                                                  (void *)&store->file, err);
    const char *said = first == LAC_OK ? status : "failed";
    lac_error *later = first == LAC_OK ? err : NULL;
    lac_status second = lac_nc_text(&store->file, NC_GLOBAL, "status", said, later);
    lac_status third = lac_nc_close(&store->file, second == LAC_OK ? later : NULL);
    return first != LAC_OK ? first : second != LAC_OK ? second : third;
}

void lac_history_store_free(lac_history_store *store)
{
    if (store != NULL) {
        lac_writer_clear(&store->writer);
        lac_nc_clear(&store->file);
        free(store);
    }
}
