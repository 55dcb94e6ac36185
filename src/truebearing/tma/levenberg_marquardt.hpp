// SPDX-License-Identifier: Apache-2.0
// Levenberg-Marquardt for weighted least squares in N parameters, with rejection of steps that do not descend,
// Marquardt's scaling and Nielsen's damping (Nielsen 1999; Madsen, Nielsen and Tingleff 2004, algorithm 3.16). Fixed
// size, no heap.
//
//     (A + mu D) h = J'Wr,  A = J'WJ,  D = diag(A)
//     gain ratio = (F(x) - F(x + h)) / (L(0) - L(h))
//
// A problem is a callable: problem(x) gives the NormalEquations<N> there, not finite where x makes no sense.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "truebearing/core/linear_algebra.hpp"
#include "truebearing/tma/normal_equations.hpp"

namespace truebearing {

template <int N>
struct LevenbergMarquardtOptions {
  using Vector = Eigen::Matrix<double, N, 1>;

  double mu0 = 1e-3;
  int max_iterations = 60;
  /// Converged where the model promises less than this, in the units of the cost.
  double cost_tolerance = 1e-9;
  /// Smaller entries of D count as this: directions that the data say nothing about stay where they are.
  Vector least_curvature = Vector::Constant(1e-30);
  /// Parameters stay above these.
  Vector lower = Vector::Constant(-std::numeric_limits<double>::infinity());
};

enum class Convergence { converged, out_of_iterations, not_finite };

template <int N>
struct Minimum {
  Eigen::Matrix<double, N, 1> x;
  NormalEquations<N> at;  ///< the normal equations there
  int iterations = 0;     ///< steps tried
  Convergence convergence = Convergence::not_finite;
};

template <int N, typename Problem>
Minimum<N> levenberg_marquardt(const Problem& problem, const Eigen::Matrix<double, N, 1>& start,
                               const LevenbergMarquardtOptions<N>& options = {}) {
  using Vector = Eigen::Matrix<double, N, 1>;
  using Matrix = Eigen::Matrix<double, N, N>;
  constexpr double kLargestDamping = 1e30;
  Minimum<N> best{start.cwiseMax(options.lower), {}, 0, Convergence::not_finite};
  best.at = problem(best.x);
  if (!best.at.is_finite()) return best;

  double mu = options.mu0, nu = 2.0;
  best.convergence = Convergence::out_of_iterations;
  while (best.iterations < options.max_iterations) {
    ++best.iterations;
    Matrix A = best.at.A;
    Vector g = best.at.gradient;
    const Vector D = A.diagonal().cwiseMax(options.least_curvature);
    A.diagonal() += mu * D;
    // A parameter that leans on its bound is held there.
    for (int i = 0; i < N; ++i)
      if (best.x[i] <= options.lower[i] && g[i] < 0.0) {
        A.row(i).setZero();
        A.col(i).setZero();
        A(i, i) = 1.0;
        g[i] = 0.0;
      }
    const Vector x = (best.x + solve_positive<N>(A, g)).cwiseMax(options.lower);
    const Vector h = x - best.x;
    // What the model promises for the step that is taken: it may have been cut at a bound.
    const double promised = h.dot(best.at.gradient) - 0.5 * h.dot(best.at.A * h);
    if (std::abs(promised) <= options.cost_tolerance && mu < 1.0) {
      best.convergence = Convergence::converged;
      break;
    }
    const NormalEquations<N> tried = problem(x);
    const double gained = best.at.cost - tried.cost;
    if (tried.is_finite() && gained > 0.0 && promised > 0.0) {
      const double beyond_half = 2.0 * (gained / promised) - 1.0;
      best.x = x;
      best.at = tried;
      mu *= std::max(1.0 / 3.0, 1.0 - beyond_half * beyond_half * beyond_half);
      nu = 2.0;
    } else {
      if (std::abs(gained) <= options.cost_tolerance) {  // nothing left but rounding
        best.convergence = Convergence::converged;
        break;
      }
      mu *= nu;
      nu *= 2.0;
      if (mu > kLargestDamping) break;
    }
  }
  return best;
}

}  // namespace truebearing
