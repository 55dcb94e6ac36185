// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/scorer.hpp"

#include <algorithm>
#include <utility>

#include "truebearing/core/constants.hpp"
#include "truebearing/core/covariance.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/evaluation/run_score.hpp"

namespace truebearing {
namespace {}  // namespace

Scorer::Scorer(const StateSpace& truth, const StateSpace& estimate) : truth_(&truth) {
  std::vector<int> place_of(truth.components.size(), -1);
  for (int i = 0; i < truth.size(); ++i) {
    const int in_estimate = estimate.component_index(truth.components[static_cast<std::size_t>(i)]);
    if (in_estimate < 0) continue;
    place_of[static_cast<std::size_t>(i)] = static_cast<int>(truth_index_.size());
    truth_index_.push_back(i);
    estimate_index_.push_back(in_estimate);
  }
  for (const Quantity& quantity : truth.quantities) {
    std::vector<int> places;
    for (const int index : quantity.indices)
      if (place_of[static_cast<std::size_t>(index)] >= 0) places.push_back(place_of[static_cast<std::size_t>(index)]);
    if (places.size() != quantity.indices.size()) continue;
    quantity_names_.push_back(quantity.name);
    quantities_.push_back(std::move(places));
    scales_.push_back(quantity.scale);
  }
  if (quantities_.empty())
    throw InputError("scoring", "the truth (" + truth.name + ") and a tracker's state (" + estimate.name +
                                    ") have no quantity in common");
}

std::optional<std::size_t> Scorer::quantity(const std::string& name) const {
  const auto found = std::find(quantity_names_.begin(), quantity_names_.end(), name);
  if (found == quantity_names_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - quantity_names_.begin());
}

BoundedVector Scorer::difference(const BoundedVector& truth, const BoundedVector& estimate) const {
  return truth(truth_index_) - estimate(estimate_index_);
}

double Scorer::error(std::size_t quantity, const BoundedVector& truth, const BoundedVector& estimate) const {
  return scales_[quantity] * difference(truth, estimate)(quantities_[quantity]).norm();
}

double Scorer::true_value(std::size_t quantity, const BoundedVector& truth) const {
  return scales_[quantity] * truth[truth_index_[static_cast<std::size_t>(quantities_[quantity].front())]];
}

double Scorer::estimated_value(std::size_t quantity, const BoundedVector& estimate) const {
  return scales_[quantity] * estimate[estimate_index_[static_cast<std::size_t>(quantities_[quantity].front())]];
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
  const BoundedVector d = difference(truth, record.x);
  const BoundedMatrix P = record.P(estimate_index_, estimate_index_);
  for (std::size_t q = 0; q < quantities_.size(); ++q) {
    const BoundedVector part = d(quantities_[q]);
    score.error[q][place] = scales_[q] * part.norm();
    score.quantity_nees[q][place] = mahalanobis_squared(BoundedMatrix(P(quantities_[q], quantities_[q])), part);
  }
  score.nees[place] = mahalanobis_squared(P, d);
  if (record.correction) {
    ++score.corrected;
    score.gate_sum += record.correction->gate;
    score.gate_limited += record.correction->limited ? 1 : 0;
  }
}

}  // namespace truebearing
