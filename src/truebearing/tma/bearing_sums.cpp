#include "truebearing/tma/bearing_sums.hpp"

#include <cmath>

#include "truebearing/tma/arctangent.hpp"

namespace truebearing {
namespace {

[[gnu::always_inline]] inline void sum_cartesian(const BearingArrays& in, const double* x, double origin_s,
                                                 CartesianSums& out) {
  const double x0 = x[0], y0 = x[1], vx = x[2], vy = x[3];
  double cost = 0, ra = 0, rb = 0, rat = 0, rbt = 0, aa = 0, ab = 0, bb = 0, aat = 0, abt = 0, bbt = 0, aatt = 0,
         abtt = 0, bbtt = 0;
#pragma omp simd reduction(+ : cost, ra, rb, rat, rbt, aa, ab, bb, aat, abt, bbt, aatt, abtt, bbtt)
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

[[gnu::always_inline]] inline void sum_modified_polar(const BearingArrays& in, const double* y, double origin_s,
                                                      double huber_sigmas, ModifiedPolarSums& out) {
  const double sine = std::sin(y[0]), cosine = std::cos(y[0]), rate = y[1], closing = y[2], rho = y[3];
  double cost = 0, g0 = 0, g1 = 0, g2 = 0, g3 = 0, a00 = 0, a10 = 0, a11 = 0, a20 = 0, a21 = 0, a22 = 0, a30 = 0,
         a31 = 0, a32 = 0, a33 = 0;
#pragma omp simd reduction(+ : cost, g0, g1, g2, g3, a00, a10, a11, a20, a21, a22, a30, a31, a32, a33)
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
    const double size = std::fabs(r) * std::sqrt(in.weight[i]);
    const bool far = size > huber_sigmas;
    const double w = far ? in.weight[i] * huber_sigmas / size : in.weight[i];
    cost += far ? huber_sigmas * (2.0 * size - huber_sigmas) : size * size;
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

#if defined(__x86_64__) && defined(__GNUC__)
const bool kHasFma = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");

[[gnu::target("avx2,fma")]] void sum_cartesian_fma(const BearingArrays& in, const double* x, double origin_s,
                                                   CartesianSums& out) {
  sum_cartesian(in, x, origin_s, out);
}
[[gnu::target("avx2,fma")]] void sum_modified_polar_fma(const BearingArrays& in, const double* y, double origin_s,
                                                        double huber_sigmas, ModifiedPolarSums& out) {
  sum_modified_polar(in, y, origin_s, huber_sigmas, out);
}
#else
constexpr bool kHasFma = false;
constexpr auto sum_cartesian_fma = sum_cartesian;
constexpr auto sum_modified_polar_fma = sum_modified_polar;
#endif

}  // namespace

CartesianSums cartesian_sums(const BearingArrays& bearings, const double* x, double origin_s) {
  CartesianSums sums;
  if (kHasFma)
    sum_cartesian_fma(bearings, x, origin_s, sums);
  else
    sum_cartesian(bearings, x, origin_s, sums);
  return sums;
}

ModifiedPolarSums modified_polar_sums(const BearingArrays& bearings, const double* y, double origin_s,
                                      double huber_sigmas) {
  ModifiedPolarSums sums;
  if (kHasFma)
    sum_modified_polar_fma(bearings, y, origin_s, huber_sigmas, sums);
  else
    sum_modified_polar(bearings, y, origin_s, huber_sigmas, sums);
  return sums;
}

}  // namespace truebearing
