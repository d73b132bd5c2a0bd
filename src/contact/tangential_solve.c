// SPDX-License-Identifier: GPL-3.0-or-later
// The tractions of one step of shear by conjugate gradients: which cells stick and which slip.
#include "contact/tangential_solve.h"

#include "base/vsum.h"

// Conjugate gradients on what is free to move: both components of cells that stick, the direction
// of those that slip. docs/theory/tangential.md, "Solver".
//
// g = C tau - u0 - d is less the slip of this step, but for the shift that held loads take.

typedef struct iteration {
    lac_shear_problem *p;
    double *g;             // [2n] gradient
    double *phi, *phi_old; // [2n] its part along what is free
    double *z, *t;         // [2n] preconditioned gradient; search direction
    double *tx, *ty;       // [n] tangent to the disc of a cell that slips; 0 where it sticks
    double *curve;         // [n] slip over limit: stiffness of the direction of slip
    double *next;          // [2n] tau after a step along -g
    double *ones;          // [2n] 1 along an axis where cells stick
    uint8_t *next_limited; // [n]
    double *tau_old, *u_old;
    double lambda[2];
    double rho;              // length of a step along -g
    double objective, noise; // tau.C tau/2 - tau.(u0 + d); what rounding makes of it
    double strength, widest; // sum of the limits; twice the largest
    double G_old;            // z.phi of the step before; 0 to start afresh
    int64_t plain, failures; // steps along -g to come; how often the objective rose
} iteration;

// Tractions (or whatever) of the contact cells into the transforms, zeros elsewhere.
static void scatter(const lac_shear_problem *p, const double *x)
{
    const size_t nx = p->space->nx;
    for (size_t axis = 0; axis < 2; axis++) {
        const lac_fft *fft = p->space->fft[axis];
        const double *from = &x[axis * p->n];
        memset(fft->real, 0, fft->nx * fft->ny * sizeof *fft->real);
        for (size_t i = 0; i < p->n; i++) {
            size_t at = p->cell[i];
            fft->real[at + at / nx * (fft->nx - nx)] = from[i];
        }
    }
}

static void gather(const lac_shear_problem *p, double *x)
{
    const size_t nx = p->space->nx;
    for (size_t axis = 0; axis < 2; axis++) {
        const lac_fft *fft = p->space->fft[axis];
        double *to = &x[axis * p->n];
        for (size_t i = 0; i < p->n; i++) {
            size_t at = p->cell[i];
            to[i] = fft->real[at + at / nx * (fft->nx - nx)];
        }
    }
}

// u = C tau on the contact cells; all cells stay in space->fft[axis]->real.
static void displace(const lac_shear_problem *p, const double *tau, double *u)
{
    scatter(p, tau);
    lac_shear_space_displace(p->space);
    gather(p, u);
}

static bool moves(const iteration *it, size_t i) { return it->tx[i] == 0.0 && it->ty[i] == 0.0; }

// Cells that slip a long way take little part in what keeps the load.
static double share(const iteration *it, size_t i)
{
    return it->p->space->self / (it->p->space->self + it->curve[i]);
}

// The mean that x has along what is free, along the axes held: of a gradient by shares, of a
// direction (to be taken off by shares) just so
static void free_mean(const iteration *it, const double *x, bool gradient, double mean[2])
{
    const lac_shear_problem *p = it->p;
    const size_t n = p->n;
    double f[2] = {0.0, 0.0};
    double xx = 0.0, yy = 0.0, xy = 0.0;
    for (size_t i = 0; i < n; i++) {
        double tx = it->tx[i], ty = it->ty[i];
        bool sticks = moves(it, i);
        double w = share(it, i);
        double along = (gradient ? w : 1.0) * (tx * x[i] + ty * x[n + i]);
        f[0] += sticks ? x[i] : along * tx;
        f[1] += sticks ? x[n + i] : along * ty;
        xx += sticks ? 1.0 : w * tx * tx;
        yy += sticks ? 1.0 : w * ty * ty;
        xy += w * tx * ty;
    }
    double trace = xx + yy;
    double det = xx * yy - xy * xy;
    mean[0] = p->held[0] && xx > 0.0 ? f[0] / xx : 0.0;
    mean[1] = p->held[1] && yy > 0.0 ? f[1] / yy : 0.0;
    if (p->held[0] && p->held[1] && det > 1e-12 * trace * trace) {
        mean[0] = (yy * f[0] - xy * f[1]) / det;
        mean[1] = (xx * f[1] - xy * f[0]) / det;
    } else if (p->held[0] && p->held[1] && trace > 0.0) {
        // every cell slips along one line
        mean[0] = (xx * f[0] + xy * f[1]) / (trace * trace);
        mean[1] = (xy * f[0] + yy * f[1]) / (trace * trace);
    }
}

