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

// From a row pair's spectrum at k and -k to those of its rows, twice: a + i b has A + i B and
// conj(A) + i conj(B) there.
static inline void NAME(part)(const REAL *restrict at, const REAL *restrict mirror,
                              REAL *restrict ab)
{
    const REAL left[4] = {at[0], at[1], at[1], mirror[0]};
    const REAL right[4] = {mirror[0], -mirror[1], mirror[1], -at[0]};
    for (int i = 0; i < 4; i++) {
        ab[i] = left[i] + right[i];
    }
}

// And back; at and mirror may be the same
static inline void NAME(join)(const REAL *restrict ab, REAL *at, REAL *mirror)
{
    REAL re = ab[0];
    REAL im = ab[1];
    at[0] = re - ab[3];
    at[1] = im + ab[2];
    mirror[0] = re + ab[3];
    mirror[1] = ab[2] - im;
}

// Columns first ... first + width of the spectra of all rows
static void NAME(gather)(const lac_filter *f, size_t first, size_t width, size_t lead,
                         void *columns)
{
    REAL *restrict block = columns;
    const size_t apart = 2 * lead;
    for (size_t pair = 0; pair < f->pairs; pair++) {
        const REAL *z = (const REAL *)f->buffer + 2 * pair * f->pitch;
        REAL *restrict to = &block[4 * pair];
        const REAL *at = &z[2 * first];
        const REAL *mirror = &z[2 * (f->length - (f->odd ? 1 : 0) - first)];
        size_t begin = first == 0 && !f->odd ? 1 : 0;
        // No hardware foresees rows so far apart.
        for (size_t c = 0; pair + AHEAD < f->pairs && c < 2 * width; c += LINE / sizeof(REAL)) {
            __builtin_prefetch(&at[c] + 2 * AHEAD * f->pitch);
            __builtin_prefetch(mirror - c + 2 * AHEAD * f->pitch);
        }
        if (begin == 1) {
            NAME(part)(z, z, to); // -0 is 0
        }
        for (size_t c = begin; c < width; c++) {
            NAME(part)(&at[2 * c], mirror - 2 * c, &to[c * apart]);
        }
    }
}

// And back
static void NAME(scatter)(const lac_filter *f, size_t first, size_t width, size_t lead,
                          const void *columns)
{
    const REAL *restrict block = columns;
    const size_t apart = 2 * lead;
    for (size_t pair = 0; pair < f->pairs; pair++) {
        REAL *z = (REAL *)f->buffer + 2 * pair * f->pitch;
        const REAL *restrict from = &block[4 * pair];
        REAL *at = &z[2 * first];
        REAL *mirror = &z[2 * (f->length - (f->odd ? 1 : 0) - first)];
        size_t begin = first == 0 && !f->odd ? 1 : 0;
        if (begin == 1) {
            NAME(join)(from, z, z);
        }
        for (size_t c = begin; c < width; c++) {
            NAME(join)(&from[c * apart], &at[2 * c], mirror - 2 * c);
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
#pragma omp simd safelen(2) reduction(+ : sum)
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
