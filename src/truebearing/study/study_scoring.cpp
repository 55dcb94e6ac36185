// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/study_scoring.hpp"

#include <algorithm>

#include "truebearing/core/suggestion.hpp"
#include "truebearing/evaluation/metric_registry.hpp"
#include "truebearing/simulation/line_array_scenario.hpp"
#include "truebearing/study/angle_bound_scoring.hpp"

namespace truebearing {
namespace {

// Only a simulated line array tells how loud its targets are; and the bound is of those that stand still.
void check_angle_bound(TableReader& scoring, const NamedScenario& compared) {
  const auto* array = dynamic_cast<const LineArrayScenario*>(compared.scenario);
  if (!array)
    throw scoring.error("angle_bound", "needs signal-to-noise ratios, which " + compared.name + " does not tell",
                        "a scenario of kind \"line_array\"");
  if (array->parameters().moving)
    throw scoring.error("angle_bound",
                        "is of targets that stand still inside an interval, and those of " + compared.name + " move");
}

}  // namespace

StudyScoring read_study_scoring(TableReader scoring, const std::vector<std::string>& trackers, const StateSpace& truth,
                                const std::vector<NamedScenario>& compared) {
  const auto known = [&](const char* key, const std::string& tracker) {
    if (std::find(trackers.begin(), trackers.end(), tracker) == trackers.end())
      throw scoring.error(key, "names no tracker: \"" + tracker + "\"", suggestion(tracker, trackers));
    return tracker;
  };
  StudyScoring read;
  read.rule.from_step = static_cast<int>(scoring.integer_or("from_step", 1, 1, 1000000));
  if (auto thresholds = scoring.table_if_present("loss_thresholds"))
    for (const std::string& quantity : thresholds->keys()) {
      if (truth.quantity_index(quantity) < 0)
        throw thresholds->error(quantity, "is no quantity of the scenario's truth");
      read.rule.loss_thresholds.emplace_back(quantity, thresholds->number(quantity, kPositive));
    }
  if (scoring.has("pairs"))
    for (const std::string& pair : scoring.texts("pairs")) {
      const std::size_t dash = pair.find(" - ");
      if (dash == std::string::npos)
        throw scoring.error("pairs", "holds \"" + pair + "\"", "\"a - b\" with names of trackers");
      read.pairs.emplace_back(known("pairs", pair.substr(0, dash)), known("pairs", pair.substr(dash + 3)));
    }
  read_metrics(scoring, truth, read.rule);
  read.timed = read_timed_scoring(scoring, truth, read.rule);
  read.angle_bound = read_angle_bound(scoring, truth);
  if (read.angle_bound)
    for (const NamedScenario& scenario : compared) check_angle_bound(scoring, scenario);
  if (!read.timed.global_minimum.empty()) known("global_minimum", read.timed.global_minimum);
  if (scoring.has("bounds"))
    for (const std::string& bound : scoring.texts("bounds")) read.bounds.push_back(known("bounds", bound));
  scoring.finish();
  return read;
}

}  // namespace truebearing
