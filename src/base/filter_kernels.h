/* SPDX-License-Identifier: GPL-3.0-or-later */
// The inner loops of filter.c in one precision; included there once for each, with
//   REAL      float or double
//   FFT(x)    fftwf_ ## x or fftw_ ## x
//   NAME(x)   the function's own name
// Complex numbers are pairs of REAL.

static void *NAME(plan)(size_t n, int sign, void *from, void *to)
{
    return FFT(plan_dft_1d)((int)n, from, to, sign, FFTW_ESTIMATE);
}

static void NAME(execute)(void *plan, void *from, void *to) { FFT(execute_dft)(plan, from, to); }

static void NAME(destroy)(void *plan)
{
    if (plan != NULL) {
        FFT(destroy_plan)(plan);
    }
}

// z = a + i b
static void NAME(weave)(size_t n, const void *row, size_t apart, void *pair)
{
    const REAL *restrict a = row;
    const REAL *restrict b = &a[apart];
    REAL *restrict z = pair;
    for (size_t i = 0; i < n; i++) {
        z[2 * i] = a[i];
        z[2 * i + 1] = b[i];
    }
}

static void NAME(unweave)(size_t n, const void *pair, size_t apart, void *row)
{
    const REAL *restrict z = pair;
    REAL *restrict a = row;
    REAL *restrict b = &a[apart];
    for (size_t i = 0; i < n; i++) {
        a[i] = z[2 * i];
        b[i] = z[2 * i + 1];
    }
}

// Columns first ... first + width of the spectra of real rows, twice: those of a + i b at k and -k
// are A + i B and conj(A) + i conj(B).
static void NAME(gather)(const lac_filter *f, size_t first, size_t width, void *columns)
{
    REAL *restrict block = columns;
    for (size_t pair = 0; pair < f->pairs; pair++) {
        const REAL *restrict z = (const REAL *)f->buffer + 2 * pair * f->pitch;
        for (size_t c = 0; c <= width; c += 64 / (2 * sizeof(REAL))) {
            __builtin_prefetch(&z[8 * f->pitch * 2 + 2 * (first + c)], 0, 2);
            __builtin_prefetch(&z[8 * f->pitch * 2 + 2 * (f->mx - first - c)], 0, 2);
        }
        REAL *restrict to = &block[4 * pair];
        for (size_t c = 0; c < width; c++) {
            const REAL *at = &z[2 * (first + c)];
            const REAL *mirror = &z[first + c > 0 ? 2 * (f->mx - first - c) : 0];
            REAL *ab = &to[2 * c * f->lead];
            ab[0] = at[0] + mirror[0];
            ab[1] = at[1] - mirror[1];
            ab[2] = at[1] + mirror[1];
            ab[3] = mirror[0] - at[0];
        }
    }
    for (size_t c = 0; c < width && f->my > f->ny; c++) {
        memset(&block[2 * (c * f->lead + f->ny)], 0, 2 * (f->my - f->ny) * sizeof(REAL));
    }
}

// And back
static void NAME(scatter)(const lac_filter *f, size_t first, size_t width, const void *columns)
{
    const REAL *restrict block = columns;
    for (size_t pair = 0; pair < f->pairs; pair++) {
        REAL *restrict z = (REAL *)f->buffer + 2 * pair * f->pitch;
        const REAL *restrict from = &block[4 * pair];
        for (size_t c = 0; c < width; c++) {
            REAL *at = &z[2 * (first + c)];
            REAL *mirror = &z[first + c > 0 ? 2 * (f->mx - first - c) : 0];
            const REAL *ab = &from[2 * c * f->lead];
            REAL are = ab[0];
            REAL aim = ab[1];
            REAL bre = ab[2];
            REAL bim = ab[3];
            at[0] = are - bim;
            at[1] = aim + bre;
            mirror[0] = are + bim;
            mirror[1] = bre - aim;
        }
    }
}

// The factors of negative wavenumbers
static void NAME(mirror)(size_t n, void *factor)
{
    REAL *restrict w = factor;
    for (size_t j = n / 2 + 1; j < n; j++) {
        w[j] = w[n - j];
    }
}

// x *= w / 2: gather left twice the spectrum
static void NAME(multiply)(size_t n, const void *factor, void *column)
{
    const REAL *restrict w = factor;
    REAL *restrict x = column;
    for (size_t j = 0; j < n; j++) {
        REAL half = (REAL)0.5 * w[j];
        x[2 * j] *= half;
        x[2 * j + 1] *= half;
    }
}

// Sum of w |x/2|^2
static double NAME(power)(size_t n, const void *factor, const void *column)
{
    const REAL *restrict w = factor;
    const REAL *restrict x = column;
    double sum = 0.0;
#pragma omp simd reduction(+ : sum)
    for (size_t j = 0; j < n; j++) {
        double re = (double)x[2 * j];
        double im = (double)x[2 * j + 1];
        sum += (double)w[j] * (re * re + im * im);
    }
    return 0.25 * sum;
}

static const kernels NAME(kernels) = {
    .size = sizeof(REAL),
    .plan = NAME(plan),
    .execute = NAME(execute),
    .destroy = NAME(destroy),
    .weave = NAME(weave),
    .unweave = NAME(unweave),
    .gather = NAME(gather),
    .scatter = NAME(scatter),
    .mirror = NAME(mirror),
    .multiply = NAME(multiply),
    .power = NAME(power),
};
