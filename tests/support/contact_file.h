/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_TESTS_SUPPORT_CONTACT_FILE_H
#define LACUNA_TESTS_SUPPORT_CONTACT_FILE_H

#include "scene/scene.h"

/// Writes the file of a contact, as `lacuna contact` does.
/// @param force      replace a file that is there
/// @param case_text  its attribute `case`; NULL: none
lac_status contact_file(const lac_scene_contact *contact, const char *path, bool force,
                        const char *case_text, lac_error *err);

#endif
