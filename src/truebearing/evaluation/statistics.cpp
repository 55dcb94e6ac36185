// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/statistics.hpp"

#include <algorithm>
#include <array>
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

struct Around {
  double low = -kInfinity, high = kInfinity;
};

// Between which two values the one of that rank lies, almost surely: by a sample, whose ranks have standard deviations of
// half the root of its size at most. Of few it is between any.
Around around_rank(const std::vector<double>& values, std::size_t rank) {
  constexpr std::size_t kSample = 4096, kDeviation = 32, kOff = 5 * kDeviation;
  if (values.size() < 16 * kSample) return {};
  std::vector<double> sample;
  for (std::size_t i = 0; i < kSample; ++i) sample.push_back(values[i * (values.size() / kSample)]);
  std::sort(sample.begin(), sample.end());
  const std::size_t at = rank * kSample / values.size();
  return {sample[at - std::min(at, kOff)], sample[std::min(at + kOff, kSample - 1)]};
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
  const double a = ones + 0.5, b = count - ones + 0.5;  // of the beta distribution
  return {ones / count, std::sqrt(a * b / (count + 2.0)) / (count + 1.0)};
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

double middle_of(const std::vector<double>& values, std::size_t lower, std::size_t upper) {
  const Around around = around_rank(values, upper);
  std::vector<double> near;
  near.reserve(values.size());
  std::size_t below = 0;
  std::array<double, 256> taken;  // without a branch, which nobody could foretell
  for (std::size_t first = 0; first < values.size(); first += taken.size()) {
    std::size_t count = 0;
    for (std::size_t i = first; i < std::min(first + taken.size(), values.size()); ++i) {
      taken[count] = values[i];
      count += std::size_t{around.low <= values[i]} & std::size_t{values[i] <= around.high};
      below += values[i] < around.low;
    }
    near.insert(near.end(), taken.begin(), taken.begin() + count);
  }
  if (lower < below || upper - below >= near.size()) {
    near = values;
    below = 0;
  }
  const auto at = near.begin() + static_cast<std::ptrdiff_t>(upper - below);
  std::nth_element(near.begin(), at, near.end());
  return lower == upper ? *at : 0.5 * (*at + *std::max_element(near.begin(), at));
}

double median_of(const std::vector<double>& values) {
  return values.empty() ? kNaN : middle_of(values, (values.size() - 1) / 2, values.size() / 2);
}

}  // namespace truebearing
