// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tma/residual_checks.hpp"

#include <algorithm>
#include <cmath>

#include "truebearing/core/chi_square.hpp"
#include "truebearing/motion/constant_velocity.hpp"
#include "truebearing/tma/motion_rows.hpp"
#include "truebearing/tma/outlier_deletion.hpp"
#include "truebearing/tma/target_motion_batch.hpp"

namespace truebearing {
namespace {

constexpr double kByChance = 1e-3;
constexpr int kParameters = 4;

int degrees_of_freedom(std::size_t bearings, const DopplerWindow* frequencies) {
  const int m = static_cast<int>(bearings);
  return frequencies ? m + static_cast<int>(frequencies->size()) - kParameters - frequencies->levels()
                     : m - kParameters;
}

// Sum of squares of all rows, about an estimate of any kind.
double sum_of_squares(const BearingWindow& window, const BatchEstimate& estimate, const DopplerWindow* frequencies) {
  double sum = 2.0 * window.cartesian(estimate.x, estimate.time_s).cost;
  if (!frequencies) return sum;
  std::vector<SourceFrequency> sources;
  frequencies->sources(estimate.x, estimate.time_s, sources);
  for (std::size_t i = 0; i < frequencies->size(); ++i) {
    const double f0 = sources[static_cast<std::size_t>(frequencies->level(i))].frequency_hz;
    const double e_hz = frequencies->frequency_hz(i) - f0 * frequencies->shift(i, estimate.x, estimate.time_s).value;
    sum += frequencies->weight(i) * e_hz * e_hz;
  }
  return sum;
}

// The least squares of the bearings that are no outliers.
BearingWindow leave_out_outliers(const BearingWindow& window, const BatchEstimate& estimate,
                                 const DopplerWindow* frequencies, ResidualChecks& checks) {
  checks.outliers = OutlierDeletion(window, frequencies).find(estimate);
  BearingWindow rest = window.without(places(checks.outliers));
  checks.least_squares = estimate;
  const BatchEstimate better = TargetMotionBatch().solve(rest, std::nullopt, &estimate.x, frequencies);
  if (better.found) checks.least_squares = better;
  return rest;
}

void check_whiteness(const MotionRows& rows, ResidualChecks& checks) {
  constexpr double kRounding = 1e-12;  // of a sum of squares per residual: a millionth of sigma
  double products = 0.0, squares = 0.0;
  for (const std::span<const MotionRow> kind : {rows.bearings(), rows.frequencies()}) {
    double previous = 0.0;
    for (const MotionRow& row : kind) {
      products += row.residual * previous;
      squares += row.residual * row.residual;
      previous = row.residual;
    }
  }
  const double count = static_cast<double>(rows.all().size());
  checks.lag_one =
      squares > kRounding * count ? products / squares * std::sqrt(count) : std::numeric_limits<double>::quiet_NaN();
  checks.white = !(std::abs(checks.lag_one) > normal_quantile(1.0 - 0.5 * kByChance));
}

// What is left of each degree of freedom, no less than the noise is said to be.
double noise_variance(double chi_square, int degrees_of_freedom) {
  return std::max(1.0, chi_square / std::max(degrees_of_freedom, 1));
}

void look_for_a_change(VelocityChangeScan& scan, ResidualChecks& checks) {
  constexpr double kWorthALook = 0.05;  // the chance that a steady target is fitted with a change at all
  if (scan.times() == 0) return;
  const VelocityChangeScan::Score largest = scan.largest_score();
  const double chi_square = 2.0 * checks.least_squares.cost;
  const auto in_units_of_noise = [&](double statistic) {
    return statistic / noise_variance(chi_square - statistic, checks.rest.degrees_of_freedom - 2);
  };
  checks.manoeuvre = in_units_of_noise(largest.statistic);
  checks.manoeuvre_s = largest.time_s;
  if (!checks.rest.too_large && largest.statistic < scan.threshold(kWorthALook)) return;
  const VelocityChange change = scan.fit();
  if (!std::isfinite(change.cost)) return;
  checks.manoeuvre = in_units_of_noise(chi_square - 2.0 * change.cost);
  checks.manoeuvre_s = change.time_s;
  checks.manoeuvred = checks.manoeuvre > scan.threshold(kByChance);
  if (checks.manoeuvred) checks.change = change;
}

// The least squares where this is taken off all bearings.
BatchEstimate estimate_without(double bias_rad, const BearingWindow& window, const DopplerWindow* frequencies,
                               const BatchEstimate& start, BearingWindow& turned) {
  turned.clear();
  for (std::size_t i = 0; i < window.size(); ++i)
    turned.add(window.time_s(i), window.bearing_rad(i) - bias_rad, 1.0 / std::sqrt(window.weight(i)), window.site_m(i));
  return TargetMotionBatch().solve(turned, std::nullopt, &start.x, frequencies);
}

// To first order about an estimate that `rows` look at.
BearingBias bias_about(const MotionRows& rows, const BatchEstimate& estimate) {
  const auto of_bias = [](const MotionRow& row) {
    Eigen::Matrix<double, 1, 5> j;
    j << row.of_y, row.level < 0 ? row.per_unit : 0.0;
    return j;
  };
  const NormalEquations<5> equations = rows.equations<5>(of_bias);
  const Eigen::Matrix4d P = inverse_of_what_is_known(equations.A.topLeftCorner<4, 4>());
  const Eigen::Vector4d coupling = equations.A.topRightCorner<4, 1>(), taken = P * coupling;
  const double information = equations.A(4, 4) - coupling.dot(taken);
  const ModifiedPolar& polar = rows.polar();
  BearingBias bias;
  bias.moves = ConstantVelocity<2, ContinuousWhiteNoise>{}.F(estimate.time_s - polar.origin_s()) *
               polar.jacobian(polar_of(estimate, polar)) * taken;
  if (!(information > 1e-9 * equations.A(4, 4))) return bias;
  bias.sigma_rad = 1.0 / std::sqrt(information);
  bias.bias_rad = (equations.gradient(4) - taken.dot(equations.gradient.head<4>())) / information;
  return bias;
}

// The error and the motion that together leave least: a few steps, each about what the last one ended at.
void fit_a_bias(const BearingWindow& window, const DopplerWindow* frequencies, BearingBias& bias) {
  constexpr int kMostSteps = 6;
  constexpr double kNoMore = 0.01;  // of a standard deviation
  BearingWindow turned;
  for (int step = 0; step < kMostSteps; ++step) {
    BatchEstimate better = estimate_without(bias.bias_rad, window, frequencies, bias.estimate, turned);
    if (!better.found) return;
    MotionRows rows(turned, frequencies);
    rows.look_at(polar_of(better, rows.polar()));
    const BearingBias rest = bias_about(rows, better);
    bias.estimate = better;
    bias.estimate.P += rest.moves * rest.moves.transpose() * rest.sigma_rad * rest.sigma_rad;
    if (!std::isfinite(rest.sigma_rad)) return;
    bias.sigma_rad = rest.sigma_rad;
    if (std::abs(rest.bias_rad) < kNoMore * rest.sigma_rad) return;
    bias.bias_rad += rest.bias_rad;
  }
}

void look_for_a_bias(const MotionRows& rows, const BearingWindow& window, const DopplerWindow* frequencies,
                     ResidualChecks& checks) {
  BearingBias& bias = checks.bias;
  bias = bias_about(rows, checks.least_squares);
  if (!std::isfinite(bias.sigma_rad)) return;
  const auto in_units_of_noise = [&](double statistic) {
    return statistic / noise_variance(checks.rest.chi_square - statistic, checks.rest.degrees_of_freedom - 1);
  };
  const double seen = chi_square_quantile(1.0 - kByChance, 1.0), sigmas = bias.bias_rad / bias.sigma_rad;
  if (in_units_of_noise(sigmas * sigmas) <= seen) return;
  // What the first order promises has to be there.
  BearingWindow turned;
  const BatchEstimate better = estimate_without(bias.bias_rad, window, frequencies, checks.least_squares, turned);
  bias.detected = better.found && in_units_of_noise(2.0 * (checks.least_squares.cost - better.cost)) > seen;
  if (!bias.detected) return;
  bias.estimate = better;
  fit_a_bias(window, frequencies, bias);
  bias.gain = in_units_of_noise(2.0 * (checks.least_squares.cost - bias.estimate.cost));
}

// Of residuals that a few parameters took a part of: by the share of their variance that was left to them.
double sigmas_of(std::span<const MotionRow> rows, std::span<const double> leverages) {
  double squares = 0.0, freedom = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    squares += rows[i].residual * rows[i].residual;
    freedom += 1.0 - leverages[i];
  }
  return freedom > 0.5 ? std::sqrt(squares / freedom) : std::numeric_limits<double>::quiet_NaN();
}

void find_the_sigmas_that_fit(VelocityChangeScan& scan, ResidualChecks& checks) {
  const MotionRows& rows = scan.rows();
  const Eigen::Matrix4d A = rows.equations<4>([](const MotionRow& row) { return row.of_y; }).A;
  const std::vector<double> leverages = rows.leverages(inverse_of_what_is_known(A));
  const std::span<const MotionRow> left = checks.change ? scan.rows_of_the_fit().all() : rows.all();
  const std::size_t m = rows.bearings().size();
  checks.bearing_sigmas = sigmas_of(left.first(m), std::span(leverages).first(m));
  checks.frequency_sigmas = sigmas_of(left.subspan(m), std::span(leverages).subspan(m));
}

}  // namespace

