// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/particle_kernels.hpp"

#include <cmath>

#include "truebearing/core/simd_dispatch.hpp"

namespace truebearing::kernels {
namespace {

[[gnu::always_inline]] inline void predict_particles_loops(const Particles& from, const double* steps,
                                                           const Particles& to) {
  const std::size_t stride = from.stride;
  const double* const rows = from.rows;
  double* const moved = to.rows;
#pragma omp simd
  for (std::size_t i = 0; i < from.count; ++i) {
    const double g00 = steps[G00 * stride + i], g01 = steps[G01 * stride + i];
    const double g10 = steps[G10 * stride + i], g11 = steps[G11 * stride + i];
    const double a00 = steps[A00 * stride + i], a01 = steps[A01 * stride + i];
    const double a10 = steps[A10 * stride + i], a11 = steps[A11 * stride + i];
    const double c00 = rows[pv00 * stride + i], c01 = rows[pv01 * stride + i];
    const double c10 = rows[pv10 * stride + i], c11 = rows[pv11 * stride + i];
    const double w00 = rows[vv00 * stride + i], w01 = rows[vv01 * stride + i], w11 = rows[vv11 * stride + i];
    // D = Ppv + G Pvv, Ppp' = Ppp + G Ppv' + D G', Ppv' = D A', Pvv' = A Pvv A'.
    const double d00 = c00 + g00 * w00 + g01 * w01, d01 = c01 + g00 * w01 + g01 * w11;
    const double d10 = c10 + g10 * w00 + g11 * w01, d11 = c11 + g10 * w01 + g11 * w11;
    moved[pp00 * stride + i] = rows[pp00 * stride + i] + g00 * c00 + g01 * c01 + d00 * g00 + d01 * g01;
    moved[pp01 * stride + i] = rows[pp01 * stride + i] + g00 * c10 + g01 * c11 + d00 * g10 + d01 * g11;
    moved[pp11 * stride + i] = rows[pp11 * stride + i] + g10 * c10 + g11 * c11 + d10 * g10 + d11 * g11;
    moved[pv00 * stride + i] = d00 * a00 + d01 * a01;
    moved[pv01 * stride + i] = d00 * a10 + d01 * a11;
    moved[pv10 * stride + i] = d10 * a00 + d11 * a01;
    moved[pv11 * stride + i] = d10 * a10 + d11 * a11;
    const double b00 = a00 * w00 + a01 * w01, b01 = a00 * w01 + a01 * w11;
    const double b10 = a10 * w00 + a11 * w01, b11 = a10 * w01 + a11 * w11;
    moved[vv00 * stride + i] = b00 * a00 + b01 * a01;
    moved[vv01 * stride + i] = b00 * a10 + b01 * a11;
    moved[vv11 * stride + i] = b10 * a10 + b11 * a11;
  }
}

[[gnu::always_inline]] inline void update_particles_loops(const Particles& particles, const PositionUpdate& u) {
  const std::size_t stride = particles.stride;
  double* const rows = particles.rows;
#pragma omp simd
  for (std::size_t i = 0; i < particles.count; ++i) {
    const double s00 = rows[pp00 * stride + i] + u.R00, s01 = rows[pp01 * stride + i] + u.R01;
    const double s11 = rows[pp11 * stride + i] + u.R11;
    const double inverse_det = 1.0 / (s00 * s11 - s01 * s01);
    const double i00 = s11 * inverse_det, i01 = -s01 * inverse_det, i11 = s00 * inverse_det;
    const double nu0 = u.z0 - rows[p0 * stride + i], nu1 = u.z1 - rows[p1 * stride + i];
    const double y0 = i00 * nu0 + i01 * nu1, y1 = i01 * nu0 + i11 * nu1;
    u.nis[i] = nu0 * y0 + nu1 * y1;
    u.scale[i] = std::sqrt(inverse_det);
    const double c00 = rows[pv00 * stride + i], c01 = rows[pv01 * stride + i];
    const double c10 = rows[pv10 * stride + i], c11 = rows[pv11 * stride + i];
    // nu = z - p and Ppp = S - R, so that p' = z - R S^-1 nu, Ppp' = R - R S^-1 R and Ppv' = R S^-1 Ppv: no small
    // difference of large numbers.
    rows[p0 * stride + i] = u.z0 - (u.R00 * y0 + u.R01 * y1);
    rows[p1 * stride + i] = u.z1 - (u.R01 * y0 + u.R11 * y1);
    rows[v0 * stride + i] += c00 * y0 + c10 * y1;
    rows[v1 * stride + i] += c01 * y0 + c11 * y1;
    const double r00 = u.R00 * i00 + u.R01 * i01, r01 = u.R00 * i01 + u.R01 * i11;  // R S^-1
    const double r10 = u.R01 * i00 + u.R11 * i01, r11 = u.R01 * i01 + u.R11 * i11;
    const double q00 = rows[pp00 * stride + i], q01 = rows[pp01 * stride + i], q11 = rows[pp11 * stride + i];
    rows[pp00 * stride + i] = r00 * q00 + r01 * q01;
    rows[pp01 * stride + i] = 0.5 * (r00 * q01 + r01 * q11 + r10 * q00 + r11 * q01);
    rows[pp11 * stride + i] = r10 * q01 + r11 * q11;
    rows[pv00 * stride + i] = r00 * c00 + r01 * c10;
    rows[pv01 * stride + i] = r00 * c01 + r01 * c11;
    rows[pv10 * stride + i] = r10 * c00 + r11 * c10;
    rows[pv11 * stride + i] = r10 * c01 + r11 * c11;
    const double k00 = c00 * i00 + c10 * i01, k01 = c00 * i01 + c10 * i11;  // Kv = Ppv' S^-1
    const double k10 = c01 * i00 + c11 * i01, k11 = c01 * i01 + c11 * i11;
    rows[vv00 * stride + i] -= k00 * c00 + k01 * c10;
    rows[vv01 * stride + i] -= k00 * c01 + k01 * c11;
    rows[vv11 * stride + i] -= k10 * c01 + k11 * c11;
  }
}

[[gnu::always_inline]] inline void particle_moments_loops(const Particles& particles, const double* weight,
                                                          const double* origin, double* sums) {
  const std::size_t stride = particles.stride;
  const double* const rows = particles.rows;
  double s0 = 0, s1 = 0, s2 = 0, s3 = 0, s4 = 0, s5 = 0, s6 = 0, s7 = 0, s8 = 0, s9 = 0, s10 = 0, s11 = 0, s12 = 0,
         s13 = 0, s14 = 0, s15 = 0;
#pragma omp simd reduction(+ : s0, s1, s2, s3, s4, s5, s6, s7, s8, s9, s10, s11, s12, s13, s14, s15)
  for (std::size_t i = 0; i < particles.count; ++i) {
    const double w = weight[i];
    const double a = rows[p0 * stride + i] - origin[0], b = rows[p1 * stride + i] - origin[1];
    const double c = rows[v0 * stride + i] - origin[2], d = rows[v1 * stride + i] - origin[3];
    s0 += w;
    s1 += w * a;
    s2 += w * b;
    s3 += w * c;
    s4 += w * d;
    s5 += w * (rows[pp00 * stride + i] + a * a);
    s6 += w * (rows[pp01 * stride + i] + a * b);
    s7 += w * (rows[pp11 * stride + i] + b * b);
    s8 += w * (rows[pv00 * stride + i] + a * c);
    s9 += w * (rows[pv01 * stride + i] + a * d);
    s10 += w * (rows[pv10 * stride + i] + b * c);
    s11 += w * (rows[pv11 * stride + i] + b * d);
    s12 += w * (rows[vv00 * stride + i] + c * c);
    s13 += w * (rows[vv01 * stride + i] + c * d);
    s14 += w * (rows[vv11 * stride + i] + d * d);
    s15 += w * w;
  }
  const double all[kMoments] = {s0, s1, s2, s3, s4, s5, s6, s7, s8, s9, s10, s11, s12, s13, s14, s15};
  for (int k = 0; k < kMoments; ++k) sums[k] = all[k];
}

}  // namespace

TRUEBEARING_FOR_AVX2(predict_particles, (const Particles& from, const double* steps, const Particles& to),
                     (from, steps, to))
TRUEBEARING_FOR_AVX2(update_particles, (const Particles& particles, const PositionUpdate& update), (particles, update))
TRUEBEARING_FOR_AVX2(particle_moments,
                     (const Particles& particles, const double* weight, const double* origin, double* sums),
                     (particles, weight, origin, sums))

}  // namespace truebearing::kernels
