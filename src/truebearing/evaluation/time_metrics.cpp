// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/time_metrics.hpp"

#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "truebearing/evaluation/run_score.hpp"
#include "truebearing/evaluation/samples.hpp"

namespace truebearing {
namespace {

// One run's value at the time of that number, NaN where it has none.
double error_at(const RunScore& run, std::size_t quantity, std::size_t time) {
  const int step = run.time_steps[time];
  return step < 0 ? std::nan("") : run.error[quantity][static_cast<std::size_t>(step)];
}

double nees_at(const RunScore& run, std::size_t time) {
  const int step = run.time_steps[time];
  return step < 0 ? std::nan("") : run.nees[static_cast<std::size_t>(step)];
}

// The figures of one tracker at one time. Runs without a finite value do not count for it.
class TimeFigures {
 public:
  TimeFigures(const ScoringRule& rule, const Scorer& scorer, std::size_t time)
      : rule_(rule), scorer_(scorer), time_(time), errors_(scorer.quantities().size()) {}

  void take(const RunScore& run) {
    for (std::size_t q = 0; q < errors_.size(); ++q)
      if (const double error = error_at(run, q, time_); std::isfinite(error)) {
        errors_[q].all.add(error);
        errors_[q].median.add(error);
      }
    if (const double nees = nees_at(run, time_); std::isfinite(nees)) {
      nees_.add(nees);
      covered_.add(nees <= scorer_.nees95());
    }
    if (run.time_steps[time_] < 0) return;
    missing_.add(!std::isfinite(error_at(run, 0, time_)));
    lost_.add(is_lost(run));
  }

  void exchange(TallyStream& stream) {
    for (Errors& errors : errors_) {
      errors.all.exchange(stream);
      errors.median.exchange(stream);
    }
    nees_.exchange(stream);
    for (Share* share : {&covered_, &missing_, &lost_}) share->exchange(stream);
  }

  void add_quantities(std::vector<Metric>& metrics) const {
    const std::vector<std::string>& quantities = scorer_.quantities();
    for (std::size_t q = 0; q < quantities.size(); ++q) {
      const std::string name = name_of(quantities[q]), unit = unit_of(quantities[q]);
      add(metrics, name + "_rmse", unit, errors_[q].all.rmse());
      add(metrics, name + "_median", unit, {errors_[q].median.value(), std::nan("")}, MetricTable::none);
    }
  }

  void add_consistency(std::vector<Metric>& metrics) const {
    add(metrics, "nees", "1", nees_.mean(), MetricTable::none);
    add(metrics, "coverage95", "share", covered_.share(), MetricTable::none);
    add(metrics, "missing_share", "share", missing_.share(), MetricTable::none);
    if (!rule_.loss_thresholds.empty()) add(metrics, "loss_rate", "share", lost_.share());
  }

 private:
  void add(std::vector<Metric>& metrics, std::string name, std::string unit, Estimate figure,
           MetricTable table = MetricTable::figures) const {
    metrics.push_back({std::move(name), std::move(unit), rule_.times_s[time_], figure.value, figure.se, table});
  }

  bool is_lost(const RunScore& run) const {
    for (const auto& [name, threshold] : rule_.loss_thresholds)
      if (const auto q = scorer_.quantity(name); q && !(error_at(run, *q, time_) <= threshold)) return true;
    return false;
  }

  struct Errors {
    Samples all;
    MedianOf median;
  };
  const ScoringRule& rule_;
  const Scorer& scorer_;
  std::size_t time_;
  std::vector<Errors> errors_;  // [quantity]
  Samples nees_;
  Share covered_, missing_, lost_;
};

class TimeTally final : public MetricTally {
 public:
  TimeTally(const ScoringRule& rule, const Scorer& scorer) {
    for (std::size_t time = 0; time < rule.times_s.size(); ++time) at_times_.emplace_back(rule, scorer, time);
  }

  void add(const RunScore& run) override {
    for (TimeFigures& figures : at_times_) figures.take(run);
  }

  void exchange(TallyStream& stream) override {
    for (TimeFigures& figures : at_times_) figures.exchange(stream);
  }

  std::vector<Metric> metrics() const override {
    std::vector<Metric> metrics;
    for (const TimeFigures& figures : at_times_) {
      figures.add_quantities(metrics);
      figures.add_consistency(metrics);
    }
    return metrics;
  }

 private:
  std::vector<TimeFigures> at_times_;
};

class TimePairTally final : public PairTally {
 public:
  TimePairTally(const ScoringRule& rule, const Scorer& a, const Scorer& b) : times_s_(rule.times_s) {
    for (std::size_t qa = 0; qa < a.quantities().size(); ++qa)
      if (const std::optional<std::size_t> qb = b.quantity(a.quantities()[qa]))
        quantities_.push_back({a.quantities()[qa], qa, *qb, std::vector<Samples>(times_s_.size())});
  }

  void add(const RunScore& a, const RunScore& b) override {
    for (Compared& compared : quantities_)
      for (std::size_t time = 0; time < times_s_.size(); ++time) {
        const double value = error_at(a, compared.in_a, time) - error_at(b, compared.in_b, time);
        if (std::isfinite(value)) compared.at_times[time].add(value);
      }
  }

  void exchange(TallyStream& stream) override {
    for (Compared& compared : quantities_)
      for (Samples& samples : compared.at_times) samples.exchange(stream);
  }

  std::vector<PairedDifference> differences() const override {
    std::vector<PairedDifference> differences;
    for (const Compared& compared : quantities_)
      for (std::size_t time = 0; time < times_s_.size(); ++time) {
        const Estimate mean = compared.at_times[time].mean();
        differences.push_back({compared.name, mean.value, mean.se, title_of(compared.name), times_s_[time]});
      }
    return differences;
  }

 private:
  struct Compared {
    std::string name;
    std::size_t in_a, in_b;
    std::vector<Samples> at_times;
  };
  std::vector<double> times_s_;
  std::vector<Compared> quantities_;
};

class TimeMetrics final : public MetricFamily {
 public:
  std::unique_ptr<MetricTally> tally(const ScoringRule& rule, const Scorer& scorer) const override {
    return std::make_unique<TimeTally>(rule, scorer);
  }

  std::unique_ptr<PairTally> pair_tally(const ScoringRule& rule, const Scorer& a, const Scorer& b) const override {
    return std::make_unique<TimePairTally>(rule, a, b);
  }
};

}  // namespace

std::shared_ptr<const MetricFamily> time_metrics() {
  return std::make_shared<TimeMetrics>();
}

}  // namespace truebearing
