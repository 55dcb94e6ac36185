// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tma/cho_2015.hpp"

#include <Eigen/LU>
#include <cmath>

#include "truebearing/core/linear_algebra.hpp"

namespace truebearing {
namespace {

Eigen::Vector4d gauss_newton_step(const NormalEquations<4>& at, ChoOptions::Inverse inverse) {
  switch (inverse) {
    case ChoOptions::Inverse::cofactor:
      return at.A.inverse() * at.gradient;
    case ChoOptions::Inverse::cofactor_float:
      return (at.A.cast<float>().inverse() * at.gradient.cast<float>()).cast<double>();
    case ChoOptions::Inverse::pivoted:
      break;
  }
  return at.A.fullPivLu().solve(at.gradient);
}

struct Descent {
  Eigen::Vector4d x;
  NormalEquations<4> at;
  int iterations = 0;
  bool converged = false;
};

Descent descend(const BearingWindow& window, const Eigen::Vector4d& start, const ChoOptions& options) {
  const double origin_s = window.first_time_s();
  Descent descent{start, window.cartesian(start, origin_s)};
  const bool damped = options.method != ChoOptions::Method::gauss_newton;
  const bool marquardt = options.method == ChoOptions::Method::levenberg_marquardt;
  double mu = descent.at.A.maxCoeff();
  while (descent.iterations < options.k_max && descent.at.is_finite()) {
    ++descent.iterations;
    const Eigen::Matrix4d& A = descent.at.A;  // J'WJ
    const Eigen::Vector4d D = marquardt ? Eigen::Vector4d(A.diagonal()) : Eigen::Vector4d::Ones();
    Eigen::Vector4d h;
    if (damped)  // Equation (10)
      h = solve_semidefinite<4>(A + Eigen::Matrix4d((mu * D).asDiagonal()), descent.at.gradient);
    else  // Equation (9)
      h = gauss_newton_step(descent.at, options.inverse);
    const double cost = descent.at.cost, promised = 0.5 * h.dot(mu * D.cwiseProduct(h) + descent.at.gradient);
    descent.x += h;
    descent.at = window.cartesian(descent.x, origin_s);
    if (damped) {
      const double ratio = (cost - descent.at.cost) / promised;  // Equation (11)
      if (ratio < 0.25)                                          // Equation (12)
        mu *= 2.0;
      else if (ratio > 0.75)
        mu /= 3.0;
    }
    descent.converged = h.norm() < options.tolerance;
    if (descent.converged) break;
  }
  return descent;
}

}  // namespace

Eigen::Vector4d cho_start(const BearingWindow& window, int i) {
  constexpr double kKilometre = 1000.0;
  const auto position = [&](std::size_t k, int kilometres) -> Eigen::Vector2d {
    const double bearing = window.bearing_rad(k);
    return window.site_m(k) + kilometres * kKilometre * Eigen::Vector2d(std::sin(bearing), std::cos(bearing));
  };
  const Eigen::Vector2d first = position(0, 1 + i / kChoRanges);
  const Eigen::Vector2d last = position(window.size() - 1, 1 + i % kChoRanges);
  Eigen::Vector4d x;
  x << first, (last - first) / (window.last_time_s() - window.first_time_s());
  return x;
}

BatchEstimate solve_cho(const BearingWindow& window, const ChoOptions& options) {
  BatchEstimate estimate;
  estimate.time_s = window.last_time_s();
  Eigen::Matrix4d information;
  for (int i = 0; i < kChoStarts; ++i) {
    const Descent descent = descend(window, cho_start(window, i), options);
    ++estimate.starts;
    if (!descent.x.allFinite() || !descent.at.is_finite()) {
      ++estimate.non_finite_starts;
      continue;
    }
    if (estimate.found && descent.at.cost >= estimate.cost) continue;
    estimate.found = true;
    estimate.cost = descent.at.cost;
    estimate.iterations = descent.iterations;
    estimate.converged = descent.converged;
    estimate.x = descent.x;
    information = descent.at.A;
  }
  if (!estimate.found) return estimate;
  estimate.P = covariance_of(information);
  carry(window.last_time_s() - window.first_time_s(), estimate.x, estimate.P);
  return estimate;
}

}  // namespace truebearing
