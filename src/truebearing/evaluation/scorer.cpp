// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/scorer.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <type_traits>
#include <utility>

#include "truebearing/core/chi_square.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/core/with_count.hpp"
#include "truebearing/evaluation/run_score.hpp"

namespace truebearing {

Scorer::Scorer(const StateSpace& truth, const StateSpace& estimate) : truth_(&truth) {
  const auto add = [&](Places& places, int in_truth) {
    const int in_estimate = estimate.component_index(truth.components[static_cast<std::size_t>(in_truth)]);
    if (in_estimate < 0) return;
    places.truth.push_back(in_truth);
    places.estimate.push_back(in_estimate);
    const auto in_all = std::find(all_.truth.begin(), all_.truth.end(), in_truth);
    places.among_all.push_back(static_cast<int>(in_all - all_.truth.begin()));
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
  score.nees.assign(places, kNaN);
  for (std::vector<std::vector<double>>* const figures : {&score.error, &score.quantity_nees}) {
    figures->resize(quantities_.size());
    for (std::vector<double>& of_quantity : *figures) of_quantity.assign(places, kNaN);
  }
}

void Scorer::score_step(const BoundedVector& truth, const StepRecord& record, std::size_t place, StepColumns& columns,
                        RunScore& score) const {
  const int lane = columns.steps++;
  columns.place[static_cast<std::size_t>(lane)] = place;
  const int *in_truth = all_.truth.data(), *in_estimate = all_.estimate.data();
  with_count(all_.size(), [&]<int N>(std::integral_constant<int, N>) {
    for (int j = 0; j < N; ++j) {
      columns.d(j)[lane] = truth[in_truth[j]] - record.x[in_estimate[j]];
      for (int i = j; i < N; ++i) columns.P(i, j)[lane] = record.P(in_estimate[i], in_estimate[j]);
    }
  });
  if (columns.steps == StepColumns::kSteps) score_together(columns, score);
  if (record.correction) {
    ++score.corrected;
    score.gate_sum += record.correction->gate;
    score.gate_limited += record.correction->limited ? 1 : 0;
  }
}

void Scorer::score_together(StepColumns& columns, RunScore& score) const {
  const std::span places(columns.place.data(), static_cast<std::size_t>(std::exchange(columns.steps, 0)));
  StepDistances off;
  for (std::size_t q = 0; q < quantities_.size(); ++q) {
    kernels::distances(columns, quantities_[q].among_all.data(), quantities_[q].size(), off);
    for (std::size_t lane = 0; lane < places.size(); ++lane) {
      score.error[q][places[lane]] = scales_[q] * off.norm[lane];
      score.quantity_nees[q][places[lane]] = off.squared_by_P[lane];
    }
  }
  kernels::distances(columns, all_.among_all.data(), all_.size(), off);
  for (std::size_t lane = 0; lane < places.size(); ++lane) score.nees[places[lane]] = off.squared_by_P[lane];
}

}  // namespace truebearing
