/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/base.h"
#include "base/clones.h"

// exp, log and asinh of one number, for loops that do more than one of them at a time.
// A kernel is branch-free and in plain C; the compiler turns a loop over it into
// vector instructions. Only + - * / sqrt, comparisons and integer shifts are used, nothing is
// fused (-ffp-contract=off), and so every instruction set gives the same bits.
// Polynomials: minimax fits, relative error below 2^-57, made for this file.

#define LAC_KERNEL static inline __attribute__((always_inline)) double

#define LAC_LOG2_E 0x1.71547652b82fep+0
#define LAC_LN_2_HIGH 0x1.62e42fefa38p-1 // 41 bits: its product with an exponent is exact
#define LAC_LN_2_LOW 0x1.ef35793c76730p-45
#define LAC_SQRT_HALF_BITS UINT64_C(0x3fe6a09e667f3bcd)
#define LAC_ROUNDING 0x1.8p52 // x + LAC_ROUNDING - LAC_ROUNDING is x rounded to an integer
#define LAC_MANTISSA_BITS 52

static inline uint64_t lac_bits_of(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

LAC_KERNEL lac_double_of(uint64_t bits)
{
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

// 2^k for an integral k in [-1022, 1023]: adding the bias leaves k + 1023 in the lowest bits.
LAC_KERNEL lac_power_of_two(double k)
{
    return lac_double_of(lac_bits_of(k + (LAC_ROUNDING + 1023)) << LAC_MANTISSA_BITS);
}

// exp(x) = 2^k exp(r), |r| <= ln(2)/2;  exp(r) = 1 + r + r^2 q(r)
// @param k  becomes that k. @return exp(r)
LAC_KERNEL lac_exp_reduced(double x, double *k_of)
{
    double k = (x * LAC_LOG2_E + LAC_ROUNDING) - LAC_ROUNDING;
    double r = (x - k * LAC_LN_2_HIGH) - k * LAC_LN_2_LOW;
    double z = r * r;
    double q = 0x1.28a4b36a0d09ap-22 + 0x1.ad5c053145a12p-26 * r;
    q = (0x1.a019a49b75882p-16 + 0x1.71df30851e164p-19 * r) + z * q;
    q = (0x1.6c16c17fbb7e5p-10 + 0x1.a01a012be14fdp-13 * r) + z * q;
    q = (0x1.5555555552045p-5 + 0x1.1111111125d10p-7 * r) + z * q;
    q = (0x1.0000000000004p-1 + 0x1.555555555550bp-3 * r) + z * q;
    *k_of = k;
    return 1 + (r + z * q);
}

LAC_KERNEL lac_exp_one(double x)
{
    // Beyond these the result is infinity or 0; NaN passes both.
    double c = x > 710 ? 710 : x;
    c = c < -746 ? -746 : c;
    double k;
    double e = lac_exp_reduced(c, &k);
    // In two factors, as 2^k itself need not be a normal number.
    double half = (k * 0.5 + LAC_ROUNDING) - LAC_ROUNDING;
    return e * lac_power_of_two(half) * lac_power_of_two(k - half);
}

// The same where it is a normal number, |x| < 708; else of no meaning.
LAC_KERNEL lac_exp_normal(double x)
{
    double k;
    double e = lac_exp_reduced(x, &k);
    return e * lac_power_of_two(k);
}

// ln x + more, for a normal positive x:  x = 2^k m, m in [sqrt(1/2), sqrt(2)), f = m - 1,
// ln m = f - f^2/2 + s (f^2/2 + R(s^2)),  s = f/(2 + f);  k is raised by `shift`.
LAC_KERNEL lac_log_normal(double x, double shift, double more)
{
    const double offset = 1024; // keeps the exponent positive, for lack of a signed shift
    uint64_t from_root =
        lac_bits_of(x) - LAC_SQRT_HALF_BITS + (UINT64_C(1024) << LAC_MANTISSA_BITS);
    uint64_t exponent = from_root >> LAC_MANTISSA_BITS;
    double k = (lac_double_of(exponent | lac_bits_of(0x1p52)) - (0x1p52 + offset)) + shift;
    double m = lac_double_of(lac_bits_of(x) + (UINT64_C(1024) << LAC_MANTISSA_BITS) -
                             (exponent << LAC_MANTISSA_BITS));
    double f = m - 1;
    double s = f / (2 + f);
    double z = s * s, w = z * z;
    double even = 0x1.999999998f464p-2 + w * (0x1.c71c5bae716ecp-3 + w * 0x1.39cf9509c493bp-3);
    double odd = 0x1.24924935479c3p-2 + w * (0x1.7464605d2dae5p-3 + w * 0x1.2d4beb4aa90fbp-3);
    double rest = z * (0x1.5555555555560p-1 + (z * even + w * odd));
    double half_square = 0.5 * f * f;
    return k * LAC_LN_2_HIGH -
           ((half_square - (s * (half_square + rest) + (k * LAC_LN_2_LOW + more))) - f);
}

LAC_KERNEL lac_log_one(double x)
{
    int subnormal = x < DBL_MIN;
    double y = lac_log_normal(subnormal ? x * 0x1p54 : x, subnormal ? -54 : 0, 0);
    y = x > 0 ? y : (x == 0 ? -INFINITY : NAN);
    return x < INFINITY ? y : x; // infinity, and NaN where x is
}

// asinh x = ln(1 + t), t = a + a^2/(1 + sqrt(1 + a^2)), a = |x|; 1 + t and t are kept as sums of
// two doubles. For large a it is ln a + ln 2.
LAC_KERNEL lac_asinh_one(double x)
{
    double a = fabs(x);
    int large = a > 0x1p28;
    double b = large ? 0 : a;
    double square = b * b;
    double more = square / (1 + sqrt(1 + square));
    double t = b + more, t_low = (b - t) + more;
    double sum = 1 + t, part = sum - t;
    double low = ((1 - part) + (t - (sum - part))) + t_low;
    double y = lac_log_normal(large ? a : sum, large ? 1 : 0, low / sum);
    y = a < INFINITY ? y : a;
    return copysign(y, x);
}
