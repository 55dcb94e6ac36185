#include "truebearing/evaluation/event_metrics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "truebearing/evaluation/run_score.hpp"
#include "truebearing/evaluation/statistics.hpp"

namespace truebearing {
namespace {

using Kind = TrackEvent::Kind;

constexpr double kEver = std::numeric_limits<double>::infinity();

bool reports(const EventFigures& run, Kind kind, double before_s) {
  return std::any_of(run.events.begin(), run.events.end(),
                     [&](const TrackEvent& event) { return event.kind == kind && event.time_s < before_s; });
}

class EventRun final : public EventFigures {
 public:
  explicit EventRun(const std::vector<Truth>& truth) {
    if (truth.size() == 1) turns_at_s = truth.front().turns_at_s;
  }
  void end(std::span<const TrackEvent> reported) override { events.assign(reported.begin(), reported.end()); }
};

class EventMetrics final : public MetricFamily {
 public:
  std::unique_ptr<RunFigures> begin(const RunStart& run) const override {
    return std::make_unique<EventRun>(run.recording.truth);
  }

  std::vector<Metric> finish(const TrackerRuns& tracker) const override {
    std::vector<const EventFigures*> runs;
    for (const RunScore* score : tracker.scores)
      if (const auto* run = score->of<EventFigures>()) runs.push_back(run);
    if (std::none_of(runs.begin(), runs.end(), [](const EventFigures* run) { return !run->events.empty(); })) return {};

    std::vector<double> jumped, found, falsely, delay_s;
    for (const EventFigures* run : runs) {
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
    if (tracker.scorer.truth().component_index("frequency_hz") >= 0)
      add("source_change_share", "share", share_of(jumped));
    if (!found.empty()) {
      add("turn_delay", "s", mean_of(delay_s));
      add("turn_found_share", "share", share_of(found));
    }
    if (!falsely.empty()) add("false_turn_share", "share", share_of(falsely));
    return metrics;
  }
};

}  // namespace

std::shared_ptr<const MetricFamily> event_metrics() {
  return std::make_shared<EventMetrics>();
}

}  // namespace truebearing
