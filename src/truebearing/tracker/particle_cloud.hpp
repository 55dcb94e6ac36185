// SPDX-License-Identifier: Apache-2.0
// A Rao-Blackwellised particle filter of a planar flight (Doucet, de Freitas, Murphy and Russell 2000): each particle
// holds what its target is doing (flight_modes.hpp) and, given that, a Gaussian of x = [p (2), v (2)] in m and m/s.
// Given legs and turns that is exact; of accelerations along the track it is of first order. All memory is taken at
// construction.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "truebearing/core/random.hpp"
#include "truebearing/tracker/flight_modes.hpp"
#include "truebearing/tracker/particle_kernels.hpp"

namespace truebearing {

class ParticleCloud {
 public:
  struct Moments {
    Eigen::Vector4d x;
    Eigen::Matrix4d P;
  };

  explicit ParticleCloud(std::size_t particles);

  /// Targets at a measured position z (2) with covariance R (2 x 2) whose flight begins, or began a time ago that is
  /// evenly distributed up to flown_s.
  void begin(const FlightModes& modes, const Eigen::Vector2d& z, const Eigen::Matrix2d& R, double flown_s,
             RandomStream& stream);
  /// All of `from`, dt_s later.
  void move(const ParticleCloud& from, const FlightModes& modes, double dt_s, RandomStream& stream);
  /// Weighs and updates with a measured position z (2) with covariance R (2 x 2). False where no particle could have
  /// led to it: the weights are of no use then.
  bool update(const Eigen::Vector2d& z, const Eigen::Matrix2d& R);
  /// As many particles of equal weight, drawn of `from` by its weights (systematically).
  void resample(const ParticleCloud& from, RandomStream& stream);

  /// Of the mixture.
  Moments moments() const;
  /// Probabilities of leg, turn and acceleration.
  Eigen::Vector3d mode_probabilities() const;
  /// 1 / sum of the squared weights: how many particles carry the estimate.
  double effective() const { return effective_; }
  std::size_t size() const { return count_; }

 private:
  double* row(std::size_t of) { return rows_.data() + of * stride_; }
  const double* row(std::size_t of) const { return rows_.data() + of * stride_; }
  kernels::Particles all() const { return {count_, stride_, const_cast<double*>(rows_.data())}; }

  std::size_t count_, stride_;
  double effective_ = 0.0;
  std::vector<FlightMode> modes_;
  std::vector<double> weight_;  // sums to 1, but for those that are moved
  std::vector<double> rows_, steps_;
  std::vector<double> nis_, scale_;
};

}  // namespace truebearing
