// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tma/outliers.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "truebearing/core/chi_square.hpp"

namespace truebearing {
namespace {

constexpr std::size_t kNeighbours = 8;
constexpr double kFalseOutliers = 1e-3;  // in a list

double median_of(std::span<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

// Each less the median of those around it; of the nearest where it stands near an end.
void set_off_their_neighbours(std::span<const double> residuals, std::vector<double>& off) {
  off.clear();
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    const std::size_t begin = std::min(i - std::min(i, kNeighbours / 2), residuals.size() - kNeighbours - 1);
    std::array<double, kNeighbours> around;
    for (std::size_t k = 0, j = begin; k < kNeighbours; ++j)
      if (j != i) around[k++] = residuals[j];
    off.push_back(residuals[i] - median_of(around));
  }
}

}  // namespace

std::span<const Outlier> OutlierSearch::operator()(std::span<const double> residuals) {
  outliers_.clear();
  if (residuals.size() <= kNeighbours) return outliers_;
  set_off_their_neighbours(residuals, off_);
  // Of a good one: its own variance, and the median's.
  const double expected = std::sqrt(1.0 + 0.5 * std::numbers::pi / kNeighbours);
  sizes_.clear();
  for (const double value : off_) sizes_.push_back(std::abs(value));
  const double usual = median_of(sizes_) / normal_quantile(0.75);
  const double limit =
      std::max(expected, usual) * normal_quantile(1.0 - 0.5 * kFalseOutliers / static_cast<double>(residuals.size()));
  for (std::size_t i = 0; i < off_.size(); ++i)
    if (std::abs(off_[i]) > limit) outliers_.push_back({i, off_[i]});
  return outliers_;
}

std::span<const Outlier> OutlierSearch::operator()(const BearingWindow& window, const BatchEstimate& estimate) {
  residuals_.clear();
  for (std::size_t i = 0; i < window.size(); ++i)
    residuals_.push_back(window.residual(i, estimate.x, estimate.time_s) * std::sqrt(window.weight(i)));
  return (*this)(residuals_);
}

std::vector<std::size_t> places(std::span<const Outlier> outliers) {
  std::vector<std::size_t> places;
  for (const Outlier& outlier : outliers) places.push_back(outlier.at);
  return places;
}

}  // namespace truebearing