// to <- from along what is free, less what would change the load
static void project_free(const iteration *it, const double *from, bool gradient, double *to)
{
    const size_t n = it->p->n;
    double mean[2];
    free_mean(it, from, gradient, mean);
    for (size_t i = 0; i < n; i++) {
        double tx = it->tx[i], ty = it->ty[i];
        double w = gradient ? 1.0 : share(it, i);
        double x = from[i] - w * mean[0], y = from[n + i] - w * mean[1];
        double along = tx * x + ty * y;
        bool sticks = moves(it, i);
        to[i] = sticks ? x : along * tx;
        to[n + i] = sticks ? y : along * ty;
    }
}

// Gradient and objective, from tau and u
static void evaluate(iteration *it)
{
    const lac_shear_problem *p = it->p;
    double sum = 0.0, size = 0.0;
    for (size_t axis = 0; axis < 2; axis++) {
        const double d = p->held[axis] ? 0.0 : p->shift[axis];
        for (size_t k = axis * p->n; k < (axis + 1) * p->n; k++) {
            double given = p->before[k] + d;
            it->g[k] = p->u[k] - given;
            sum += p->tau[k] * (0.5 * p->u[k] - given);
            size += fabs(p->tau[k]) * (fabs(p->u[k]) + fabs(given));
        }
    }
    it->objective = sum;
    it->noise = 1e-13 * size + 1e-15 * it->strength * hypot(p->shift[0], p->shift[1]);
}

// A step along -g, whose lambda is the shift
static void descend(iteration *it)
{
    lac_shear_problem *p = it->p;
    for (size_t axis = 0; axis < 2; axis++) {
        for (size_t k = axis * p->n; k < (axis + 1) * p->n; k++) {
            it->z[k] = p->tau[k] - it->rho * it->g[k];
        }
        it->lambda[axis] = p->held[axis] ? it->rho * p->shift[axis] : 0.0;
    }
    lac_shear_project(p, it->z, it->next, it->next_limited, it->lambda);
    for (size_t axis = 0; axis < 2; axis++) {
        if (p->held[axis]) {
            p->shift[axis] = it->lambda[axis] / it->rho;
        }
    }
}

// The largest displacement there is, but no less than of a cell by its own traction
static double displacement_scale(const iteration *it)
{
    const lac_shear_problem *p = it->p;
    const size_t n = p->n;
    double largest = p->shift[0] * p->shift[0] + p->shift[1] * p->shift[1];
    for (size_t i = 0; i < n; i++) {
        double own = p->space->self * p->space->self *
                     (p->tau[i] * p->tau[i] + p->tau[n + i] * p->tau[n + i]);
        double now = p->u[i] * p->u[i] + p->u[n + i] * p->u[n + i];
        double then = p->before[i] * p->before[i] + p->before[n + i] * p->before[n + i];
        largest = fmax(fmax(largest, own), fmax(now, then));
    }
    return sqrt(largest);
}

// Which cells slip, and the residual
static void classify(iteration *it)
{
    lac_shear_problem *p = it->p;
    const size_t n = p->n;
    const double sx = p->held[0] ? p->shift[0] : 0.0;
    const double sy = p->held[1] ? p->shift[1] : 0.0;
    double worst = 0.0;
    for (size_t i = 0; i < n; i++) {
        double slip_x = sx - it->g[i], slip_y = sy - it->g[n + i];
        double nx = p->tau[i] / p->limit[i];
        double ny = p->tau[n + i] / p->limit[i];
        double along = nx * slip_x + ny * slip_y;
        bool slips = p->limited[i] && along > 0.0;
        it->tx[i] = slips ? -ny : 0.0;
        it->ty[i] = slips ? nx : 0.0;
        it->curve[i] = slips ? along / p->limit[i] : 0.0;
        double across = nx * slip_y - ny * slip_x;
        worst = fmax(worst, slips ? across * across : slip_x * slip_x + slip_y * slip_y);
    }
    p->scale = displacement_scale(it);
    p->residual = p->scale > 0.0 ? sqrt(worst) / p->scale : 0.0;
}

