// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/target_motion_metrics.hpp"

#include <algorithm>
#include <cmath>

#include "truebearing/core/error.hpp"
#include "truebearing/evaluation/run_score.hpp"
#include "truebearing/evaluation/samples.hpp"
#include "truebearing/io/table_reader.hpp"

namespace truebearing {
namespace {

void check_truth(const Recording& recording) {
  const auto has_sensor = [](const Measurement& measurement) { return measurement.sensor.has_value(); };
  if (!recording.truth_space || !begins_in_plane(*recording.truth_space) ||
      std::none_of(recording.measurements.begin(), recording.measurements.end(), has_sensor))
    throw InputError("scoring.target_motion", "has no own ship to be relative to, or no truth in the plane",
                     "measurements with own-ship columns");
}

class TargetMotionRun final : public TargetMotionFigures {
 public:
  explicit TargetMotionRun(const RunStart& run) : recording_(run.recording), steps_(run.time_steps) {
    at_times.resize(steps_.size());
  }

  void take(const ScoredStep& scored) override {
    const StepRecord* record = scored.records.front();
    const std::optional<SensorState>& own_ship = recording_.measurements[scored.step].sensor;
    if (!record || !own_ship || !begins_in_plane(*record->space)) return;
    const BoundedVector& truth = recording_.truth.front().x[scored.step];
    for (std::size_t time = 0; time < steps_.size(); ++time)
      if (steps_[time] == static_cast<int>(scored.step))
        at_times[time] = target_motion_error(truth.head<4>(), record->x.head<4>(), *own_ship);
  }

 private:
  const Recording& recording_;  // gone after the run
  std::vector<int> steps_;
};

class TargetMotionTally final : public MetricTally {
 public:
  explicit TargetMotionTally(const ScoringRule& rule) : times_s_(rule.times_s), at_times_(times_s_.size()) {}

  void add(const RunScore& run) override {
    const std::vector<TargetMotionError>& errors = run.of<TargetMotionFigures>()->at_times;
    for (std::size_t time = 0; time < times_s_.size(); ++time) {
      AtTime& at = at_times_[time];
      if (const double range = errors[time].range_percent; std::isfinite(range)) {
        at.range.add(range);
        at.range_size.add(std::abs(range));
      }
      if (std::isfinite(errors[time].course_deg)) at.course.add(errors[time].course_deg);
      if (std::isfinite(errors[time].speed_mps)) at.speed.add(errors[time].speed_mps);
    }
  }

  void exchange(TallyStream& stream) override {
    for (AtTime& at : at_times_) {
      for (Samples* samples : {&at.range, &at.course, &at.speed}) samples->exchange(stream);
      at.range_size.exchange(stream);
    }
  }

  std::vector<Metric> metrics() const override {
    std::vector<Metric> metrics;
    double time_to_20_s = std::nan("");
    for (std::size_t time = 0; time < times_s_.size(); ++time) {
      const double time_s = times_s_[time];
      const AtTime& at = at_times_[time];
      const auto add = [&](const char* name, const char* unit, Estimate figure,
                           MetricTable table = MetricTable::figures) {
        metrics.push_back({name, unit, time_s, figure.value, figure.se, table});
      };
      const Estimate mean = at.range.mean();
      add("range_error_mean", "percent", mean);
      add("range_error_std", "percent", at.range.standard_deviation());
      add("range_error_rmse", "percent", at.range.rmse());
      add("range_error_median", "percent", {at.range_size.value(), std::nan("")}, MetricTable::none);
      add("course_error_rmse", "deg", at.course.rmse());
      add("speed_error_rmse", "m/s", at.speed.rmse());
      if (std::isnan(time_to_20_s) && std::abs(mean.value) <= 20.0) time_to_20_s = time_s;
    }
    metrics.push_back({"time_to_20_percent", "s", std::nullopt, time_to_20_s, std::nan("")});
    return metrics;
  }

 private:
  struct AtTime {
    Samples range, course, speed;
    MedianOf range_size;
  };
  std::vector<double> times_s_;
  std::vector<AtTime> at_times_;
};

class TargetMotionMetrics final : public MetricFamily {
 public:
  std::unique_ptr<RunFigures> begin(const RunStart& run) const override {
    check_truth(run.recording);
    return std::make_unique<TargetMotionRun>(run);
  }

  std::unique_ptr<MetricTally> tally(const ScoringRule& rule, const Scorer&) const override {
    return std::make_unique<TargetMotionTally>(rule);
  }
};

}  // namespace

std::shared_ptr<const MetricFamily> target_motion_metrics() {
  return std::make_shared<TargetMotionMetrics>();
}

std::shared_ptr<const MetricFamily> read_target_motion(TableReader& scoring, const StateSpace& truth,
                                                       ScoringRule& rule) {
  const bool is_asked_for = scoring.boolean_or("target_motion", false);
  if (!begins_in_plane(truth))
    throw scoring.error("target_motion", "is of a target in the plane, and the scenario's truth is " + truth.name);
  if (rule.times_s.empty()) throw scoring.error("target_motion", "stands without times_s", "a key times_s beside it");
  return is_asked_for ? target_motion_metrics() : nullptr;
}

}  // namespace truebearing
