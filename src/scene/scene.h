/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "case/case.h"
#include "scene/lump.h"
#include "store/store.h"

enum { LAC_SCENE_SIZES = 32 };

/// What is measured of a contact beyond what a run needs.
typedef struct lac_scene_fractal {
    bool clustered; ///< `clusters` holds
    lac_cluster_summary clusters;
    bool scaled; ///< the contact was solved at coarser resolutions too: `scaling`, `sizes` hold
    lac_scaling scaling;
    lac_error why;                           ///< why not `scaled`
    size_t sizes;                            ///< specimens
    lac_size_strength size[LAC_SCENE_SIZES]; ///< [sizes] relative to the interface itself
} lac_scene_fractal;

/// How it is measured.
typedef struct lac_scene_measure_def {
    lac_scaling_def scaling; ///< `finest` is filled in
    lac_box_def boxes;
    size_t sizes;                 ///< specimens, at most LAC_SCENE_SIZES
    double size[LAC_SCENE_SIZES]; ///< [sizes] their sides [m]
} lac_scene_measure_def;

/// The contact part of a scene: surface -> contact -> fractal measures.
typedef struct lac_scene_contact {
    lac_grid grid;
    double mean_pressure;      ///< total, over the nominal area [Pa]
    double e_star;             ///< [Pa]; NaN where no surface is pressed
    double *heights, *gap;     ///< [ny * nx] [m]; NULL where there is no surface
    double *pressure;          ///< [ny * nx] [Pa]
    lac_surface_stats surface; ///< what the heights look like, where they are kept
    double tolerance;          ///< that it is solved to, relative
    bool solved;               ///< a surface was pressed: `report` holds
    lac_contact_stats report;
    bool counted; ///< box counting was possible: `boxes` holds
    lac_box_count boxes;
    lac_dyadic blocks;         ///< of the grid itself
    lac_scene_fractal fractal; ///< filled by lac_scene_contact_measure
    lac_domain *domain;
} lac_scene_contact;

/// What a case's load.history came to.
typedef struct lac_history_result {
    size_t steps, planned;     ///< solved, of the whole history
    bool loaded;               ///< a shear load was reached and `first_slip` solved
    lac_first_slip first_slip; ///< of the joint without any slip, under the first shear load
    double first_place[2];     ///< centre of its cell [m]
} lac_history_result;

/// A contact as it is told.
typedef struct lac_contact_outcome {
    const lac_scene_contact *contact;
    const char *status;               ///< complete; NULL: not yet said
    bool brief;                       ///< grid, pressures and dimension alone, for JSON
    double friction;                  ///< of the history; NaN
    const lac_history_result *result; ///< same; NULL: there is none
    const lac_history_record *record; ///< [result->steps] where they do not come; NULL: they do
    const lac_history_maps *maps;     ///< of the last or, [result->steps] of each, of all these
    lac_history_keep keep;            ///< which
} lac_contact_outcome;

/// Its variables, for a file or JSON; docs/format.md.
/// @param outcome  with all that it points to must outlive the dataset
lac_status lac_contact_describe(const lac_contact_outcome *outcome, lac_dataset **out,
                                lac_error *err);

/// Where the steps of a history go, as they are solved. Members may be NULL.
typedef struct lac_history_sink {
    void *context;
    /// @return LAC_OK; else the history ends with this status
    lac_status (*step)(void *context, const lac_history_record *record, lac_error *err);
    /// Cell by cell, after each step or after the last one, as load.history.fields says.
    lac_status (*maps)(void *context, const lac_history_maps *maps, lac_error *err);
    /// Asked before each step: whether to end here.
    bool (*interrupted)(void *context);
} lac_history_sink;

/// The contact cells of a case that presses no surface, each with its pressure.
/// @return LAC_OK; LAC_EINPUT (empty, a file of another grid or load); LAC_EIO; LAC_ENOMEM
lac_status lac_scene_domain_create(const lac_case *c, lac_domain **domain, lac_error *err);

/// Number of steps of a case's history, all increments counted.
size_t lac_scene_history_steps(const lac_case *c);

/// Whether its pressures change on the way.
bool lac_scene_history_presses(const lac_case *c);

/// Goes through the history of a case: presses anew where the pressure changes, from the pressures
/// before, and shears; docs/theory/tangential.md.
/// A step ends a cycle when it comes back to the controls of an earlier one (the latest; or of the
/// start): the pressure and, of each axis, the load or shift that is controlled, within 1e-6 of the
/// largest so far, other controls having been in between.
/// @param contact  of the case, solved with LAC_SCENE_MEASURED; its pressures are where the history
/// starts
/// @return LAC_OK; LAC_EINPUT; LAC_ENUMERIC; LAC_EINTERRUPT; LAC_ENOMEM; what the sink returns.
///         The steps up to there have gone to the sink.
lac_status lac_scene_history_run(const lac_case *c, const lac_scene_contact *contact,
                                 const lac_history_sink *sink, lac_history_result *result,
                                 lac_error *err);

