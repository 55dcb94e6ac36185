// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/event_metrics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "truebearing/evaluation/run_score.hpp"
#include "truebearing/evaluation/samples.hpp"

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

class EventTally final : public MetricTally {
 public:
  explicit EventTally(const Scorer& scorer) : has_source_(scorer.truth().component_index("frequency_hz") >= 0) {}

  void add(const RunScore& score) override {
    const auto* run = score.of<EventFigures>();
    if (!run) return;
    any_ |= !run->events.empty();
    jumped_.add(reports(*run, Kind::source_changed, kEver));
    if (!run->turns_at_s) return;
    const double turn_s = *run->turns_at_s;
    falsely_.add(reports(*run, Kind::turn_began, turn_s));
    if (!std::isfinite(turn_s)) return;
    double first_s = kEver;
    for (const TrackEvent& event : run->events)
      if (event.kind == Kind::turn_began && event.time_s >= turn_s) first_s = std::min(first_s, event.time_s);
    found_.add(std::isfinite(first_s));
    if (std::isfinite(first_s)) delay_s_.add(first_s - turn_s);
  }

  void exchange(TallyStream& stream) override {
    stream.any(any_);
    for (Share* share : {&jumped_, &found_, &falsely_}) share->exchange(stream);
    delay_s_.exchange(stream);
  }

  std::vector<Metric> metrics() const override {
    std::vector<Metric> metrics;
    if (!any_) return metrics;
    const auto add = [&](const char* name, const char* unit, Estimate figure) {
      metrics.push_back({name, unit, std::nullopt, figure.value, figure.se});
    };
    if (has_source_) add("source_change_share", "share", jumped_.share());
    if (!found_.empty()) {
      add("turn_delay", "s", delay_s_.mean());
      add("turn_found_share", "share", found_.share());
    }
    if (!falsely_.empty()) add("false_turn_share", "share", falsely_.share());
    return metrics;
  }

 private:
  bool has_source_;
  bool any_ = false;
  Share jumped_, found_, falsely_;
  Samples delay_s_;
};

class EventMetrics final : public MetricFamily {
 public:
  std::unique_ptr<RunFigures> begin(const RunStart& run) const override {
    return std::make_unique<EventRun>(run.recording.truth);
  }

  std::unique_ptr<MetricTally> tally(const ScoringRule&, const Scorer& scorer) const override {
    return std::make_unique<EventTally>(scorer);
  }
};

}  // namespace

std::shared_ptr<const MetricFamily> event_metrics() {
  return std::make_shared<EventMetrics>();
}

}  // namespace truebearing
