// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tma/bearing_sums.hpp"

#include <cmath>

#include "truebearing/core/simd_width.hpp"
#include "truebearing/core/arctangent.hpp"

namespace truebearing {
namespace {

template <int kWidth>
[[gnu::always_inline]] inline void sum_cartesian_loops(const BearingArrays& in, const double* x, double origin_s,
                                                       CartesianSums& out) {
  const double x0 = x[0], y0 = x[1], vx = x[2], vy = x[3];
  double cost = 0, ra = 0, rb = 0, rat = 0, rbt = 0, aa = 0, ab = 0, bb = 0, aat = 0, abt = 0, bbt = 0, aatt = 0,
         abtt = 0, bbtt = 0;
#pragma omp simd simdlen(kWidth) reduction(+ : cost, ra, rb, rat, rbt, aa, ab, bb, aat, abt, bbt, aatt, abtt, bbtt)
  for (std::size_t i = 0; i < in.count; ++i) {
    const double t = in.time_s[i] - origin_s;
    const double dx = x0 + vx * t - in.first[i], dy = y0 + vy * t - in.second[i];
    // Sine and cosine of B - B_hat, times the range: the residual comes out wrapped.
    const double r = arctangent(in.sine[i] * dy - in.cosine[i] * dx, in.cosine[i] * dy + in.sine[i] * dx);
    const double inverse = 1.0 / (dx * dx + dy * dy);
    const double a = dy * inverse, b = -dx * inverse;
    const double w = in.weight[i], wr = w * r, wa = w * a, wb = w * b;
    const double waa = wa * a, wab = wa * b, wbb = wb * b, wra = wr * a, wrb = wr * b;
    cost += wr * r;
    ra += wra;
    rb += wrb;
    rat += wra * t;
    rbt += wrb * t;
    aa += waa;
    ab += wab;
    bb += wbb;
    aat += waa * t;
    abt += wab * t;
    bbt += wbb * t;
    aatt += waa * t * t;
    abtt += wab * t * t;
    bbtt += wbb * t * t;
  }
  out = {0.5 * cost, ra, rb, rat, rbt, aa, ab, bb, aat, abt, bbt, aatt, abtt, bbtt};
}
TRUEBEARING_FOR_WIDEST(sum_cartesian, (const BearingArrays& in, const double* x, double origin_s, CartesianSums& out),
                       (in, x, origin_s, out))

template <int kWidth, bool kHuber>
[[gnu::always_inline]] inline void modified_polar_loops(const BearingArrays& in, const double* y, double origin_s,
                                                        double huber_sigmas, ModifiedPolarSums& out) {
  const double sine = std::sin(y[0]), cosine = std::cos(y[0]), rate = y[1], closing = y[2], rho = y[3];
  double cost = 0, g0 = 0, g1 = 0, g2 = 0, g3 = 0, a00 = 0, a10 = 0, a11 = 0, a20 = 0, a21 = 0, a22 = 0, a30 = 0,
         a31 = 0, a32 = 0, a33 = 0;
#pragma omp simd simdlen(kWidth) reduction(+ : cost, g0, g1, g2, g3, a00, a10, a11, a20, a21, a22, a30, a31, a32, a33)
  for (std::size_t i = 0; i < in.count; ++i) {
    const double t = in.time_s[i] - origin_s;
    // The departure of the sensor from its line, along the line of sight at origin_s and across it.
    const double along = in.first[i] * sine + in.second[i] * cosine;
    const double across = in.first[i] * cosine - in.second[i] * sine;
    // The target from the sensor, in ranges: u along, v across; B = beta + atan2(v, u).
    const double u = 1.0 + closing * t - rho * along, v = rate * t - rho * across;
    const double s = in.sine[i] * cosine - in.cosine[i] * sine, c = in.cosine[i] * cosine + in.sine[i] * sine;
    const double r = arctangent(s * u - c * v, c * u + s * v);
    const double inverse = 1.0 / (u * u + v * v);
    const double j0 = 1.0 + rho * (u * along + v * across) * inverse, j1 = u * t * inverse, j2 = -v * t * inverse,
                 j3 = (v * along - u * across) * inverse;
    double w = in.weight[i];
    if constexpr (kHuber) {
      const double size = std::fabs(r) * std::sqrt(w);
      const bool far = size > huber_sigmas;
      w = far ? w * huber_sigmas / size : w;
      cost += far ? huber_sigmas * (2.0 * size - huber_sigmas) : size * size;
    } else {
      cost += w * r * r;
    }
    const double w0 = w * j0, w1 = w * j1, w2 = w * j2, w3 = w * j3;
    g0 += w0 * r;
    g1 += w1 * r;
    g2 += w2 * r;
    g3 += w3 * r;
    a00 += w0 * j0;
    a10 += w1 * j0;
    a11 += w1 * j1;
    a20 += w2 * j0;
    a21 += w2 * j1;
    a22 += w2 * j2;
    a30 += w3 * j0;
    a31 += w3 * j1;
    a32 += w3 * j2;
    a33 += w3 * j3;
  }
  out = {0.5 * cost, {g0, g1, g2, g3}, {a00, a10, a11, a20, a21, a22, a30, a31, a32, a33}};
}
template <int kWidth>
[[gnu::always_inline]] inline void sum_modified_polar_loops(const BearingArrays& in, const double* y, double origin_s,
                                                            ModifiedPolarSums& out) {
  modified_polar_loops<kWidth, false>(in, y, origin_s, 0.0, out);
}
TRUEBEARING_FOR_WIDEST(sum_modified_polar,
                       (const BearingArrays& in, const double* y, double origin_s, ModifiedPolarSums& out),
                       (in, y, origin_s, out))
template <int kWidth>
[[gnu::always_inline]] inline void sum_huber_loops(const BearingArrays& in, const double* y, double origin_s,
                                                   double huber_sigmas, ModifiedPolarSums& out) {
  modified_polar_loops<kWidth, true>(in, y, origin_s, huber_sigmas, out);
}
TRUEBEARING_FOR_WIDEST(sum_huber,
                       (const BearingArrays& in, const double* y, double origin_s, double huber_sigmas,
                        ModifiedPolarSums& out),
                       (in, y, origin_s, huber_sigmas, out))

template <int kWidth>
[[gnu::always_inline]] inline void sum_frequencies_loops(const FrequencyArrays& in, const double* y, double mean_hz,
                                                         double sound_mps, FrequencySums& out) {
  const double sine = std::sin(y[0]), cosine = std::cos(y[0]), rate = y[1], closing = y[2], rho = y[3];
  const double r = 1.0 / rho, rate_mps = r * rate, closing_mps = r * closing, slowness = 1.0 / sound_mps;
  double squares = 0, information = 0, product = 0, g0 = 0, g1 = 0, g2 = 0, g3 = 0, s0 = 0, s1 = 0, s2 = 0, s3 = 0,
         a00 = 0, a10 = 0, a11 = 0, a20 = 0, a21 = 0, a22 = 0, a30 = 0, a31 = 0, a32 = 0, a33 = 0;
#pragma omp simd simdlen(kWidth) reduction(+ : squares, information, product, g0, g1, g2, g3, s0, s1, s2, s3, \
                           a00, a10, a11, a20, a21, a22, a30, a31, a32, a33)
  for (std::size_t i = 0; i < in.count; ++i) {
    const double t = in.time_s[i];
    const double d_par = in.east_m[i] * sine + in.north_m[i] * cosine;
    const double d_perp = in.east_m[i] * cosine - in.north_m[i] * sine;
    const double e_par = in.east_mps[i] * sine + in.north_mps[i] * cosine;
    const double e_perp = in.east_mps[i] * cosine - in.north_mps[i] * sine;
    const double u = 1.0 + closing * t - rho * d_par, v = rate * t - rho * d_perp;
    const double inverse = 1.0 / std::sqrt(u * u + v * v), U = u * inverse, V = v * inverse;
    const double along = closing_mps - e_par, across = rate_mps - e_perp;  // the relative velocity
    const double q = slowness * (along * U + across * V), shift = 1.0 - q;
    const double turn = (across * U - along * V) * inverse;
    const double q0 = slowness * (V * e_par - U * e_perp + rho * turn * (U * d_par + V * d_perp)),
                 q1 = slowness * (V * r + turn * U * t), q2 = slowness * (U * r - turn * V * t),
                 q3 = slowness * (turn * (V * d_par - U * d_perp) - r * (closing_mps * U + rate_mps * V));
    const double w = in.weight[i], residual = in.above_hz[i] + mean_hz * q, wr = w * residual, ws = w * shift;
    squares += wr * residual;
    information += ws * shift;
    product += wr * shift;
    g0 += wr * q0;
    g1 += wr * q1;
    g2 += wr * q2;
    g3 += wr * q3;
    s0 += ws * q0;
    s1 += ws * q1;
    s2 += ws * q2;
    s3 += ws * q3;
    const double w0 = w * q0, w1 = w * q1, w2 = w * q2, w3 = w * q3;
    a00 += w0 * q0;
    a10 += w1 * q0;
    a11 += w1 * q1;
    a20 += w2 * q0;
    a21 += w2 * q1;
    a22 += w2 * q2;
    a30 += w3 * q0;
    a31 += w3 * q1;
    a32 += w3 * q2;
    a33 += w3 * q3;
  }
  out = {squares,          information,      product,
         {g0, g1, g2, g3}, {s0, s1, s2, s3}, {a00, a10, a11, a20, a21, a22, a30, a31, a32, a33}};
}
TRUEBEARING_FOR_WIDEST(sum_frequencies,
                       (const FrequencyArrays& in, const double* y, double mean_hz, double sound_mps,
                        FrequencySums& out),
                       (in, y, mean_hz, sound_mps, out))

}  // namespace

CartesianSums cartesian_sums(const BearingArrays& bearings, const double* x, double origin_s) {
  CartesianSums sums;
  sum_cartesian(bearings, x, origin_s, sums);
  return sums;
}

ModifiedPolarSums modified_polar_sums(const BearingArrays& bearings, const double* y, double origin_s,
                                      double huber_sigmas) {
  ModifiedPolarSums sums;
  if (std::isfinite(huber_sigmas))
    sum_huber(bearings, y, origin_s, huber_sigmas, sums);
  else
    sum_modified_polar(bearings, y, origin_s, sums);
  return sums;
}

FrequencySums frequency_sums(const FrequencyArrays& frequencies, const double* y, double mean_hz, double sound_mps) {
  FrequencySums sums;
  sum_frequencies(frequencies, y, mean_hz, sound_mps, sums);
  return sums;
}

}  // namespace truebearing
