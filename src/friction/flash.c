// SPDX-License-Identifier: GPL-3.0-or-later
// Flash heating of contacts: what they hold falls as they slide faster than they cool.
#include "friction/cutoff.h"

// F = f_w + (f - f_w) s,  s = 1/(1 + v/v_w),  with u = ln v:  s_u = -s (1 - s),
// s_uu = s (1 - s) (1 - 2 s). An asperity of size D that is heated on contact weakens beyond a
// temperature, after D/v_w; of the time that it lasts, D/v, the part v_w/v is still strong.
// Rice (2006), doi 10.1029/2005JB004006, in a form that is smooth at v_w.
void lac_flash_weaken(const lac_friction *friction, const lac_friction_cells *cells,
                      const lac_friction_values *values, const lac_friction_slopes *slopes)
{
    const double *v_w = lac_cellwise_from(&friction->column[LAC_FLASH_RATE], cells->first);
    const double *f_w = lac_cellwise_from(&friction->column[LAC_FLASH_FRICTION], cells->first);
    for (size_t i = 0; i < cells->n; i++) {
        double s = 1 / (1 + cells->v[i] / v_w[i]);
        double s_u = -s * (cells->v[i] / v_w[i] < 1 ? cells->v[i] / v_w[i] * s : 1 - s);
        double over = values->f[i] - f_w[i];
        if (slopes != NULL) {
            slopes->f_uu[i] =
                slopes->f_uu[i] * s + 2 * values->f_u[i] * s_u + over * s_u * (2 * s - 1);
            slopes->f_uw[i] = slopes->f_uw[i] * s + values->f_w[i] * s_u;
            slopes->f_ww[i] *= s;
        }
        values->f[i] = f_w[i] + over * s;
        values->f_u[i] = values->f_u[i] * s + over * s_u;
        values->f_w[i] *= s;
    }
}

// s of one cell, to the bit as above.
static double strong_part(const lac_friction *friction, size_t cell, double u)
{
    return 1 / (1 + exp(u) / lac_cellwise_of(&friction->column[LAC_FLASH_RATE], cell));
}

double lac_flash_of(const lac_friction *friction, size_t cell, double u, double f)
{
    double f_w = lac_cellwise_of(&friction->column[LAC_FLASH_FRICTION], cell);
    return f_w + (f - f_w) * strong_part(friction, cell, u);
}

double lac_flash_before(const lac_friction *friction, size_t cell, double u, double f)
{
    double f_w = lac_cellwise_of(&friction->column[LAC_FLASH_FRICTION], cell);
    return f_w + (f - f_w) / strong_part(friction, cell, u);
}
