// SPDX-License-Identifier: Apache-2.0
// The loops of particle_cloud.hpp over all particles, in SIMD instructions where the processor has them. A particle is
// one element of each row; `stride` doubles lie between two rows.
#pragma once

#include <cstddef>

namespace truebearing::kernels {

/// Rows of a particle's Gaussian: x = [p (2), v (2)], and of its covariance Ppp (symmetric), Ppv, Pvv (symmetric).
enum ParticleRow : std::size_t { p0, p1, v0, v1, pp00, pp01, pp11, pv00, pv01, pv10, pv11, vv00, vv01, vv11 };
inline constexpr std::size_t kParticleRows = vv11 + 1;
/// Rows of a step: p' = p + ..., whose Jacobian is [I, G; 0, A].
enum StepRow : std::size_t { G00, G01, G10, G11, A00, A01, A10, A11 };
inline constexpr std::size_t kStepRows = A11 + 1;

struct Particles {
  std::size_t count, stride;
  double* rows;  ///< kParticleRows
};

/// P' = F P F' of each, from one set to another; the means are moved elsewhere.
void predict_particles(const Particles& from, const double* steps, const Particles& to);

/// Each particle's update with the measured position z (2) with covariance R (symmetric: R00, R01, R11). nis and scale
/// are nu' S^-1 nu and 1 / sqrt(det S) of each.
struct PositionUpdate {
  double z0, z1, R00, R01, R11;
  double *nis, *scale;
};
void update_particles(const Particles& particles, const PositionUpdate& update);

/// Weighted sums over all: [0] of w, [1 to 4] of w x, [5 to 14] of w (P + x x') in the order pp00 ... vv11 with x from
/// `origin`, [15] of w^2.
inline constexpr int kMoments = 16;
void particle_moments(const Particles& particles, const double* weight, const double* origin, double* sums);

}  // namespace truebearing::kernels