static void examine(iteration *it)
{
    double *swap = it->phi_old;
    it->phi_old = it->phi;
    it->phi = swap;
    descend(it);
    classify(it);
    project_free(it, it->g, true, it->phi);
}

// |q| hardly sees the mean over sticking cells, which nothing holds along an axis whose shift is
// given; without it contacts nearly complete converge badly. Its own step: sum of phi / 1.C1.
static double mean_step(const iteration *it, size_t axis)
{
    const lac_shear_problem *p = it->p;
    const size_t n = p->n;
    double sum = 0.0;
    if (p->held[axis] || 2 * n < p->space->nx * p->space->ny) {
        return 0.0;
    }
    for (size_t i = 0; i < n; i++) {
        bool sticks = moves(it, i);
        it->ones[axis * n + i] = sticks ? 1.0 : 0.0;
        it->ones[(1 - axis) * n + i] = 0.0;
        sum += sticks ? it->phi[axis * n + i] : 0.0;
    }
    scatter(p, it->ones);
    double compliance = lac_shear_space_energy(p->space);
    it->p->products++;
    double shift = sum / compliance;
    return compliance > 0.0 && isfinite(shift) ? shift : 0.0;
}

// |q| where cells stick; where they slip each by itself, mostly held by its slip
static void precondition(iteration *it)
{
    const lac_shear_problem *p = it->p;
    const size_t n = p->n;
    const double mean[2] = {mean_step(it, 0), mean_step(it, 1)};
    for (size_t i = 0; i < n; i++) {
        bool sticks = moves(it, i);
        it->z[i] = sticks ? it->phi[i] : 0.0;
        it->z[n + i] = sticks ? it->phi[n + i] : 0.0;
    }
    scatter(p, it->z);
    lac_shear_space_unload(p->space);
    gather(p, it->z);
    for (size_t i = 0; i < n; i++) {
        double c = 1.0 / (it->curve[i] + p->space->self);
        bool sticks = moves(it, i);
        it->z[i] = sticks ? it->z[i] + mean[0] : c * it->phi[i];
        it->z[n + i] = sticks ? it->z[n + i] + mean[1] : c * it->phi[n + i];
    }
    project_free(it, it->z, false, it->z);
}

// The search direction, by Polak and Ribiere; returns phi.t
static double direction(iteration *it)
{
    const size_t n = it->p->n;
    precondition(it);
    project_free(it, it->t, false, it->t);
    double G = lac_vdot(2 * n, it->z, it->phi);
    double pt = lac_vdot(2 * n, it->t, it->phi);
    double beta = 0.0;
    if (it->G_old > 0.0) {
        beta = fmax(0.0, (G - lac_vdot(2 * n, it->z, it->phi_old)) / it->G_old);
    }
    // beta > 2 or a direction that does not descend: start afresh
    if (!(beta <= 2.0) || !(G + beta * pt > 0.0)) {
        beta = 0.0;
    }
    for (size_t i = 0; i < 2 * n; i++) {
        it->t[i] = it->z[i] + beta * it->t[i];
    }
    it->G_old = G;
    return G + beta * pt;
}

