// SPDX-License-Identifier: GPL-3.0-or-later
// A surface in rows: the files that it came from, its roughness, Hurst exponent and JRC.
#include "cli/contact/surface.h"

#include <math.h>
#include <stdio.h>

#include "cli/common/words.h"

// Words for lac_measured, and for the fit of a file.
static const char *const measured_words[] = {"the interface", "the file as read",
                                             "the file, as far as it lies on the interface",
                                             "both faces on the interface"};
static const char *const fit_words[] = {"cropped", "padded", "resampled"};

// A misfit that scatter does not explain: one in a thousand at eight shells.
static const double bad_misfit = 3.7;

static void print_file(const lac_file_report *file, const char *label)
{
    char step[32];
    char gaps[64] = "";
    char apart[64] = "";
    if (!isnan(file->dx)) {
        (void)snprintf(apart, sizeof apart, " %s apart",
                       cli_quantity(file->dx, "m", step, sizeof step));
    }
    if (file->masked > 0) {
        (void)snprintf(gaps, sizeof gaps, ", %zu without height", file->masked);
    }
    cli_row(label, "%s (%s)", file->path, file->format);
    cli_row("", "%zu x %zu samples%s, heights in %s%s; %s", file->nx, file->ny, apart,
            file->height_unit, gaps, fit_words[file->fit]);
}

static void print_hurst(const lac_surface_measures *m)
{
    char longest[32];
    char shortest[32];
    if (isnan(m->hurst)) {
        cli_row("Hurst exponent", "none: too few waves");
        return;
    }
    cli_row("Hurst exponent", "%.3f +/- %.3f (waves of %s to %s%s)", m->hurst, m->hurst_error,
            cli_quantity(m->fit_shortest, "m", shortest, sizeof shortest),
            cli_quantity(m->fit_longest, "m", longest, sizeof longest),
            m->hurst_misfit > bad_misfit || m->hurst < 0.0 || m->hurst > 1.0
                ? "; no self-affine range"
                : "");
}

static const char *range_words(double jrc)
{
    if (isnan(jrc)) {
        return "none: flat";
    }
    return jrc < 0.0 ? " (below 0: smoother than it was found for)"
                     : (jrc > 20.0 ? " (above 20: rougher than it was found for)" : "");
}

static void print_jrc(double z2, double step, double jrc)
{
    char text[32];
    char number[32] = "";
    if (!isnan(jrc)) {
        (void)snprintf(number, sizeof number, "%.1f", jrc);
    }
    cli_row("Z2, JRC", "%.4g at %s: %s%s", z2, cli_quantity(step, "m", text, sizeof text), number,
            range_words(jrc));
}

void cli_surface_print(const lac_surface_report *surface)
{
    const lac_surface_measures *m = &surface->measures;
    for (size_t i = 0; i < surface->files; i++) {
        print_file(&surface->file[i],
                   surface->files < 2 ? "heights" : (i == 0 ? "upper face" : "lower face"));
    }
    cli_row("measured", "%s", measured_words[surface->measured]);
    cli_row_quantity("rms height", m->rms_height, "m");
    cli_row("rms slopes x, y", "%.4g, %.4g", m->rms_slope_x, m->rms_slope_y);
    print_hurst(m);
    print_jrc(m->z2, m->z2_step, m->jrc);
    for (size_t k = 0; k < m->profiles; k++) {
        if (m->profile[k].step != m->z2_step) {
            print_jrc(m->profile[k].z2, m->profile[k].step, m->profile[k].jrc);
        }
    }
}
