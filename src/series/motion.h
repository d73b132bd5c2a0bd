/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "lacuna/series.h"

typedef struct lac_motion_def {
    lac_smoothing smoothing;
    size_t points, order;
    double window; ///< [s]
    bool raw;      ///< keep outliers and resets as they are
} lac_motion_def;

/// What was read, up to the present. Values that are NaN are not there.
typedef struct lac_readings {
    size_t n;
    const double *time;         ///< [n] strictly increasing [s]
    const double *displacement; ///< [n] [m]; NULL: none
    const double *velocity;     ///< [n] [m/s]; NULL: none
    const double *sigma;        ///< [n] standard error of the displacement [m]; NULL: not known
    double displacement_digit;  ///< what the last digit of a displacement counts [m]; 0: a double's
    double velocity_digit;      ///< the same of a velocity [m/s]
    const double *displacement_digits; ///< [n] what the last digit of each counts [m]; NULL: not
                                       ///< known, displacement_digit holds for all
    const double *velocity_digits;     ///< [n] the same [m/s]
} lac_readings;

/// All that a series holds of them.
lac_readings lac_series_readings(const lac_series *series);

/// Of readings the last `count` (0: all), and of these what lies within `time` [s] before the last
/// one (INFINITY: all). Where the digits of each are known, how fine they are is told from those
/// that are left, so that nothing else is known of what was before.
/// @param out  borrows from `all`
/// @return LAC_OK; LAC_ENOMEM
lac_status lac_readings_recent(const lac_readings *all, size_t count, double time,
                               lac_readings *out, lac_error *err);

/// The motion of a slope as forecasts see it.
typedef struct lac_motion {
    size_t n;
    double *time;         ///< [n] [s]; all arrays lie in one piece with the motion
    double *displacement; ///< [n] [m] outliers dropped, resets taken out, turned where it falls
    double *sigma;        ///< [n] [m], NaN where not known
    double *error; ///< [n] standard error of each: sigma, else the noise there [m]; NaN where it
                   ///< cannot be told
    size_t velocities;
    double *velocity_time;  ///< [velocities] [s]
    double *velocity;       ///< [velocities] [m/s]
    double *rounding;       ///< [velocities] how far the last digits may move each [m/s]
    double *velocity_error; ///< [velocities] standard error of each by the noise of what it is of
                            ///< [m/s]; NaN where that cannot be told
    double velocity_noise; ///< standard deviation of one velocity as given, at least its last digit
                           ///< [m/s]; NaN: they are of displacements, or it cannot be told
    double noise;      ///< standard deviation of one displacement, at least its resolution [m]; NaN
                       ///< where it cannot be told
    double resolution; ///< last digit of a displacement, or of a double [m]
    bool falling;      ///< what was read falls: settlement, line of sight; all is of its negative
    double interval, longest_gap; ///< median and largest interval of the readings [s]
    size_t gaps;                  ///< intervals longer than 5 times the median
    size_t outliers, resets;
    size_t disbelieved; ///< resets there would be, too many to believe: the readings are as given
    bool integrated;    ///< the displacement is the integral of the velocity
} lac_motion;

/// Cleans readings and derives velocities. A reading is an outlier where it leaves the line between
/// its neighbours by more than 8 times the noise and they agree with each other; a fall of more
/// than 10 times the noise and 2.5 times what nine of ten rises do not exceed, by a fifth of the
/// way so far or back to the first reading, is a reset of the sensor, across which the slope is
/// taken to have gone on as before, or an outlier while it is the last reading; but where the next
/// falls as far again, it is the slope that goes back. The noise is that
/// of `sigma`, else what readings scatter by themselves (base/noise.h); never less than the
/// resolution of the numbers. More resets than one reading in ten (one is always believed) are
/// not: all stays as it was read.
/// Readings that fall are turned: where the sum of their steps, none counted as more than five
/// median ones, is below 0 by more than 3 errors of a difference of two readings.
/// @return LAC_OK; LAC_EINPUT where the definition makes no sense; LAC_ENOMEM
/// @cost  O(n log n)
lac_status lac_motion_create(const lac_motion_def *def, const lac_readings *readings,
                             lac_motion **out, lac_error *err);

/// Drops outliers and takes resets out, as lac_motion_create says; the noise is known.
/// @param work  [n]
/// @return whether so many resets are believed
bool lac_motion_clean(lac_motion *motion, double *work);

/// Frees a motion; NULL is fine.
void lac_motion_free(lac_motion *motion);
