// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tma/other_explanations.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/chi_square.hpp"
#include "truebearing/tma/residual_checks.hpp"
#include "truebearing/tma/target_motion_batch.hpp"

namespace truebearing {
namespace {

double normalised(const BearingWindow& window, std::size_t i, const BatchEstimate& estimate) {
  return window.residual(i, estimate.x, estimate.time_s) * std::sqrt(window.weight(i));
}

// The bearings of one part.
BearingWindow part(const BearingWindow& window, const std::vector<bool>& of_second, bool second) {
  std::vector<std::size_t> others;
  for (std::size_t i = 0; i < window.size(); ++i)
    if (of_second[i] != second) others.push_back(i);
  return window.without(others);
}

// Of so many bearings, in either part.
std::size_t fewest_of(std::size_t bearings) {
  return std::max<std::size_t>(5, bearings / 10);
}

// One contact and then another is no mixture: that is what a manoeuvre looks like.
bool in_turns(const std::vector<bool>& of_second) {
  int changes = 0;
  for (std::size_t i = 1; i < of_second.size(); ++i) changes += of_second[i] != of_second[i - 1];
  return changes > 2;
}

// From one parting to the next, until none changes its part.
std::optional<TwoContacts> settle(const BearingWindow& window, std::vector<bool> of_second) {
  constexpr int kMostRounds = 12, kParameters = 8;
  constexpr double kConfidence = 0.999;
  const std::size_t m = window.size();
  TwoContacts two;
  two.of_second = std::move(of_second);
  TargetMotionBatch batch;
  for (int round = 0; round < kMostRounds; ++round) {
    for (const int k : {0, 1}) {
      const BearingWindow own = part(window, two.of_second, k == 1);
      two.count[k] = own.size();
      if (own.size() < fewest_of(m)) return std::nullopt;
      two.estimate[k] = batch.solve(own);
      if (!two.estimate[k].found) return std::nullopt;
    }
    two.cost = 0.0;
    bool settled = true;
    for (std::size_t i = 0; i < m; ++i) {
      const double first = normalised(window, i, two.estimate[0]), second = normalised(window, i, two.estimate[1]);
      const bool of_the_second = std::abs(second) < std::abs(first);
      settled = settled && of_the_second == two.of_second[i];
      two.of_second[i] = of_the_second;
      two.cost += 0.5 * std::min(first * first, second * second);
    }
    if (settled) break;
  }
  const double freedom = static_cast<double>(m) - kParameters;
  if (freedom < 1.0 || 2.0 * two.cost > chi_square_quantile(kConfidence, freedom) || !in_turns(two.of_second))
    return std::nullopt;
  return two;
}

}  // namespace

std::optional<TwoContacts> find_two_contacts(const BearingWindow& window, const BatchEstimate& one,
                                             std::span<const Outlier> outliers) {
  const std::size_t m = window.size();
  std::vector<bool> apart(m), to_the_right(m), every_second(m);
  for (const Outlier& outlier : outliers) apart[outlier.at] = true;
  for (std::size_t i = 0; i < m; ++i) {
    to_the_right[i] = normalised(window, i, one) > 0.0;
    every_second[i] = i % 2 == 1;
  }
  if (outliers.size() >= fewest_of(m))
    if (auto two = settle(window, std::move(apart))) return two;
  if (auto two = settle(window, std::move(to_the_right))) return two;
  return settle(window, std::move(every_second));
}

std::optional<BatchEstimate> find_reversed(const BearingWindow& window, const BatchEstimate& one) {
  BearingWindow turned;
  for (std::size_t i = 0; i < window.size(); ++i)
    turned.add(window.time_s(i), window.bearing_rad(i) + kPi, 1.0 / std::sqrt(window.weight(i)), window.site_m(i));
  TargetMotionBatch batch;
  const BatchEstimate estimate = batch.solve(turned);
  const double as_it_is = window.cartesian(one.x, one.time_s).cost;
  if (!estimate.found || !batch.observability().observable() ||
      2.0 * (as_it_is - estimate.cost) < Observability::kRuledOut)
    return std::nullopt;
  // Of two misfits either may be the smaller.
  if (check_residuals(turned, estimate).rest.too_large) return std::nullopt;
  return estimate;
}

}  // namespace truebearing
