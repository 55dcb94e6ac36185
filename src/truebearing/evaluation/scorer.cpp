// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/scorer.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include "truebearing/core/chi_square.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/core/with_count.hpp"
#include "truebearing/evaluation/run_score.hpp"

namespace truebearing {
namespace {

// The difference in the N components that stand at `places` of both lists: its 2-norm, and d' P^-1 d.
struct Distance {
  double norm = 0.0;
  double squared_by_P = 0.0;
};

template <int N>
Distance distance(const BoundedVector& truth, const StepRecord& record, const int* in_truth, const int* in_estimate) {
  constexpr auto n = static_cast<std::size_t>(N);
  // Plain arrays, and by elimination as in mahalanobis_squared(): this is done three times for every step of every
  // tracker.
  double d[n], P[n][n], squares = 0.0, squared_by_P = 0.0;
  bool valid = true;
  for (std::size_t j = 0; j < n; ++j) {
    d[j] = truth[in_truth[j]] - record.x[in_estimate[j]];
    squares += d[j] * d[j];
    for (std::size_t i = j; i < n; ++i) P[i][j] = record.P(in_estimate[i], in_estimate[j]);
  }
#pragma GCC unroll 10
  for (std::size_t k = 0; k < n; ++k) {
    valid &= P[k][k] > 0.0;
    const double inverse = 1.0 / P[k][k];
    squared_by_P += d[k] * d[k] * inverse;
#pragma GCC unroll 10
    for (std::size_t i = k + 1; i < n; ++i) {
      const double factor = P[i][k] * inverse;
      d[i] -= factor * d[k];
#pragma GCC unroll 10
      for (std::size_t j = k + 1; j <= i; ++j) P[i][j] -= factor * P[j][k];
    }
  }
  return {std::sqrt(squares), valid ? squared_by_P : kNaN};
}

Distance distance(const BoundedVector& truth, const StepRecord& record, const std::vector<int>& in_truth,
                  const std::vector<int>& in_estimate) {
  Distance found;
  with_count(static_cast<int>(in_truth.size()), [&]<int N>(std::integral_constant<int, N>) {
    if constexpr (N > 0) found = distance<N>(truth, record, in_truth.data(), in_estimate.data());
  });
  return found;
}

}  // namespace

Scorer::Scorer(const StateSpace& truth, const StateSpace& estimate) : truth_(&truth) {
  const auto add = [&](Places& places, int in_truth) {
    const int in_estimate = estimate.component_index(truth.components[static_cast<std::size_t>(in_truth)]);
    if (in_estimate < 0) return;
    places.truth.push_back(in_truth);
    places.estimate.push_back(in_estimate);
  };
  for (int i = 0; i < truth.size(); ++i) add(all_, i);
  for (const Quantity& quantity : truth.quantities) {
    Places places;
    for (const int index : quantity.indices) add(places, index);
    if (places.truth.size() != quantity.indices.size()) continue;
    quantity_names_.push_back(quantity.name);
    quantities_.push_back(std::move(places));
    scales_.push_back(quantity.scale);
  }
  if (quantities_.empty())
    throw InputError("scoring", "the truth (" + truth.name + ") and a tracker's state (" + estimate.name +
                                    ") have no quantity in common");
  nees95_ = chi_square_quantile(0.95, all_.size());
  for (const Places& places : quantities_) quantity_nees95_.push_back(chi_square_quantile(0.95, places.size()));
}

std::optional<std::size_t> Scorer::quantity(const std::string& name) const {
  const auto found = std::find(quantity_names_.begin(), quantity_names_.end(), name);
  if (found == quantity_names_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - quantity_names_.begin());
}

double Scorer::error(std::size_t quantity, const BoundedVector& truth, const BoundedVector& estimate) const {
  const Places& places = quantities_[quantity];
  BoundedVector d(places.size());
  for (int i = 0; i < places.size(); ++i)
    d[i] = truth[places.truth[static_cast<std::size_t>(i)]] - estimate[places.estimate[static_cast<std::size_t>(i)]];
  return scales_[quantity] * d.norm();
}

double Scorer::true_value(std::size_t quantity, const BoundedVector& truth) const {
  return scales_[quantity] * truth[quantities_[quantity].truth.front()];
}

double Scorer::estimated_value(std::size_t quantity, const BoundedVector& estimate) const {
  return scales_[quantity] * estimate[quantities_[quantity].estimate.front()];
}

void Scorer::prepare(RunScore& score, std::size_t steps, std::size_t targets) const {
  const std::size_t places = targets * steps;
  score.targets = targets;
  score.error.assign(quantities_.size(), std::vector<double>(places, kNaN));
  score.nees.assign(places, kNaN);
  score.quantity_nees.assign(quantities_.size(), std::vector<double>(places, kNaN));
}

void Scorer::score_step(const BoundedVector& truth, const StepRecord& record, std::size_t place,
                        RunScore& score) const {
  for (std::size_t q = 0; q < quantities_.size(); ++q) {
    const Distance off = distance(truth, record, quantities_[q].truth, quantities_[q].estimate);
    score.error[q][place] = scales_[q] * off.norm;
    score.quantity_nees[q][place] = off.squared_by_P;
  }
  score.nees[place] = distance(truth, record, all_.truth, all_.estimate).squared_by_P;
  if (record.correction) {
    ++score.corrected;
    score.gate_sum += record.correction->gate;
    score.gate_limited += record.correction->limited ? 1 : 0;
  }
}

}  // namespace truebearing