// tau <- tau - alpha t, back on the discs and the load; false where there is no way down along t
static bool step(iteration *it, double pt)
{
    lac_shear_problem *p = it->p;
    const size_t n = p->n;
    scatter(p, it->t);
    double tct = lac_shear_space_energy(p->space);
    p->products++;
    for (size_t i = 0; i < n; i++) {
        tct += it->curve[i] * (it->t[i] * it->t[i] + it->t[n + i] * it->t[n + i]);
    }
    // no further than all discs are wide: the mean of full contacts meets no elastic resistance
    double alpha = fmin(pt / tct, it->widest / lac_vmost(2 * n, it->t));
    if (!(pt > 0.0 && tct >= 0.0 && isfinite(alpha))) {
        return false;
    }
    for (size_t i = 0; i < n; i++) {
        // a cell that slips is pushed outwards by its slip, so that it stays on its circle
        double out = 1.0 + it->curve[i] / p->space->self;
        it->z[i] = out * (p->tau[i] - alpha * it->t[i]);
        it->z[n + i] = out * (p->tau[n + i] - alpha * it->t[n + i]);
    }
    double lambda[2] = {0.0, 0.0};
    lac_shear_project(p, it->z, p->tau, p->limited, lambda);
    return true;
}

// The step along -g is there already
static void plain_step(iteration *it)
{
    lac_shear_problem *p = it->p;
    memcpy(p->tau, it->next, 2 * p->n * sizeof *p->tau);
    memcpy(p->limited, it->next_limited, p->n);
    it->G_old = 0.0;
}

// Conjugate gradients may lead up where cells change sides: then some steps along -g, shorter ones
// where that leads up, too. Below 1 / (largest eigenvalue) it does not.
static void advance(iteration *it)
{
    lac_shear_problem *p = it->p;
    const size_t bytes = 2 * p->n * sizeof *p->tau;
    memcpy(it->tau_old, p->tau, bytes);
    memcpy(it->u_old, p->u, bytes);
    double last = it->objective;
    bool plain = it->plain > 0;
    if (!plain) {
        plain = !step(it, direction(it));
    }
    if (plain) {
        plain_step(it);
        it->plain -= it->plain > 0 ? 1 : 0;
    }
    displace(p, p->tau, p->u);
    p->products++;
    evaluate(it);
    if (it->objective > last + it->noise) {
        memcpy(p->tau, it->tau_old, bytes);
        memcpy(p->u, it->u_old, bytes);
        for (size_t i = 0; i < p->n; i++) {
            p->limited[i] = hypot(p->tau[i], p->tau[p->n + i]) >= p->limit[i] * (1.0 - 1e-14);
        }
        evaluate(it);
        it->G_old = 0.0;
        if (plain) {
            it->rho = fmax(0.25 * it->rho, 0.5 / p->space->most);
            it->plain++;
        } else {
            it->plain = it->failures < 5 ? (int64_t)1 << it->failures : 32;
            it->failures++;
        }
    }
    examine(it);
}

static lac_status allocate(iteration *it, lac_error *err)
{
    const size_t n = it->p->n;
    double *work = calloc(21 * n, sizeof *work);
    it->next_limited = malloc(n);
    it->g = work;
    LAC_FAIL_MEMORY_IF(work == NULL || it->next_limited == NULL, err);
    double **vectors[] = {&it->phi,     &it->phi_old, &it->z,   &it->t,
                          &it->tau_old, &it->u_old,   &it->next};
    for (size_t k = 0; k < 7; k++) {
        *vectors[k] = work + 2 * (k + 1) * n;
    }
    it->tx = work + 16 * n;
    it->ty = work + 17 * n;
    it->curve = work + 18 * n;
    it->ones = work + 19 * n;
    return LAC_OK;
}

lac_status lac_shear_solve(lac_shear_problem *p, lac_error *err)
{
    iteration it = {.p = p, .rho = 1.0 / p->space->self};
    lac_status status;
    p->iterations = 0;
    p->products = 1;
    LAC_TRY(allocate(&it, err));
    for (size_t i = 0; i < p->n; i++) {
        it.strength += p->limit[i];
        it.widest = fmax(it.widest, 2.0 * p->limit[i]);
    }
    memcpy(it.z, p->tau, 2 * p->n * sizeof *p->tau);
    lac_shear_project(p, it.z, p->tau, p->limited, it.lambda);
    displace(p, p->tau, p->u);
    evaluate(&it);
    examine(&it);
    while (p->residual > p->tolerance && p->iterations < p->max_iterations) {
        advance(&it);
        p->iterations++;
    }
    displace(p, p->tau, p->u);
    p->products++;
out:
    free(it.g);
    free(it.next_limited);
    return status;
}
