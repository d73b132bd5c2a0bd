// SPDX-License-Identifier: GPL-3.0-or-later
// The row of the method whose fit is lac_model_forecast_method's: it stands here for whoever lists
// the methods.
#include "forecast/kinds.h"

const lac_forecast_kind lac_forecast_case = {
    .info = LAC_ABOUT("case", "the slope's own model, fitted and run on (--case)",
                      "Borri-Brunetto, Carpinteri & Chiaia (2004), Rock Mech. Rock Eng. 37, 117; "
                      "docs/theory/fitting.md"),
    .estimator = "the case of --case, its section fit's parameters fitted to all readings between "
                 "time.start and the time of issue by least squares (and sampled where fit.steps > "
                 "0), run on to failure",
    .least = 5,
    .worst = 0.04,
    .calibration = {0.01, -1.6448536269514722, -0.6744897501960817, 0.6744897501960817,
                    1.6448536269514722},
};
