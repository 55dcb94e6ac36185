#include "truebearing/evaluation/gospa_metrics.hpp"

#include <algorithm>

#include "truebearing/evaluation/metric_registry.hpp"
#include "truebearing/evaluation/run_score.hpp"
#include "truebearing/evaluation/statistics.hpp"

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

class GospaMetrics final : public MetricFamily {
 public:
  std::unique_ptr<RunFigures> begin(const RunStart& run) const override {
    if (!run.rule.assignment || !run.scorer.quantity(run.rule.assignment->quantity)) return nullptr;
    return std::make_unique<GospaRun>(run.rule.assignment->cutoff);
  }

  std::vector<Metric> finish(const TrackerRuns& runs) const override {
    const auto has_none = [](const RunScore* run) { return !run->of<GospaFigures>(); };
    if (!runs.rule.assignment || std::any_of(runs.scores.begin(), runs.scores.end(), has_none)) return {};
    const auto over_runs = [&](double GospaFigures::*part) {
      std::vector<SquaredErrors> sums;
      for (const RunScore* run : runs.scores) {
        const auto& figures = *run->of<GospaFigures>();
        sums.push_back({figures.*part, figures.steps});
      }
      return sums;
    };
    std::vector<Metric> metrics;
    const auto add = [&](const char* name, const std::string& unit, Estimate figure) {
      metrics.push_back({name, unit, std::nullopt, figure.value, figure.se, MetricTable::tracks});
    };
    const std::string unit = unit_of(runs.rule.assignment->quantity);
    add("gospa", unit, pooled_rmse(over_runs(&GospaFigures::squared)));
    add("gospa_localisation", unit, pooled_rmse(over_runs(&GospaFigures::localisation)));
    add("missed_targets", "1", pooled_mse(over_runs(&GospaFigures::missed)));
    add("false_tracks", "1", pooled_mse(over_runs(&GospaFigures::false_tracks)));
    return metrics;
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
