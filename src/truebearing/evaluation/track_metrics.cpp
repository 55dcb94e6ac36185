#include "truebearing/evaluation/track_metrics.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <optional>

#include "truebearing/core/constants.hpp"
#include "truebearing/evaluation/metric_registry.hpp"
#include "truebearing/evaluation/statistics.hpp"
#include "truebearing/evaluation/summary.hpp"

namespace truebearing {
namespace {

class TrackRun final : public TrackFigures {
 public:
  TrackRun(const TrackRule& rule, const RunStart& run, std::size_t quantity)
      : rule_(rule), scorer_(run.scorer), recording_(run.recording), quantity_(quantity) {
    phases = run.recording.phases;
    truth_.assign(run.recording.truth.size() * run.recording.measurements.size(), kNaN);
    estimates_ = truth_;
  }

  void take(const ScoredStep& scored) override {
    for (std::size_t target = 0; target < scored.records.size(); ++target) {
      const std::size_t place = target * recording_.measurements.size() + scored.step;
      truth_[place] = scorer_.true_value(quantity_, recording_.truth[target].x[scored.step]);
      if (const StepRecord* record = scored.records[target])
        estimates_[place] = scorer_.estimated_value(quantity_, record->x);
    }
  }

  void end(std::span<const TrackEvent>) override {
    outcome = track_outcome(truth_, estimates_, recording_.truth.size(), rule_);
    truth_ = estimates_ = {};
  }

 private:
  const TrackRule rule_;
  const Scorer& scorer_;  // these two are gone after the run
  const Recording& recording_;
  std::size_t quantity_;
  std::vector<double> truth_, estimates_;  // [target * steps + step] of the quantity
};

const TrackOutcome& outcome_of(const RunScore& run) {
  return run.of<TrackFigures>()->outcome;
}

bool is_any(const RunScore&) {
  return true;
}

bool is_clean(const RunScore& run) {
  return outcome_of(run).is_clean();
}

bool lacks_an_outcome(const TrackerRuns& runs) {
  return std::any_of(runs.scores.begin(), runs.scores.end(),
                     [](const RunScore* run) { return !run->of<TrackFigures>(); });
}

Estimate mse_over(const TrackerRuns& runs, std::size_t quantity, bool (*wanted)(const RunScore&)) {
  std::vector<SquaredErrors> errors;
  for (const RunScore* run : runs.scores)
    if (wanted(*run)) errors.push_back(squared_errors(*run, quantity));
  return pooled_mse(errors);
}

// Of one run; of one phase of it where that is not negative.
double mse(const RunScore& run, std::size_t quantity, int phase) {
  return mean_square(phase < 0 ? squared_errors(run, quantity) : squared_errors_in(run, quantity, phase));
}

std::string phase_name(const TrackerRuns& runs, int phase) {
  const std::vector<std::string>& names = runs.scores.front()->of<TrackFigures>()->phases;
  const auto place = static_cast<std::size_t>(phase);
  return place < names.size() ? names[place] : fmt::format("phase {}", place + 1);
}

class TrackMetrics final : public MetricFamily {
 public:
  explicit TrackMetrics(TrackRule rule) : rule_(std::move(rule)) {}

  std::unique_ptr<RunFigures> begin(const RunStart& run) const override {
    const std::optional<std::size_t> quantity = run.scorer.quantity(rule_.quantity);
    return quantity ? std::make_unique<TrackRun>(rule_, run, *quantity) : nullptr;
  }

  std::vector<Metric> finish(const TrackerRuns& runs) const override {
    if (!runs.scorer.quantity(rule_.quantity) || lacks_an_outcome(runs)) return {};
    std::vector<Metric> metrics;
    add_errors(runs, metrics);
    add_counts(runs, metrics);
    return metrics;
  }

