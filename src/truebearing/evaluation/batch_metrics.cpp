// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/batch_metrics.hpp"

#include <cmath>

#include "truebearing/evaluation/run_score.hpp"
#include "truebearing/evaluation/samples.hpp"

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

class BatchTally final : public MetricTally {
 public:
  void add(const RunScore& run) override {
    const auto* figures = run.of<BatchFigures>();
    if (!figures) return;
    for (const std::optional<BatchOutcome>& batch : figures->at_times) {
      if (!batch) continue;
      non_finite_.add(batch->non_finite_starts);
      iterations_.add(batch->iterations);
    }
  }

  void exchange(TallyStream& stream) override {
    non_finite_.exchange(stream);
    iterations_.exchange(stream);
  }

  std::vector<Metric> metrics() const override {
    if (non_finite_.empty()) return {};
    return {{"non_finite_starts", "1", std::nullopt, non_finite_.mean().value, std::nan("")},
            {"iterations", "1", std::nullopt, iterations_.mean().value, std::nan("")}};
  }

 private:
  Samples non_finite_, iterations_;
};

class BatchMetrics final : public MetricFamily {
 public:
  std::unique_ptr<RunFigures> begin(const RunStart& run) const override {
    if (run.time_steps.empty()) return nullptr;
    return std::make_unique<BatchRun>(run.time_steps);
  }

  std::unique_ptr<MetricTally> tally(const ScoringRule&, const Scorer&) const override {
    return std::make_unique<BatchTally>();
  }
};

}  // namespace

std::shared_ptr<const MetricFamily> batch_metrics() {
  return std::make_shared<BatchMetrics>();
}

void GlobalMinimumTally::add(const RunScore& run, const RunScore& reference) {
  const auto *others = run.of<BatchFigures>(), *bests = reference.of<BatchFigures>();
  if (!others || !bests) return;
  for (std::size_t time = 0; time < others->at_times.size(); ++time) {
    const std::optional<BatchOutcome>&other = others->at_times[time], &best = bests->at_times[time];
    solved_ += other.has_value();
    if (!best) continue;
    compared_ += 1.0;
    found_ += other && other->cost <= best->cost * (1.0 + 1e-6) + 1e-6;
  }
}

void GlobalMinimumTally::exchange(TallyStream& stream) {
  stream.sum(solved_);
  stream.sum(compared_);
  stream.sum(found_);
}

std::vector<Metric> GlobalMinimumTally::metrics() const {
  if (solved_ == 0.0 || compared_ == 0.0) return {};
  return {{"global_minimum_share", "share", std::nullopt, found_ / compared_, std::nan("")}};
}

std::vector<Metric> global_minimum_share(const std::vector<const RunScore*>& scores,
                                         const std::vector<const RunScore*>& reference) {
  GlobalMinimumTally tally;
  for (std::size_t run = 0; run < scores.size(); ++run) tally.add(*scores[run], *reference[run]);
  return tally.metrics();
}

}  // namespace truebearing
