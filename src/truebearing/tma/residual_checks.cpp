#include "truebearing/tma/residual_checks.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "truebearing/core/chi_square.hpp"

namespace truebearing {
namespace {

constexpr double kConfidence = 0.999;
constexpr int kParameters = 4;

// g' S^-1 g without the directions in which S is nothing but rounding: there a change would look like no change.
double score(const Eigen::Vector2d& g, const Eigen::Matrix2d& S, double whole) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(S);
  double sum = 0.0;
  for (int i = 0; i < 2; ++i) {
    const double projected = eigen.eigenvectors().col(i).dot(g);
    if (eigen.eigenvalues()[i] > 1e-9 * whole) sum += projected * projected / eigen.eigenvalues()[i];
  }
  return sum;
}

}  // namespace

ResidualChecks check_residuals(const BearingWindow& window, const BatchEstimate& estimate) {
  constexpr std::size_t kTimes = 40, kMargin = 3;
  const std::size_t m = window.size();
  const double origin_s = estimate.time_s;
  ResidualChecks checks;
  checks.degrees_of_freedom = static_cast<int>(m) - kParameters;

  double products = 0.0, previous = 0.0;
  for (std::size_t i = 0; i < m; ++i) {
    const double e = window.residual(i, estimate.x, origin_s) * std::sqrt(window.weight(i));
    checks.chi_square += e * e;
    products += e * previous;
    previous = e;
  }
  checks.lag_one = products / checks.chi_square * std::sqrt(static_cast<double>(m));
  checks.fits = checks.chi_square <= chi_square_quantile(kConfidence, checks.degrees_of_freedom);
  checks.white = std::abs(checks.lag_one) <= normal_quantile(0.5 + 0.5 * kConfidence);

  const Eigen::Matrix4d P = covariance_of(window.cartesian(estimate.x, origin_s).A);
  const std::size_t step = std::max<std::size_t>(1, m / kTimes);
  int looked_at = 0;
  for (std::size_t change = kMargin; change + kMargin < m; change += step, ++looked_at) {
    Eigen::Vector2d g = Eigen::Vector2d::Zero();
    Eigen::Matrix2d GG = Eigen::Matrix2d::Zero();
    Eigen::Matrix<double, 2, 4> GJ = Eigen::Matrix<double, 2, 4>::Zero();
    for (std::size_t i = change + 1; i < m; ++i) {
      const Eigen::RowVector4d J = window.jacobian(i, estimate.x, origin_s);
      const Eigen::Vector2d G = (window.time_s(i) - window.time_s(change)) * J.head<2>().transpose();
      const double w = window.weight(i);
      g += w * window.residual(i, estimate.x, origin_s) * G;
      GG += w * G * G.transpose();
      GJ += w * G * J;
    }
    const double statistic = score(g, GG - GJ * P * GJ.transpose(), GG.trace());
    if (statistic <= checks.manoeuvre) continue;
    checks.manoeuvre = statistic;
    checks.manoeuvre_s = window.time_s(change);
  }
  if (looked_at > 0) checks.manoeuvred = checks.manoeuvre > -2.0 * std::log((1.0 - kConfidence) / looked_at);
  return checks;
}

}  // namespace truebearing
