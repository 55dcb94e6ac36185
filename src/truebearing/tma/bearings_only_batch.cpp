#include "truebearing/tma/bearings_only_batch.hpp"

#include <algorithm>
#include <cmath>

#include "truebearing/motion/constant_velocity.hpp"
#include "truebearing/tma/cho_2015.hpp"

namespace truebearing {
namespace {

constexpr double kLeastInverseRange = 1e-6;   // 1000 km
constexpr double kLargestInverseRange = 0.1;  // 10 m: nearer there is only noise to explain

LevenbergMarquardtOptions<4> descent_options(int max_iterations) {
  LevenbergMarquardtOptions<4> options;
  options.max_iterations = max_iterations;
  // Of bearings that say nothing: a standard deviation of a thousand radians, of 10 rad/s, of 1 / m.
  options.least_curvature << 1e-6, 1e-2, 1e-2, 1.0;
  options.lower[3] = kLeastInverseRange;
  return options;
}

}  // namespace

void BatchPrior::add(const ModifiedPolar& polar, const Eigen::Vector4d& y, NormalEquations<4>& equations) const {
  const Eigen::Vector4d x = polar.to_cartesian(y);
  const Eigen::Matrix4d T = polar.jacobian(y);
  const Eigen::Vector2d dv = velocity_mps - x.tail<2>(), weighted = velocity_information * dv;
  const Eigen::Matrix<double, 2, 4> V = T.bottomRows<2>();
  equations.cost += 0.5 * dv.dot(weighted);
  equations.gradient += V.transpose() * weighted;
  equations.A += V.transpose() * velocity_information * V;
  if (!range) return;
  const double t = range->time_s - polar.origin_s(), weight = 1.0 / (range->sigma_m * range->sigma_m);
  const Eigen::Vector2d offset_m = x.head<2>() + t * x.tail<2>() - range->from_m;
  const double range_m = offset_m.norm();
  const Eigen::RowVector2d u = offset_m.transpose() / range_m;
  const Eigen::RowVector4d row = u * T.topRows<2>() + t * u * V;
  const double error = range->mean_m - range_m;
  equations.cost += 0.5 * weight * error * error;
  equations.gradient += weight * error * row.transpose();
  equations.A += weight * row.transpose() * row;
}

BatchEstimate BearingsOnlyBatch::solve(const BearingWindow& window, const std::optional<BatchPrior>& prior,
                                       const Eigen::Vector4d* warm) {
  BatchEstimate estimate;
  if (window.size() < 3 || !(window.last_time_s() > window.first_time_s())) return estimate;
  polar_.look_at(window);
  const auto problem = [&](const Eigen::Vector4d& y) {
    NormalEquations<4> equations = polar_(y);
    if (prior) prior->add(polar_, y, equations);
    if (y[3] > kLargestInverseRange) equations.cost = std::numeric_limits<double>::infinity();
    return equations;
  };
  const LevenbergMarquardtOptions<4> options = descent_options(options_.max_iterations);
  const double to_end_s = window.last_time_s() - polar_.origin_s();

  minima_.clear();
  const auto descend = [&](const Eigen::Vector4d& start) {
    ++estimate.starts;
    Minimum<4> minimum = levenberg_marquardt(problem, start, options);
    if (minimum.convergence == Convergence::not_finite)
      ++estimate.non_finite_starts;
    else
      minima_.push_back(minimum);
  };
  if (warm) {
    Eigen::Vector4d x = *warm;
    x.head<2>() -= to_end_s * x.tail<2>();
    descend(polar_.from_cartesian(x));
  }
  for (const double range_m : options_.start_ranges_m) descend(polar_.start(range_m));
  const auto from_cho = [&](int i) {
    Eigen::Vector4d x = cho_start(window, i);
    x.head<2>() += (polar_.origin_s() - window.first_time_s()) * x.tail<2>();
    descend(polar_.from_cartesian(x));
  };
  // Bearings of a target that passed close by are no straight line, nor is a start that takes them for one any good. So
  // where all that was found fits far worse than noise does, a few starts that hold on to the ends.
  const auto fits = [&](const Minimum<4>& minimum) {
    const double m = static_cast<double>(window.size());
    return 2.0 * minimum.at.cost < m + 6.0 * std::sqrt(2.0 * m);
  };
  if (options_.start_grid) {
    for (int i = 0; i < kChoStarts; ++i) from_cho(i);
  } else if (std::none_of(minima_.begin(), minima_.end(), fits)) {
    for (const int first_km : {2, 6, 13})
      for (const int last_km : {2, 6, 13}) from_cho((first_km - 1) * kChoRanges + last_km - 1);
  }
  if (minima_.empty()) return estimate;

  const Minimum<4>& best = *std::min_element(minima_.begin(), minima_.end(),
                                             [](const auto& a, const auto& b) { return a.at.cost < b.at.cost; });
  const Eigen::Matrix4d T = ConstantVelocity<2, ContinuousWhiteNoise>{}.F(to_end_s) * polar_.jacobian(best.x);
  const NormalEquations<4> data = polar_(best.x);
  estimate.found = true;
  estimate.time_s = window.last_time_s();
  estimate.cost = data.cost;
  estimate.iterations = best.iterations;
  Eigen::Matrix4d information = best.at.A;
  // What the data leave open is known by .1 rad/s, .1 / s and 1 / (100 m) and no worse, so that P stays finite.
  information.diagonal() += Eigen::Vector4d(0.0, 1e2, 1e2, 1e4);
  estimate.P = T * covariance_of(information) * T.transpose();
  estimate.P = 0.5 * (estimate.P + estimate.P.transpose().eval());
  const auto at_end = [&](const Eigen::Vector4d& y) {
    Eigen::Vector4d x = polar_.to_cartesian(y);
    x.head<2>() += to_end_s * x.tail<2>();
    return x;
  };
  estimate.x = at_end(best.x);

  observability_ = truebearing::observability(data.A, best.x, polar_.length_s(), T);
  const auto at_infinity = [&](Eigen::Vector4d y) {
    y[3] = 0.0;
    NormalEquations<4> equations = polar_(y);
    equations.gradient[3] = 0.0;
    equations.A.row(3).setZero();
    equations.A.col(3).setZero();
    return equations;
  };
  const double farthest = levenberg_marquardt(at_infinity, polar_.start(1.0), options).at.cost;
  observability_.against_infinity = 2.0 * (farthest - data.cost);
  ambiguities_.clear();
  constexpr double kLikely = 1.92, kSameRange = 1.2;
  for (const Minimum<4>& minimum : minima_) {
    const double above = minimum.at.cost - best.at.cost;
    const auto same = [&](const Eigen::Vector4d& y) {
      return std::max(y[3], minimum.x[3]) < kSameRange * std::min(y[3], minimum.x[3]);
    };
    if (minimum.convergence != Convergence::converged || above > kLikely || same(best.x)) continue;
    ambiguities_.push_back({at_end(minimum.x), above});
  }
  return estimate;
}

}  // namespace truebearing