  std::vector<PairedDifference> paired(const TrackerRuns& a, const TrackerRuns& b) const override {
    if (lacks_an_outcome(a) || lacks_an_outcome(b)) return {};
    const int phases = std::max(phase_count(a.scores), phase_count(b.scores));
    std::vector<PairedDifference> differences;
    for (std::size_t qa = 0; qa < a.scorer.quantities().size(); ++qa) {
      const std::string& quantity = a.scorer.quantities()[qa];
      const std::optional<std::size_t> qb = b.scorer.quantity(quantity);
      if (!qb) continue;
      for (int phase = -1; phase < phases; ++phase) {
        const Estimate mean = clean_difference(a, qa, b, *qb, phase);
        std::string name = quantity + "2_clean";
        std::string title = fmt::format("{} {}", name_of(quantity), squared_unit_of(quantity));
        if (phase >= 0) {
          name += fmt::format("_{}", phase_name(a, phase));
          title += fmt::format(", {}", phase_name(a, phase));
        }
        differences.push_back(
            {std::move(name), mean.value, mean.se, std::move(title), std::nullopt, MetricTable::tracks});
      }
    }
    return differences;
  }

 private:
  static void add(std::vector<Metric>& metrics, std::string name, std::string unit, Estimate figure) {
    metrics.push_back({std::move(name), std::move(unit), std::nullopt, figure.value, figure.se, MetricTable::tracks});
  }

  void add_errors(const TrackerRuns& runs, std::vector<Metric>& metrics) const {
    for (std::size_t q = 0; q < runs.scorer.quantities().size(); ++q) {
      const std::string& quantity = runs.scorer.quantities()[q];
      const bool is_followed = quantity == rule_.quantity;
      add(metrics, is_followed ? "clean_mse" : name_of(quantity) + "_clean_mse", squared_unit_of(quantity),
          mse_over(runs, q, is_clean));
      if (is_followed) add(metrics, "all_mse", squared_unit_of(quantity), mse_over(runs, q, is_any));
    }
  }

  static void add_counts(const TrackerRuns& runs, std::vector<Metric>& metrics) {
    double swaps = 0.0, losses = 0.0, excursions = 0.0, clean = 0.0;
    std::vector<double> bad;
    for (const RunScore* run : runs.scores) {
      const TrackOutcome& outcome = outcome_of(*run);
      swaps += outcome.is_swap();
      losses += outcome.is_loss();
      excursions += outcome.excursion;
      clean += outcome.is_clean();
      bad.push_back(outcome.is_swap() || outcome.is_loss());
    }
    const auto add_count = [&](const char* name, double count) { add(metrics, name, "runs", {count, std::nan("")}); };
    add_count("swap_runs", swaps);
    add_count("lost_runs", losses);
    add(metrics, "bad_share", "share", share_of(bad));
    add_count("excursion_runs", excursions);
    add_count("clean_runs", clean);
  }

  static Estimate clean_difference(const TrackerRuns& a, std::size_t qa, const TrackerRuns& b, std::size_t qb,
                                   int phase) {
    std::vector<double> values;
    for (std::size_t run = 0; run < a.scores.size(); ++run) {
      if (!is_clean(*a.scores[run]) || !is_clean(*b.scores[run])) continue;
      const double value = mse(*a.scores[run], qa, phase) - mse(*b.scores[run], qb, phase);
      if (!std::isnan(value)) values.push_back(value);
    }
    return mean_of(values);
  }

  TrackRule rule_;
};

}  // namespace

std::shared_ptr<const MetricFamily> track_metrics(TrackRule rule) {
  return std::make_shared<TrackMetrics>(std::move(rule));
}

std::shared_ptr<const MetricFamily> read_tracks(TableReader& scoring, const StateSpace& truth, ScoringRule& rule) {
  TableReader table = scoring.table("tracks");
  TrackRule tracks;
  tracks.quantity = read_scalar_quantity(table, truth);
  tracks.bad = table.number("bad", kPositive);
  tracks.last_steps = static_cast<int>(table.integer_or("last_steps", tracks.last_steps, 1, 1000000));
  tracks.excursion = table.number("excursion", kPositive);
  table.finish();
  if (!rule.times_s.empty())
    throw scoring.error("tracks", "stands beside times_s, which is of one target", "one of the two");
  return track_metrics(std::move(tracks));
}

}  // namespace truebearing