/// What a file says of the case it was made from; the command line, the libraries and the time are
/// the caller's.
lac_provenance lac_case_provenance(const lac_case *c, const char *case_text);

/// The same of a dataset that outlives its maker: with the case's text, freed by free().
typedef struct lac_made_from {
    lac_provenance provenance;
    char *case_text;
} lac_made_from;

lac_status lac_made_from_case(const lac_case *c, lac_made_from *out, lac_error *err);

/// Everything that a case's run needs, built stage by stage; only what the case names.
typedef struct lac_scene {
    const lac_case *source;
    lac_scene_contact contact;
    lac_hierarchy *hierarchy;
    lac_transfer transfer;
    lac_weakening_set weakening; ///< what weakens the cells besides friction
    lac_friction *friction;
    lac_load_set loads;
    double damping;       ///< [Pa s/m]
    lac_problem *problem; ///< of all contact cells
    lac_lump *lump;       ///< where the case lumps them; NULL
} lac_scene;

/// The problem that a run of the scene solves.
static inline const lac_problem *lac_scene_problem(const lac_scene *scene)
{
    return scene->lump != NULL ? scene->lump->problem : scene->problem;
}

/// What is kept of a contact besides its domain.
typedef enum lac_scene_keep {
    LAC_SCENE_DOMAIN,   ///< nothing
    LAC_SCENE_FIELDS,   ///< heights, gaps and pressures
    LAC_SCENE_MEASURED, ///< those, and what the surface is like
} lac_scene_keep;

/// Solves the contact of a case.
lac_status lac_scene_contact_solve(const lac_case *c, lac_scene_keep keep, lac_scene_contact *out,
                                   lac_error *err);

/// Area scaling from 64 cells a side where the grid has four resolutions, the finest left out;
/// boxes as lac_box_default; specimens of 50, 100, 200 and 400 mm, 1, 10, 100 m and 1 km.
lac_scene_measure_def lac_scene_measure_default(void);

/// How it is measured as options of `lacuna contact` say it; NULL: not said.
typedef struct lac_measure_words {
    const char *boxes, *coarsest, *coarsening, *sizes;
} lac_measure_words;

/// @return LAC_OK; LAC_EINPUT ("boxes: ... must be ..."); LAC_ENOMEM
lac_status lac_scene_measure_read(const lac_measure_words *words, lac_scene_measure_def *out,
                                  lac_error *err);

/// Measures the contact that was solved with LAC_SCENE_MEASURED: clusters, area scaling, size
/// effect; counts the boxes again where `def` asks for other ones. A contact whose area has no
/// scaling (grid too small, no surface, coarse grids not solved) is measured all the same:
/// `fractal.why` says why it has none.
/// @return LAC_OK; LAC_ENOMEM; LAC_EINPUT (sizes of boxes or specimens)
/// @cost   the contact once more at 2, 4, 8 ... times its cell: about half of what it took
lac_status lac_scene_contact_measure(const lac_scene_measure_def *def, lac_scene_contact *contact,
                                     lac_error *err);
void lac_scene_contact_clear(lac_scene_contact *contact);

/// eta = G/(2 cs) [Pa s/m]; no shear speed and no density: 0.
double lac_damping_of(const lac_material_def *material);

/// Builds the whole scene of a case. The case must outlive it.
/// @param files  what its loads read, kept for scenes made later; NULL: nothing is kept
lac_status lac_scene_create(const lac_case *c, lac_load_files *files, lac_scene **out,
                            lac_error *err);

/// Makes a scene anew after values of friction or initial (or of loads) changed in its case; the
/// contact, the hierarchy and the transfer stay. After an error the scene has no problem and can
/// only be renewed or freed.
/// @param files  as in lac_scene_create
lac_status lac_scene_renew(lac_scene *scene, lac_load_files *files, bool loads, lac_error *err);

/// Takes the cells of a scene together, whatever its case says: its runs are of the lump then, and
/// lac_lumped_judge tells their error.
/// @param like  a lump whose cells and weights are taken, of a scene of as many cells; NULL: what
/// suits
/// @return as lac_lump_create; without a lump unless LAC_OK
lac_status lac_scene_lump(lac_scene *scene, const lac_lump *like, lac_error *err);

/// What the lump of a scene is made from, with nothing that it is like.
lac_lump_source lac_scene_lump_source(const lac_scene *scene);

void lac_scene_free(lac_scene *scene);
