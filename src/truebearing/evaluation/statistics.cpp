// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "truebearing/core/constants.hpp"

namespace truebearing {
namespace {

double jackknife_se(const std::vector<double>& left_out) {
  const double n = static_cast<double>(left_out.size());
  if (n < 2.0) return kNaN;
  double mean = 0.0;
  for (const double value : left_out) mean += value / n;
  double squares = 0.0;
  for (const double value : left_out) squares += (value - mean) * (value - mean);
  return std::sqrt((n - 1.0) / n * squares);
}

Estimate pooled(const std::vector<SquaredErrors>& runs, double (*figure)(const SquaredErrors&)) {
  // What is left without a run is summed from both ends: a run that diverged by many orders of magnitude cannot be
  // taken from a sum again.
  std::vector<SquaredErrors> after(runs.size() + 1);
  for (std::size_t i = runs.size(); i-- > 0;) {
    after[i] = after[i + 1];
    after[i].add(runs[i]);
  }
  std::vector<double> left_out;
  SquaredErrors before;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    SquaredErrors rest = before;
    rest.add(after[i + 1]);
    if (runs[i].count > 0.0 && rest.count > 0.0) left_out.push_back(figure(rest));
    before.add(runs[i]);
  }
  return {figure(before), jackknife_se(left_out)};
}

}  // namespace

double root_mean(const SquaredErrors& errors) {
  return errors.count > 0.0 ? std::sqrt(errors.sum / errors.count) : kNaN;
}

double mean_square(const SquaredErrors& errors) {
  return errors.count > 0.0 ? errors.sum / errors.count : kNaN;
}

Estimate pooled_rmse(const std::vector<SquaredErrors>& runs) {
  return pooled(runs, root_mean);
}

Estimate rmse_of(const std::vector<double>& errors) {
  std::vector<SquaredErrors> runs;
  for (const double error : errors) runs.emplace_back().add(error);
  return pooled_rmse(runs);
}

Estimate pooled_mse(const std::vector<SquaredErrors>& runs) {
  return pooled(runs, mean_square);
}

Estimate mean_of(const std::vector<double>& values) {
  const double n = static_cast<double>(values.size());
  if (values.empty()) return {kNaN, kNaN};
  double mean = 0.0;
  for (const double value : values) mean += value / n;
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return {mean, n > 1.0 ? std::sqrt(squares / (n - 1.0) / n) : kNaN};
}

Estimate share_of(const std::vector<double>& values) {
  return share_of(std::accumulate(values.begin(), values.end(), 0.0), static_cast<double>(values.size()));
}

Estimate share_of(double ones, double count) {
  if (count == 0.0) return {kNaN, kNaN};
  const double p = ones / count;
  return {p, std::sqrt(p * (1.0 - p) / count)};
}

Estimate standard_deviation_of(const std::vector<double>& values) {
  const double n = static_cast<double>(values.size()), mean = mean_of(values).value;
  if (n < 2.0) return {kNaN, kNaN};
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  std::vector<double> left_out;
  if (n > 2.0)
    for (const double value : values) {
      // Without this value the sum of squares about the new mean is smaller by n / (n - 1) of its own square.
      const double rest = squares - n / (n - 1.0) * (value - mean) * (value - mean);
      left_out.push_back(std::sqrt(std::max(rest, 0.0) / (n - 2.0)));
    }
  return {std::sqrt(squares / (n - 1.0)), jackknife_se(left_out)};
}

double median_of(std::vector<double> values) {
  if (values.empty()) return kNaN;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

}  // namespace truebearing
