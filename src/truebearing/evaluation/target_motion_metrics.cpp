#include "truebearing/evaluation/target_motion_metrics.hpp"

#include <algorithm>
#include <cmath>

#include "truebearing/core/error.hpp"
#include "truebearing/evaluation/run_score.hpp"
#include "truebearing/evaluation/statistics.hpp"
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

class TargetMotionMetrics final : public MetricFamily {
 public:
  std::unique_ptr<RunFigures> begin(const RunStart& run) const override {
    check_truth(run.recording);
    return std::make_unique<TargetMotionRun>(run);
  }

  std::vector<Metric> finish(const TrackerRuns& runs) const override {
    std::vector<Metric> metrics;
    double time_to_20_s = std::nan("");
    for (std::size_t time = 0; time < runs.rule.times_s.size(); ++time) {
      const double time_s = runs.rule.times_s[time];
      const auto add = [&](const char* name, const char* unit, Estimate figure,
                           MetricTable table = MetricTable::figures) {
        metrics.push_back({name, unit, time_s, figure.value, figure.se, table});
      };
      std::vector<double> range = errors_at(runs, time, &TargetMotionError::range_percent);
      const Estimate mean = mean_of(range);
      add("range_error_mean", "percent", mean);
      add("range_error_std", "percent", standard_deviation_of(range));
      add("range_error_rmse", "percent", rmse_of(range));
      for (double& error : range) error = std::abs(error);
      add("range_error_median", "percent", {median_of(std::move(range)), std::nan("")}, MetricTable::none);
      add("course_error_rmse", "deg", rmse_of(errors_at(runs, time, &TargetMotionError::course_deg)));
      add("speed_error_rmse", "m/s", rmse_of(errors_at(runs, time, &TargetMotionError::speed_mps)));
      if (std::isnan(time_to_20_s) && std::abs(mean.value) <= 20.0) time_to_20_s = time_s;
    }
    metrics.push_back({"time_to_20_percent", "s", std::nullopt, time_to_20_s, std::nan("")});
    return metrics;
  }

 private:
  static std::vector<double> errors_at(const TrackerRuns& runs, std::size_t time, double TargetMotionError::*part) {
    std::vector<double> errors;
    for (const RunScore* run : runs.scores)
      if (const double error = run->of<TargetMotionFigures>()->at_times[time].*part; std::isfinite(error))
        errors.push_back(error);
    return errors;
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
