// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/track_metrics.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <optional>

#include "truebearing/core/constants.hpp"
#include "truebearing/evaluation/metric_registry.hpp"
#include "truebearing/evaluation/samples.hpp"
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

// Of one run; of one phase of it where that is not negative.
double mse(const RunScore& run, std::size_t quantity, int phase) {
  return mean_square(phase < 0 ? squared_errors(run, quantity) : squared_errors_in(run, quantity, phase));
}

class TrackTally final : public MetricTally {
 public:
  TrackTally(std::string followed, const Scorer& scorer)
      : followed_(std::move(followed)),
        quantities_(scorer.quantities()),
        all_have_(scorer.quantity(followed_).has_value()),
        clean_errors_(quantities_.size()) {}

  void add(const RunScore& run) override {
    all_have_ = all_have_ && run.of<TrackFigures>();
    if (!all_have_) return;
    const TrackOutcome& outcome = outcome_of(run);
    for (std::size_t q = 0; q < quantities_.size(); ++q) {
      const SquaredErrors errors = squared_errors(run, q);
      if (outcome.is_clean()) clean_errors_[q].add(errors);
      if (quantities_[q] == followed_) all_errors_.add(errors);
    }
    swaps_ += outcome.is_swap();
    losses_ += outcome.is_loss();
    excursions_ += outcome.excursion;
    clean_ += outcome.is_clean();
    bad_.add(outcome.is_swap() || outcome.is_loss());
  }

  void exchange(TallyStream& stream) override {
    stream.all(all_have_);
    for (RunErrors& errors : clean_errors_) errors.exchange(stream);
    all_errors_.exchange(stream);
    for (double* count : {&swaps_, &losses_, &excursions_, &clean_}) stream.sum(*count);
    bad_.exchange(stream);
  }

  std::vector<Metric> metrics() const override {
    std::vector<Metric> metrics;
    if (!all_have_) return metrics;
    const auto add = [&](std::string name, std::string unit, Estimate figure) {
      metrics.push_back({std::move(name), std::move(unit), std::nullopt, figure.value, figure.se, MetricTable::tracks});
    };
    for (std::size_t q = 0; q < quantities_.size(); ++q) {
      const std::string unit = squared_unit_of(quantities_[q]);
      const bool is_followed = quantities_[q] == followed_;
      add(is_followed ? "clean_mse" : name_of(quantities_[q]) + "_clean_mse", unit, clean_errors_[q].mse());
      if (is_followed) add("all_mse", unit, all_errors_.mse());
    }
    const auto add_count = [&](const char* name, double count) { add(name, "runs", {count, std::nan("")}); };
    add_count("swap_runs", swaps_);
    add_count("lost_runs", losses_);
    add("bad_share", "share", bad_.share());
    add_count("excursion_runs", excursions_);
    add_count("clean_runs", clean_);
    return metrics;
  }

 private:
  std::string followed_;
  std::vector<std::string> quantities_;
  bool all_have_;                        // an outcome, of the runs so far
  std::vector<RunErrors> clean_errors_;  // [quantity]
  RunErrors all_errors_;                 // of the one that is followed
  double swaps_ = 0.0, losses_ = 0.0, excursions_ = 0.0, clean_ = 0.0;
  Share bad_;
};

class TrackPairTally final : public PairTally {
 public:
  TrackPairTally(const Scorer& a, const Scorer& b) {
    for (std::size_t qa = 0; qa < a.quantities().size(); ++qa)
      if (const std::optional<std::size_t> qb = b.quantity(a.quantities()[qa]))
        quantities_.push_back({a.quantities()[qa], qa, *qb, {}});
  }

  void add(const RunScore& a, const RunScore& b) override {
    all_have_ = all_have_ && a.of<TrackFigures>() && b.of<TrackFigures>();
    if (!all_have_) return;
    if (names_.empty()) names_ = a.of<TrackFigures>()->phases;
    phases_ = std::max(phases_, phase_count({&a, &b}));
    if (!is_clean(a) || !is_clean(b)) return;
    for (Compared& compared : quantities_) {
      compared.by_phase.resize(static_cast<std::size_t>(phases_) + 1);
      for (int phase = -1; phase < phases_; ++phase) {
        const double value = mse(a, compared.in_a, phase) - mse(b, compared.in_b, phase);
        if (!std::isnan(value)) compared.by_phase[static_cast<std::size_t>(phase + 1)].add(value);
      }
    }
  }

  void exchange(TallyStream& stream) override {
    stream.all(all_have_);
    stream.names(names_);
    stream.greatest(phases_);
    for (Compared& compared : quantities_)
      stream.list(compared.by_phase, [&](Samples& samples) { samples.exchange(stream); });
  }

  std::vector<PairedDifference> differences() const override {
    std::vector<PairedDifference> differences;
    if (!all_have_) return differences;
    for (const Compared& compared : quantities_)
      for (std::size_t place = 0; place <= static_cast<std::size_t>(phases_); ++place) {
        const Estimate mean = place < compared.by_phase.size() ? compared.by_phase[place].mean() : Estimate{kNaN, kNaN};
        std::string name = compared.name + "2_clean";
        std::string title = fmt::format("{} {}", name_of(compared.name), squared_unit_of(compared.name));
        if (place > 0) {
          name += fmt::format("_{}", phase_name(place - 1));
          title += fmt::format(", {}", phase_name(place - 1));
        }
        differences.push_back(
            {std::move(name), mean.value, mean.se, std::move(title), std::nullopt, MetricTable::tracks});
      }
    return differences;
  }

 private:
  static bool is_clean(const RunScore& run) { return outcome_of(run).is_clean(); }

  std::string phase_name(std::size_t phase) const {
    return phase < names_.size() ? names_[phase] : fmt::format("phase {}", phase + 1);
  }

  struct Compared {
    std::string name;
    std::size_t in_a, in_b;
    std::vector<Samples> by_phase;  // all of a run, then by phase
  };
  std::vector<Compared> quantities_;
  std::vector<std::string> names_;  // of the phases, in the first run
  int phases_ = 0;
  bool all_have_ = true;
};

class TrackMetrics final : public MetricFamily {
 public:
  explicit TrackMetrics(TrackRule rule) : rule_(std::move(rule)) {}

  std::unique_ptr<RunFigures> begin(const RunStart& run) const override {
    const std::optional<std::size_t> quantity = run.scorer.quantity(rule_.quantity);
    return quantity ? std::make_unique<TrackRun>(rule_, run, *quantity) : nullptr;
  }

  std::unique_ptr<MetricTally> tally(const ScoringRule&, const Scorer& scorer) const override {
    return std::make_unique<TrackTally>(rule_.quantity, scorer);
  }

  std::unique_ptr<PairTally> pair_tally(const ScoringRule&, const Scorer& a, const Scorer& b) const override {
    return std::make_unique<TrackPairTally>(a, b);
  }

 private:
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
