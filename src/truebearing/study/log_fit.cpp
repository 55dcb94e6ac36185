// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/log_fit.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <limits>
#include <optional>
#include <toml++/toml.h>
#include <vector>

namespace truebearing {
namespace {

// What a tracker's table, with the tables in it, says of times and starts.
struct Beginning {
  std::vector<double> waits_until_s;  // before these it gives nothing
  bool prior = false;
  bool two_points = false;
  bool guess = false;

  void read(const toml::table& table) {
    for (const auto& [key, node] : table) {
      if (key == "solve_at_s" || key == "hand_over_s") take_times(node);
      if (key == "guess") guess |= node.value_or(false);
      const toml::table* inner = node.as_table();
      if (!inner) continue;
      const std::string kind = (*inner)["kind"].value_or<std::string>("prior");
      prior |= key == "start" && kind == "prior";
      two_points |= key == "start" && kind == "two_point";
      read(*inner);
    }
  }

 private:
  void take_times(const toml::node& node) {
    if (const auto time_s = node.value<double>()) waits_until_s.push_back(*time_s);
    if (const toml::array* times = node.as_array())
      for (const toml::node& time : *times)
        if (const auto time_s = time.value<double>()) waits_until_s.push_back(*time_s);
  }
};

std::vector<Measurement> scenario_measurements(const Study& study) {
  return study.scenario().simulate({study.seed(), Role::evaluation, 0}).measurements;
}

// Of the times of which the study speaks.
std::optional<double> last_time_s(const Study& study) {
  Beginning all;
  for (const TrackerSpec& spec : study.trackers()) all.read(*spec.configuration);
  std::vector<double> times_s = all.waits_until_s;
  if (times_s.empty()) times_s = study.scoring().times_s;
  if (!times_s.empty()) return *std::max_element(times_s.begin(), times_s.end());
  if (!all.prior) return std::nullopt;
  return scenario_measurements(study).back().time_s;
}

}  // namespace

double study_epoch_s(const Study& study, double first_time_s) {
  const std::optional<double> last_s = last_time_s(study);
  if (!last_s || !(first_time_s > *last_s)) return 0.0;
  return first_time_s - scenario_measurements(study).front().time_s;
}

std::string why_no_track(const Study& study, const std::string& tracker, const LogContents& log) {
  const TrackerSpec& spec = study.tracker(tracker);
  Beginning beginning;
  const std::string& beginner = spec.correction ? spec.correction->design.base
                                : spec.smoother ? spec.smoother->of
                                                : tracker;
  beginning.read(*study.tracker(beginner).configuration);
  if (log.missing == log.measurements) return "the log has no usable measurement";
  if (beginning.guess && !log.guess)
    return "its start needs a guess of the range, and the log has none (guess_range_m, guess_range_sigma_m)";
  if (beginning.two_points && log.measurements - log.missing < 2) return "its start takes two measurements";
  if (!beginning.waits_until_s.empty()) {
    const double first_s =
        *std::min_element(beginning.waits_until_s.begin(), beginning.waits_until_s.end()) + log.epoch_s;
    if (first_s > log.last_time_s)
      return fmt::format("it waits until {:.10g} s, and the log ends at {:.10g} s", first_s, log.last_time_s);
    return "what was measured until the times at which it is solved did not determine it";
  }
  return "no measurement of the log began it";
}

}  // namespace truebearing
