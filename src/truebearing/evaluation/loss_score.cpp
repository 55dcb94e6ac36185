// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/loss_score.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "truebearing/core/constants.hpp"

namespace truebearing {

double loss_score(const RunScore& score, const Scorer& scorer, const ScoringRule& rule) {
  double largest = 0.0;
  for (const auto& [name, threshold] : rule.loss_thresholds) {
    const std::optional<std::size_t> q = scorer.quantity(name);
    if (!q) continue;
    for (std::size_t target = 0; target < score.targets; ++target) {
      const std::span errors = std::span(score.error[*q]).subspan(target * score.steps(), score.steps());
      const auto last = std::find_if(errors.rbegin(), errors.rend(), [](double e) { return !std::isnan(e); });
      largest = std::max(largest, last == errors.rend() ? kInfinity : *last / threshold);
    }
  }
  return largest;
}

}  // namespace truebearing
