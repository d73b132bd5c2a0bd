/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "scene/scene_rg.h"

// One interface under the cascade.
typedef struct lac_scene_joint {
    lac_scene_contact contact;
    double *strength, *drop; // [n] [Pa]
    lac_rg_path *path;
} lac_scene_joint;

void lac_scene_joint_clear(lac_scene_joint *joint);

// Strengths f p of the joint's domain, and room for the drops.
lac_status lac_scene_joint_strengths(const lac_case *c, lac_scene_joint *joint, lac_error *err);

// A study for each beta of the case.
lac_status lac_scene_rg_begin(const lac_case *c, lac_scene_rg *out, lac_error *err);

// Lets all studies run on a joint; sums up what is averaged over joints.
lac_status lac_scene_rg_add(const lac_case *c, lac_scene_joint *joint, lac_scene_rg *out,
                            lac_error *err);

// Adds what interface i of the ensemble is like to the list and to the mean.
void lac_scene_rg_note(const lac_scene_contact *contact, int64_t seed, size_t i, lac_scene_rg *out);

// Means over the joints, and the results of all studies.
lac_status lac_scene_rg_end(const lac_case *c, lac_scene_rg *out, lac_error *err);
