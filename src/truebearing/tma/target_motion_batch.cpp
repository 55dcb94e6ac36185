// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tma/target_motion_batch.hpp"

#include <algorithm>
#include <cmath>

#include "truebearing/motion/constant_velocity.hpp"
#include "truebearing/tma/cho_2015.hpp"

namespace truebearing {
namespace {

// A target that own ship's bearings run from to `first_m` at the first of them and `last_m` at the last, at origin_s.
Eigen::Vector4d between_ends(const BearingWindow& window, double first_m, double last_m, double origin_s) {
  const auto position = [&](std::size_t k, double range_m) -> Eigen::Vector2d {
    const double bearing = window.bearing_rad(k);
    return window.site_m(k) + range_m * Eigen::Vector2d(std::sin(bearing), std::cos(bearing));
  };
  const Eigen::Vector2d first = position(0, first_m), last = position(window.size() - 1, last_m);
  const Eigen::Vector2d v = (last - first) / (window.last_time_s() - window.first_time_s());
  Eigen::Vector4d x;
  x << first + (origin_s - window.first_time_s()) * v, v;
  return x;
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

void TargetMotionBatch::look_at(const BearingWindow& window, const std::optional<BatchPrior>& prior,
                                const DopplerWindow* frequencies) {
  polar_.look_at(window);
  doppler_.look_at(polar_, frequencies);
  prior_ = prior;
  end_s_ = window.last_time_s();
  minima_.clear();
}

NormalEquations<4> TargetMotionBatch::data(const Eigen::Vector4d& y) const {
  NormalEquations<4> equations = polar_(y);
  doppler_.add(y, equations);
  return equations;
}

NormalEquations<4> TargetMotionBatch::data(const Minimum<4>& minimum) const {
  return prior_ ? data(minimum.x) : minimum.at;
}

NormalEquations<4> TargetMotionBatch::objective(const Eigen::Vector4d& y) const {
  NormalEquations<4> equations = data(y);
  if (prior_) prior_->add(polar_, y, equations);
  if (y[3] > polar_.largest_inverse_range()) equations.cost = std::numeric_limits<double>::infinity();
  return equations;
}

Eigen::Vector4d TargetMotionBatch::from_end(Eigen::Vector4d x) const {
  x.head<2>() -= (end_s_ - polar_.origin_s()) * x.tail<2>();
  return polar_.from_cartesian(x);
}

Eigen::Vector4d TargetMotionBatch::at_end(const Eigen::Vector4d& y) const {
  Eigen::Vector4d x = polar_.to_cartesian(y);
  x.head<2>() += (end_s_ - polar_.origin_s()) * x.tail<2>();
  return x;
}

LevenbergMarquardtOptions<4> TargetMotionBatch::descent_options() const {
  LevenbergMarquardtOptions<4> options;
  options.max_iterations = options_.max_iterations;
  // Of bearings that say nothing: a standard deviation of a thousand radians, of 10 rad/s, of 1 / m.
  options.least_curvature << 1e-6, 1e-2, 1e-2, polar_.scale() * polar_.scale();
  options.lower[3] = polar_.least_inverse_range();
  return options;
}

void TargetMotionBatch::descend(const Eigen::Vector4d& start, BatchEstimate& estimate) {
  ++estimate.starts;
  Minimum<4> minimum =
      levenberg_marquardt([this](const Eigen::Vector4d& y) { return objective(y); }, start, descent_options());
  if (minimum.convergence == Convergence::not_finite)
    ++estimate.non_finite_starts;
  else
    minima_.push_back(minimum);
}

const Minimum<4>& TargetMotionBatch::best() const {
  return *std::min_element(minima_.begin(), minima_.end(),
                           [](const auto& a, const auto& b) { return a.at.cost < b.at.cost; });
}

void TargetMotionBatch::conclude(const Minimum<4>& minimum, BatchEstimate& estimate) const {
  const Eigen::Matrix4d T =
      ConstantVelocity<2, ContinuousWhiteNoise>{}.F(end_s_ - polar_.origin_s()) * polar_.jacobian(minimum.x);
  estimate.found = true;
  estimate.time_s = end_s_;
  estimate.cost = data(minimum).cost;
  estimate.objective = minimum.at.cost;
  estimate.iterations = minimum.iterations;
  estimate.converged = minimum.convergence == Convergence::converged || minimum.iterations < options_.max_iterations;
  Eigen::Matrix4d information = minimum.at.A;
  // What the data leave open is known by .1 rad/s, .1 / s and 1 / (100 m) and no worse, so that P stays finite.
  information.diagonal() += Eigen::Vector4d(0.0, 1e2, 1e2, 1e4 * polar_.scale() * polar_.scale());
  estimate.P = T * covariance_of(information) * T.transpose();
  estimate.P = 0.5 * (estimate.P + estimate.P.transpose().eval());
  estimate.x = at_end(minimum.x);
}

double TargetMotionBatch::cost_at_infinity(const Eigen::Vector4d& best) const {
  // Frequencies tell a velocity: infinitely far away any change of the bearing would be an infinite one.
  const double rho = doppler_.empty() ? 0.0 : polar_.least_inverse_range();
  const auto at_infinity = [&](Eigen::Vector4d y) {
    y[3] = rho;
    NormalEquations<4> equations = data(y);
    equations.gradient[3] = 0.0;
    equations.A.row(3).setZero();
    equations.A.col(3).setZero();
    return equations;
  };
  const LevenbergMarquardtOptions<4> options = descent_options();
  const auto from = [&](const Eigen::Vector4d& start) {
    const double cost = levenberg_marquardt(at_infinity, start, options).at.cost;
    return std::isfinite(cost) ? cost : std::numeric_limits<double>::infinity();
  };
  const double farthest = from(polar_.start(1.0));
  return doppler_.empty() ? farthest : std::min(farthest, from({best[0], 0.0, 0.0, rho}));
}

BatchEstimate TargetMotionBatch::refine(const Eigen::Vector4d& start, const BearingWindow& window,
                                        const std::optional<BatchPrior>& prior, const DopplerWindow* frequencies) {
  BatchEstimate estimate;
  if (window.size() < 3 || !(window.last_time_s() > window.first_time_s())) return estimate;
  look_at(window, prior, frequencies);
  descend(from_end(start), estimate);
  if (!minima_.empty()) conclude(minima_.front(), estimate);
  return estimate;
}

BatchEstimate TargetMotionBatch::solve(const BearingWindow& window, const std::optional<BatchPrior>& prior,
                                       const Eigen::Vector4d* warm, const DopplerWindow* frequencies) {
  BatchEstimate estimate;
  if (window.size() < 3 || !(window.last_time_s() > window.first_time_s())) return estimate;
  look_at(window, prior, frequencies);
  if (warm) descend(from_end(*warm), estimate);
  for (const double range_m : options_.start_ranges_m) descend(polar_.start(polar_.scale() * range_m), estimate);
  const auto from_ends = [&](double first_m, double last_m) {
    const Eigen::Vector4d x =
        between_ends(window, polar_.scale() * first_m, polar_.scale() * last_m, polar_.origin_s());
    descend(polar_.from_cartesian(x), estimate);
  };
  // Bearings of a target that passed close by are no straight line, nor is a start that takes them for one any good. So
  // where all that was found fits far worse than noise does, a few starts that hold on to the ends.
  const auto fits = [&](const Minimum<4>& minimum) {
    const double m = static_cast<double>(window.size() + doppler_.degrees_of_freedom());
    return 2.0 * minimum.at.cost < m + 6.0 * std::sqrt(2.0 * m);
  };
  if (options_.start_grid) {
    for (int i = 0; i < kChoStarts; ++i) from_ends(1000.0 * (1 + i / kChoRanges), 1000.0 * (1 + i % kChoRanges));
  } else if (std::none_of(minima_.begin(), minima_.end(), fits)) {
    for (const double first_m : {2000.0, 6000.0, 13000.0})
      for (const double last_m : {2000.0, 6000.0, 13000.0}) from_ends(first_m, last_m);
  }
  if (minima_.empty()) return estimate;

  const Minimum<4>& best = this->best();
  conclude(best, estimate);
  const Eigen::Matrix4d T =
      ConstantVelocity<2, ContinuousWhiteNoise>{}.F(end_s_ - polar_.origin_s()) * polar_.jacobian(best.x);
  observability_ = truebearing::observability(data(best).A, best.x, polar_.length_s(), T);
  observability_.against_infinity = 2.0 * (cost_at_infinity(best.x) - estimate.cost);
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
