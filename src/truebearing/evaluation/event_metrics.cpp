#include "truebearing/evaluation/event_metrics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "truebearing/evaluation/statistics.hpp"

namespace truebearing {
namespace {

using Kind = TrackEvent::Kind;

bool reports(const RunScore& run, Kind kind, double before_s) {
  return std::any_of(run.events.begin(), run.events.end(),
                     [&](const TrackEvent& event) { return event.kind == kind && event.time_s < before_s; });
}

constexpr double kEver = std::numeric_limits<double>::infinity();

}  // namespace

std::vector<Metric> event_metrics(const Scorer& scorer, const std::vector<const RunScore*>& scores) {
  const auto any = [](const RunScore* run) { return !run->events.empty(); };
  if (std::none_of(scores.begin(), scores.end(), any)) return {};

  std::vector<double> jumped, found, falsely, delay_s;
  for (const RunScore* run : scores) {
    jumped.push_back(reports(*run, Kind::source_changed, kEver));
    if (!run->turns_at_s) continue;
    const double turn_s = *run->turns_at_s;
    falsely.push_back(reports(*run, Kind::turn_began, turn_s));
    if (!std::isfinite(turn_s)) continue;
    double first_s = kEver;
    for (const TrackEvent& event : run->events)
      if (event.kind == Kind::turn_began && event.time_s >= turn_s) first_s = std::min(first_s, event.time_s);
    found.push_back(std::isfinite(first_s));
    if (std::isfinite(first_s)) delay_s.push_back(first_s - turn_s);
  }

  std::vector<Metric> metrics;
  const auto add = [&](const char* name, const char* unit, Estimate figure) {
    metrics.push_back({name, unit, std::nullopt, figure.value, figure.se});
  };
  if (scorer.truth().component_index("frequency_hz") >= 0) add("source_change_share", "share", share_of(jumped));
  if (!found.empty()) {
    add("turn_delay", "s", mean_of(delay_s));
    add("turn_found_share", "share", share_of(found));
  }
  if (!falsely.empty()) add("false_turn_share", "share", share_of(falsely));
  return metrics;
}

}  // namespace truebearing
