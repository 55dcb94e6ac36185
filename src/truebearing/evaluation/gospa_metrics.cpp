// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/gospa_metrics.hpp"

#include <string>

#include "truebearing/evaluation/metric_registry.hpp"
#include "truebearing/evaluation/run_score.hpp"
#include "truebearing/evaluation/samples.hpp"

namespace truebearing {
namespace {

class GospaRun final : public GospaFigures {
 public:
  explicit GospaRun(double cutoff) : cutoff_(cutoff) {}

  void take(const ScoredStep& scored) override {
    const Gospa& found = *scored.assignment;
    squared += found.squared(cutoff_);
    localisation += found.localisation;
    missed += found.missed;
    false_tracks += found.false_tracks;
    steps += 1.0;
  }

 private:
  double cutoff_;
};

class GospaTally final : public MetricTally {
 public:
  explicit GospaTally(const ScoringRule& rule) {
    if (rule.assignment) unit_ = unit_of(rule.assignment->quantity);
    all_have_ = rule.assignment.has_value();
  }

  void add(const RunScore& run) override {
    const auto* figures = run.of<GospaFigures>();
    all_have_ = all_have_ && figures;
    if (!figures) return;
    squared_.add({figures->squared, figures->steps});
    localisation_.add({figures->localisation, figures->steps});
    missed_.add({figures->missed, figures->steps});
    false_tracks_.add({figures->false_tracks, figures->steps});
  }

  void exchange(TallyStream& stream) override {
    stream.all(all_have_);
    for (RunErrors* errors : {&squared_, &localisation_, &missed_, &false_tracks_}) errors->exchange(stream);
  }

  std::vector<Metric> metrics() const override {
    std::vector<Metric> metrics;
    if (!all_have_) return metrics;
    const auto add = [&](const char* name, const std::string& unit, Estimate figure) {
      metrics.push_back({name, unit, std::nullopt, figure.value, figure.se, MetricTable::tracks});
    };
    add("gospa", unit_, squared_.rmse());
    add("gospa_localisation", unit_, localisation_.rmse());
    add("missed_targets", "1", missed_.mse());
    add("false_tracks", "1", false_tracks_.mse());
    return metrics;
  }

 private:
  std::string unit_;
  bool all_have_ = false;  // of the runs so far
  RunErrors squared_, localisation_, missed_, false_tracks_;
};

class GospaMetrics final : public MetricFamily {
 public:
  std::unique_ptr<RunFigures> begin(const RunStart& run) const override {
    if (!run.rule.assignment || !run.scorer.quantity(run.rule.assignment->quantity)) return nullptr;
    return std::make_unique<GospaRun>(run.rule.assignment->cutoff);
  }

  std::unique_ptr<MetricTally> tally(const ScoringRule& rule, const Scorer&) const override {
    return std::make_unique<GospaTally>(rule);
  }
};

}  // namespace

std::shared_ptr<const MetricFamily> gospa_metrics() {
  return std::make_shared<GospaMetrics>();
}

std::shared_ptr<const MetricFamily> read_gospa(TableReader& scoring, const StateSpace& truth, ScoringRule& rule) {
  TableReader table = scoring.table("gospa");
  AssignmentRule& assignment = rule.assignment.emplace();
  assignment.quantity = read_scalar_quantity(table, truth);
  assignment.cutoff = table.number("cutoff", kPositive);
  table.finish();
  if (scoring.has("tracks")) throw scoring.error("gospa", "stands beside tracks", "one of the two");
  if (!rule.times_s.empty())
    throw scoring.error("gospa", "stands beside times_s, which is of one target", "one of the two");
  return gospa_metrics();
}

}  // namespace truebearing
