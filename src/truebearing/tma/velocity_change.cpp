// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tma/velocity_change.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "truebearing/core/linear_algebra.hpp"
#include "truebearing/motion/constant_velocity.hpp"
#include "truebearing/tma/levenberg_marquardt.hpp"

namespace truebearing {
namespace {

// g' S^-1 g without the directions in which S is nothing but rounding: there a change would look like no change.
double quadratic_form(const Eigen::Vector2d& g, const Eigen::Matrix2d& S, double whole) {
  const SymmetricModes<2> modes = symmetric_modes(S);
  double sum = 0.0;
  for (int i = 0; i < 2; ++i) {
    const double projected = modes.vectors.col(i).dot(g);
    if (modes.values[i] > 1e-9 * whole) sum += projected * projected / modes.values[i];
  }
  return sum;
}

double score(const NormalEquations<6>& equations) {
  const Eigen::Matrix4d P = inverse_of_what_is_known(equations.A.topLeftCorner<4, 4>());
  const Eigen::Matrix<double, 2, 4> GJ = equations.A.bottomLeftCorner<2, 4>();
  const Eigen::Matrix2d GG = equations.A.bottomRightCorner<2, 2>();
  return quadratic_form(equations.gradient.tail<2>() - GJ * P * equations.gradient.head<4>(),
                        GG - GJ * P * GJ.transpose(), GG.trace());
}

}  // namespace

BatchEstimate VelocityChange::before(double at_s) const {
  BatchEstimate steady;
  steady.found = true;
  steady.time_s = at_s;
  steady.x = x;
  // x holds at end_s.
  steady.x.head<2>() += (at_s - end_s) * x.tail<2>() + (time_s - at_s) * change_mps;
  steady.x.tail<2>() -= change_mps;
  steady.cost = cost;
  return steady;
}

VelocityChangeScan::VelocityChangeScan(const BearingWindow& bearings, const DopplerWindow* frequencies,
                                       const BatchEstimate& least_squares)
    : bearings_(bearings), rows_(bearings, frequencies), tried_(bearings, frequencies) {
  y_ = polar_of(least_squares, rows_.polar());
  rows_.look_at(y_);
  // On either side enough bearings are left to tell a velocity.
  constexpr std::size_t kMargin = 3, kFewest = 12;  // of fewer in all an outlier explains as much
  if (bearings.size() < kFewest) return;
  const std::size_t step = std::max<std::size_t>(1, (bearings.size() + kMostTimes - 1) / kMostTimes);
  for (std::size_t i = kMargin; i + kMargin < bearings.size(); i += step) times_.push_back(i);
}

double VelocityChangeScan::threshold(double by_chance) const {
  return -2.0 * std::log(by_chance / static_cast<double>(times_.size()));
}

VelocityChangeScan::Score VelocityChangeScan::largest_score() const {
  Score largest;
  for (const std::size_t bearing : times_) {
    const double time_s = bearings_.time_s(bearing), statistic = score(rows_.equations(time_s));
    if (statistic > largest.statistic) largest = {statistic, time_s};
  }
  return largest;
}

VelocityChangeScan::Fit VelocityChangeScan::fit_at(std::size_t bearing, const State& start) {
  const double change_s = bearings_.time_s(bearing);
  LevenbergMarquardtOptions<6> options;
  options.max_iterations = 40;
  options.cost_tolerance = 1e-4;
  options.least_curvature << 1e-6, 1e-2, 1e-2, 1e-2, 1e-9, 1e-9;
  options.lower[3] = tried_.polar().least_inverse_range();
  const auto problem = [&](const State& state) {
    tried_.look_at(state.head<4>(), state.tail<2>(), change_s);
    NormalEquations<6> equations = tried_.equations(change_s);
    if (state[3] > tried_.polar().largest_inverse_range()) equations.cost = std::numeric_limits<double>::infinity();
    return equations;
  };
  const Minimum<6> minimum = levenberg_marquardt(problem, start, options);
  const bool found = minimum.convergence != Convergence::not_finite;
  return {bearing, minimum.x, found ? minimum.at.cost : std::numeric_limits<double>::infinity()};
}

VelocityChangeScan::Fit VelocityChangeScan::better_at(std::size_t bearing, const State& neighbour) {
  State steady = State::Zero();
  steady.head<4>() = y_;
  const Fit one = fit_at(bearing, steady), other = fit_at(bearing, neighbour);
  return one.cost < other.cost ? one : other;
}

VelocityChange VelocityChangeScan::fit() {
  constexpr double kWithin95 = 0.5 * 3.84;
  const auto cheaper = [](const Fit& a, const Fit& b) { return a.cost < b.cost; };
  std::vector<Fit> fits;
  State neighbour = State::Zero();
  neighbour.head<4>() = y_;
  for (const std::size_t bearing : times_) {
    fits.push_back(better_at(bearing, neighbour));
    neighbour = fits.back().state;
  }
  Fit best = *std::min_element(fits.begin(), fits.end(), cheaper);
  // To the bearing, by halves.
  for (std::size_t step = times_.size() > 1 ? times_[1] - times_[0] : 1; step > 1;) {
    step = (step + 1) / 2;
    for (const bool earlier : {true, false}) {
      if (earlier && best.at < times_.front() + step) continue;
      const std::size_t bearing = earlier ? best.at - step : best.at + step;
      if (bearing > times_.back()) continue;
      fits.push_back(fit_at(bearing, best.state));
    }
    best = *std::min_element(fits.begin(), fits.end(), cheaper);
  }
  VelocityChange change = conclude(best);
  std::sort(fits.begin(), fits.end(), [](const Fit& a, const Fit& b) { return a.at < b.at; });
  const auto likely = [&](const Fit& fit) { return fit.cost < best.cost + kWithin95; };
  const auto first = std::find_if(fits.begin(), fits.end(), likely);
  const auto last = std::find_if(fits.rbegin(), fits.rend(), likely);
  change.earliest_s = bearings_.time_s(first == fits.begin() ? first->at : std::prev(first)->at);
  change.latest_s = bearings_.time_s(last == fits.rbegin() ? last->at : std::prev(last)->at);
  return change;
}

VelocityChange VelocityChangeScan::conclude(const Fit& best) {
  const ModifiedPolar& polar = tried_.polar();
  const double change_s = bearings_.time_s(best.at), end_s = bearings_.last_time_s();
  const Eigen::Vector4d y = best.state.head<4>();
  const Eigen::Vector2d dv_mps = best.state.tail<2>();
  tried_.look_at(y, dv_mps, change_s);
  NormalEquations<6> equations = tried_.equations(change_s);
  // As in a batch estimate, what the data leave open stays finite.
  equations.A.diagonal() += (State() << 0.0, 1e2, 1e2, 1e4 * polar.scale() * polar.scale(), 1e-6, 1e-6).finished();
  Eigen::Matrix<double, 6, 6> covariance;
  for (int i = 0; i < 6; ++i) covariance.col(i) = solve_positive<6>(equations.A, State::Unit(i));

  const Eigen::Matrix4d F = ConstantVelocity<2, ContinuousWhiteNoise>{}.F(end_s - polar.origin_s());
  Eigen::Matrix<double, 4, 6> T;
  T << F * polar.jacobian(y),
      (Eigen::Matrix<double, 4, 2>() << (end_s - change_s) * Eigen::Matrix2d::Identity(), Eigen::Matrix2d::Identity())
          .finished();
  VelocityChange change;
  change.time_s = change_s;
  change.end_s = end_s;
  change.change_mps = dv_mps;
  change.cost = best.cost;
  change.x = F * polar.to_cartesian(y);
  change.x.head<2>() += (end_s - change_s) * dv_mps;
  change.x.tail<2>() += dv_mps;
  change.P = T * covariance * T.transpose();
  change.P = 0.5 * (change.P + change.P.transpose().eval());
  return change;
}

}  // namespace truebearing
