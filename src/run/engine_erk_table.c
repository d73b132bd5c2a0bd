// SPDX-License-Identifier: GPL-3.0-or-later
// RK8(7)13M of Prince & Dormand (1981), J. Comput. Appl. Math. 7, 67-75,
// doi 10.1016/0771-050X(81)90010-3: order 8 of explicit steps, the same under every SUNDIALS. Its
// error estimate sees what that of Fehlberg's pair, SUNDIALS' own until 7.3, is blind to:
// docs/choosing.md.
#include <arkode/arkode_erkstep.h>

#include <stdbool.h>
#include <string.h>

#include "run/compat.h"

enum { STAGES = 13 };

static const double nodes[STAGES] = {0.0,
                                     1.0 / 18,
                                     1.0 / 12,
                                     1.0 / 8,
                                     5.0 / 16,
                                     3.0 / 8,
                                     59.0 / 400,
                                     93.0 / 200,
                                     5490023248.0 / 9719169821,
                                     13.0 / 20,
                                     1201146811.0 / 1299019798,
                                     1.0,
                                     1.0};

// Row by row, those below the diagonal. Columns 2 and 3 are empty from row 6 on, where these begin
// with column 1 and go on with column 4.
static const double first_rows[] = {1.0 / 18, 1.0 / 48, 1.0 / 16, 1.0 / 32,   0.0,
                                    3.0 / 32, 5.0 / 16, 0.0,      -75.0 / 64, 75.0 / 64};
static const double rows[] = {
    3.0 / 80,
    3.0 / 16,
    3.0 / 20,

    29443841.0 / 614563906,
    77736538.0 / 692538347,
    -28693883.0 / 1125000000,
    23124283.0 / 1800000000,

    16016141.0 / 946692911,
    61564180.0 / 158732637,
    22789713.0 / 633445777,
    545815736.0 / 2771057229,
    -180193667.0 / 1043307555,

    39632708.0 / 573591083,
    -433636366.0 / 683701615,
    -421739975.0 / 2616292301,
    100302831.0 / 723423059,
    790204164.0 / 839813087,
    800635310.0 / 3783071287,

    246121993.0 / 1340847787,
    -37695042795.0 / 15268766246,
    -309121744.0 / 1061227803,
    -12992083.0 / 490766935,
    6005943493.0 / 2108947869,
    393006217.0 / 1396673457,
    123872331.0 / 1001029789,

    -1028468189.0 / 846180014,
    8478235783.0 / 508512852,
    1311729495.0 / 1432422823,
    -10304129995.0 / 1701304382,
    -48777925059.0 / 3047939560,
    15336726248.0 / 1032824649,
    -45442868181.0 / 3398467696,
    3065993473.0 / 597172653,

    185892177.0 / 718116043,
    -3185094517.0 / 667107341,
    -477755414.0 / 1098053517,
    -703635378.0 / 230739211,
    5731566787.0 / 1027545527,
    5232866602.0 / 850066563,
    -4093664535.0 / 808688257,
    3962137247.0 / 1805957418,
    65686358.0 / 487910083,

    403863854.0 / 491063109,
    -5068492393.0 / 434740067,
    -411421997.0 / 543043805,
    652783627.0 / 914296604,
    11173962825.0 / 925320556,
    -13158990841.0 / 6184727034,
    3936647629.0 / 1978049680,
    -160528059.0 / 685178525,
    248638103.0 / 1413531060,
    0.0,
};

static const double weights[STAGES] = {14005451.0 / 335480064,
                                       0.0,
                                       0.0,
                                       0.0,
                                       0.0,
                                       -59238493.0 / 1068277825,
                                       181606767.0 / 758867731,
                                       561292985.0 / 797845732,
                                       -1041891430.0 / 1371343529,
                                       760417239.0 / 1151165299,
                                       118820643.0 / 751138087,
                                       -528747749.0 / 2220607170,
                                       1.0 / 4};

static const double embedded[STAGES] = {13451932.0 / 455176623,
                                        0.0,
                                        0.0,
                                        0.0,
                                        0.0,
                                        -808719846.0 / 976000145,
                                        1757004468.0 / 5645159321,
                                        656045339.0 / 265891186,
                                        -3867574721.0 / 1518517206,
                                        465885868.0 / 322736535,
                                        53011238.0 / 667516719,
                                        2.0 / 45,
                                        0.0};

int lac_erk_set_order_8(void *mem)
{
    double a[STAGES * STAGES] = {0.0}, b[STAGES], c[STAGES], d[STAGES];
    const double *next = first_rows;
    for (size_t i = 1; i < STAGES; i++) {
        next = i == 5 ? rows : next;
        for (size_t j = 0; j < i; j++) {
            const bool empty = i >= 5 && (j == 1 || j == 2);
            a[i * STAGES + j] = empty ? 0.0 : *next++;
        }
    }
    memcpy(b, weights, sizeof b);
    memcpy(c, nodes, sizeof c);
    memcpy(d, embedded, sizeof d);
    ARKodeButcherTable table = ARKodeButcherTable_Create(STAGES, 8, 7, c, a, b, d);
    const int flag = table != NULL ? ERKStepSetTable(mem, table) : -1;
    ARKodeButcherTable_Free(table);
    return flag;
}
