#include "truebearing/evaluation/batch_metrics.hpp"

#include <cmath>

#include "truebearing/evaluation/run_score.hpp"
#include "truebearing/evaluation/statistics.hpp"

namespace truebearing {
namespace {

class BatchRun final : public BatchFigures {
 public:
  explicit BatchRun(const std::vector<int>& steps) : steps_(steps) { at_times.resize(steps.size()); }

  void take(const ScoredStep& scored) override {
    const StepRecord* record = scored.records.front();
    if (!record) return;
    for (std::size_t time = 0; time < steps_.size(); ++time)
      if (steps_[time] == static_cast<int>(scored.step)) at_times[time] = record->batch;
  }

 private:
  std::vector<int> steps_;
};

class BatchMetrics final : public MetricFamily {
 public:
  std::unique_ptr<RunFigures> begin(const RunStart& run) const override {
    if (run.time_steps.empty()) return nullptr;
    return std::make_unique<BatchRun>(run.time_steps);
  }

  std::vector<Metric> finish(const TrackerRuns& runs) const override {
    std::vector<double> non_finite, iterations;
    for (const RunScore* run : runs.scores) {
      const auto* figures = run->of<BatchFigures>();
      if (!figures) continue;
      for (const std::optional<BatchOutcome>& batch : figures->at_times) {
        if (!batch) continue;
        non_finite.push_back(batch->non_finite_starts);
        iterations.push_back(batch->iterations);
      }
    }
    if (non_finite.empty()) return {};
    return {{"non_finite_starts", "1", std::nullopt, mean_of(non_finite).value, std::nan("")},
            {"iterations", "1", std::nullopt, mean_of(iterations).value, std::nan("")}};
  }
};

}  // namespace

std::shared_ptr<const MetricFamily> batch_metrics() {
  return std::make_shared<BatchMetrics>();
}

std::vector<Metric> global_minimum_share(const std::vector<const RunScore*>& scores,
                                         const std::vector<const RunScore*>& reference) {
  double solved = 0.0, compared = 0.0, found = 0.0;
  for (std::size_t run = 0; run < scores.size(); ++run) {
    const auto *others = scores[run]->of<BatchFigures>(), *bests = reference[run]->of<BatchFigures>();
    if (!others || !bests) continue;
    for (std::size_t time = 0; time < others->at_times.size(); ++time) {
      const std::optional<BatchOutcome>&other = others->at_times[time], &best = bests->at_times[time];
      solved += other.has_value();
      if (!best) continue;
      compared += 1.0;
      found += other && other->cost <= best->cost * (1.0 + 1e-6) + 1e-6;
    }
  }
  if (solved == 0.0 || compared == 0.0) return {};
  return {{"global_minimum_share", "share", std::nullopt, found / compared, std::nan("")}};
}

}  // namespace truebearing
