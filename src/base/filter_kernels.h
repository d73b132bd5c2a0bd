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

// to_j = sum of w_m from_(j + mn); it may be where `from` is.
static void NAME(fold)(size_t n, size_t terms, const double *weight, const void *from, void *to)
{
    const REAL *x = from;
    REAL *y = to;
    for (size_t m = 0; m < terms; m++) {
        const REAL w = (REAL)weight[m];
        for (size_t j = 0; j < n; j++) {
            y[j] = (m > 0 ? y[j] : 0) + w * x[m * n + j];
        }
    }
}

// And back, of two rows `apart` or of one (0), into the first.
static void NAME(unfold)(size_t n, size_t terms, const double (*weight)[MOST_TERMS], size_t apart,
                         void *row)
{
    REAL *a = row;
    const REAL *b = &a[apart];
    for (size_t m = terms; m-- > 0;) {
        const REAL u = (REAL)weight[0][m], v = (REAL)weight[1][m];
        for (size_t j = 0; j < n; j++) {
            a[m * n + j] = u * a[j] + v * b[j];
        }
    }
}

// (a + i b)_j *= (c + i s)_(j part), or with sign -1 its conjugate. `part` is known where this is
// inlined.
static inline __attribute__((always_inline)) void
NAME(turn_by)(const lac_filter *f, size_t part, REAL sign, REAL *restrict a, REAL *restrict b)
{
    const REAL *restrict c = f->twist[f->mode];
    const REAL *restrict s = &c[f->nx];
    for (size_t j = 0; j < f->length; j++) {
        REAL re = a[j], im = b[j], cosine = c[j * part], sine = sign * s[j * part];
        a[j] = re * cosine - im * sine;
        b[j] = im * cosine + re * sine;
    }
}

static void NAME(turn)(const lac_filter *f, int sign, void *row)
{
    REAL *second = (REAL *)row + f->apart;
    if (f->part == 1) {
        NAME(turn_by)(f, 1, (REAL)sign, row, second);
    } else {
        NAME(turn_by)(f, f->part, (REAL)sign, row, second);
    }
}

// exp(-i pi j/n): real parts, then the imaginary ones
static void NAME(fill_twist)(size_t n, void *twist)
{
    for (size_t j = 0; j < n; j++) {
        ((REAL *)twist)[j] = (REAL)cos(M_PI * (double)j / (double)n);
        ((REAL *)twist)[n + j] = (REAL)-sin(M_PI * (double)j / (double)n);
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
    for (size_t row = 0; row < f->rows; row++) {
        const REAL *z = (const REAL *)f->buffer + 2 * row * f->pitch;
        const REAL *at = &z[2 * first];
        const REAL *mirror = &z[2 * (f->length - (f->odd ? 1 : 0) - first)];
        size_t begin = first == 0 && !f->odd ? 1 : 0;
        // No hardware foresees rows so far apart.
        for (size_t c = 0; row + AHEAD < f->rows && c < 2 * width; c += LINE / sizeof(REAL)) {
            __builtin_prefetch(&at[c] + 2 * AHEAD * f->pitch);
            __builtin_prefetch(mirror - c + 2 * AHEAD * f->pitch);
        }
        if (f->single) {
            for (size_t c = 0; c < width; c++) {
                block[c * apart + 2 * row] = at[2 * c];
                block[c * apart + 2 * row + 1] = at[2 * c + 1];
            }
            continue;
        }
        REAL *restrict to = &block[4 * row];
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
    for (size_t row = 0; row < f->rows; row++) {
        REAL *z = (REAL *)f->buffer + 2 * row * f->pitch;
        REAL *at = &z[2 * first];
        REAL *mirror = &z[2 * (f->length - (f->odd ? 1 : 0) - first)];
        size_t begin = first == 0 && !f->odd ? 1 : 0;
        if (f->single) {
            for (size_t c = 0; c < width; c++) {
                at[2 * c] = block[c * apart + 2 * row];
                at[2 * c + 1] = block[c * apart + 2 * row + 1];
            }
            continue;
        }
        const REAL *restrict from = &block[4 * row];
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

// Sum of w |x/2|^2; of a part in its own precision over STRETCH numbers each, which is quicker.
static double NAME(power)(bool part, size_t n, const void *factor, const void *column)
{
    const REAL *restrict w = factor;
    const REAL *restrict x = column;
    double sum = 0.0;
    for (size_t first = 0; part && first < n; first += STRETCH) {
        const size_t end = first + STRETCH < n ? first + STRETCH : n;
        REAL some = 0;
#pragma omp simd safelen(4) reduction(+ : some)
        for (size_t j = first; j < end; j++) {
            some += w[j] * (x[2 * j] * x[2 * j] + x[2 * j + 1] * x[2 * j + 1]);
        }
        sum += (double)some;
    }
#pragma omp simd safelen(2) reduction(+ : sum)
    for (size_t j = 0; j < (part ? 0 : n); j++) {
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
    .fold = NAME(fold),
    .unfold = NAME(unfold),
    .turn = NAME(turn),
    .fill_twist = NAME(fill_twist),
    .gather = NAME(gather),
    .scatter = NAME(scatter),
    .mirror = NAME(mirror),
    .multiply = NAME(multiply),
    .power = NAME(power),
};
