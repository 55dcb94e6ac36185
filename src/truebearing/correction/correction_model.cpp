// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/correction_model.hpp"

#include <fmt/format.h>

#include "truebearing/core/error.hpp"

namespace truebearing {
std::string describe(const Network& network) {
  if (const auto* rules = std::get_if<RuleBase>(&network)) return fmt::format("{} rules", rules->network.rules());
  return fmt::format("{} units", std::get<GatedRecurrent>(network).memory());
}

InputScale input_scale(const Network& network, Eigen::Index input) {
  const auto of = [&](const auto& p) { return InputScale{p.input_mean[input], p.input_scale[input], p.input_clip}; };
  if (const auto* rules = std::get_if<RuleBase>(&network)) return of(rules->network.parameters());
  return of(std::get<GatedRecurrent>(network).parameters());
}

void CorrectionModel::validate() const {
  const auto d = static_cast<Eigen::Index>(design.features.size());
  const Eigen::Index n = space ? space->size() : 0;
  require_valid(n > 0, "state", "has no components", "a state space");
  const int inputs = std::visit([](const auto& kind) { return kind.inputs(); }, network);
  require_valid(inputs == d, "features", fmt::format("{} of them for a network with {} inputs", d, inputs),
                "one feature per input");
  require_valid((design.network == NetworkKind::rules) == std::holds_alternative<RuleBase>(network), "network",
                "is of another kind than the design says", std::string(to_string(design.network)));
  require_valid(!design.base.empty() && !design.reference.empty() && !design.covariance_of.empty(), "trackers",
                "a name is empty", "names of base, reference and covariance_of");
  space_in(design.frame, *space);
  std::visit([&](const auto& kind) { kind.check(design, static_cast<int>(n)); }, network);
  if (gate) {
    require_valid(gate->low.size() == d && gate->high.size() == d && gate->low.allFinite() && gate->high.allFinite() &&
                      (gate->low.array() <= gate->high.array()).all(),
                  "gate", "low and high do not make a box", fmt::format("{} finite numbers each, low <= high", d));
    require_valid(gate->largest_disagreement > 0.0, "gate.largest_disagreement",
                  fmt::format("is {}", gate->largest_disagreement), "a number > 0, or null for none");
    require_valid(gate->disagreement_edge_fraction > 0.0 && gate->disagreement_edge_fraction <= 10.0,
                  "gate.disagreement_edge_fraction", fmt::format("is {}", gate->disagreement_edge_fraction),
                  "a number in (0, 10]");
    require_valid(gate->edge_fraction > 0.0 && gate->edge_fraction <= 10.0, "gate.edge_fraction",
                  fmt::format("is {}", gate->edge_fraction), "a number in (0, 10]");
    const IntervalBox& intervals = gate->intervals;
    require_valid(
        intervals.low_s >= 0.0 && intervals.low_s <= intervals.high_s && intervals.longest_coast_s >= 0.0,
        "gate.intervals",
        fmt::format("are {} to {} s, a coast of {} s", intervals.low_s, intervals.high_s, intervals.longest_coast_s),
        "0 <= low_s <= high_s, longest_coast_s >= 0");
  }
}

}  // namespace truebearing