SumOfSquares::SumOfSquares(double sum, int freedom)
    : chi_square(sum),
      degrees_of_freedom(freedom),
      too_large(!(sum <= chi_square_quantile(1.0 - kByChance, std::max(freedom, 1)))),
      too_small(sum < chi_square_quantile(kByChance, std::max(freedom, 1))) {}

ResidualChecks check_residuals(const BearingWindow& window, const BatchEstimate& estimate,
                               const DopplerWindow* frequencies) {
  ResidualChecks checks;
  const SumOfSquares all(sum_of_squares(window, estimate, frequencies), degrees_of_freedom(window.size(), frequencies));
  checks.chi_square = all.chi_square;
  checks.degrees_of_freedom = all.degrees_of_freedom;
  checks.fits = all.fits();
  checks.too_small = all.too_small;

  const BearingWindow rest = leave_out_outliers(window, estimate, frequencies, checks);
  checks.rest = SumOfSquares(2.0 * checks.least_squares.cost, degrees_of_freedom(rest.size(), frequencies));
  VelocityChangeScan scan(rest, frequencies, checks.least_squares);
  check_whiteness(scan.rows(), checks);
  look_for_a_change(scan, checks);
  look_for_a_bias(scan.rows(), rest, frequencies, checks);
  find_the_sigmas_that_fit(scan, checks);
  return checks;
}

}  // namespace truebearing
