#include "truebearing/evaluation/time_metrics.hpp"

#include <algorithm>
#include <cmath>

#include "truebearing/core/chi_square.hpp"
#include "truebearing/evaluation/run_score.hpp"
#include "truebearing/evaluation/statistics.hpp"

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

// The figures of one tracker at one time.
class TimeFigures {
 public:
  TimeFigures(const TrackerRuns& runs, std::size_t time) : runs_(runs), time_(time) {}

  void add_quantities(std::vector<Metric>& metrics) const {
    const std::vector<std::string>& quantities = runs_.scorer.quantities();
    for (std::size_t q = 0; q < quantities.size(); ++q) {
      const std::string name = name_of(quantities[q]), unit = unit_of(quantities[q]);
      const std::vector<double> errors = finite([&](const RunScore& run) { return error_at(run, q, time_); });
      add(metrics, name + "_rmse", unit, rmse_of(errors));
      add(metrics, name + "_median", unit, {median_of(errors), std::nan("")}, MetricTable::none);
    }
  }

  void add_consistency(std::vector<Metric>& metrics) const {
    const std::vector<double> nees = finite([&](const RunScore& run) { return nees_at(run, time_); });
    const double quantile = chi_square_quantile(0.95, runs_.scorer.dimension());
    add(metrics, "nees", "1", mean_of(nees), MetricTable::none);
    std::vector<double> covered;
    for (const double value : nees) covered.push_back(value <= quantile ? 1.0 : 0.0);
    add(metrics, "coverage95", "share", share_of(covered), MetricTable::none);
    const auto is_missing = [&](const RunScore& run) { return !std::isfinite(error_at(run, 0, time_)); };
    add(metrics, "missing_share", "share", share_of(counted(is_missing)), MetricTable::none);
    if (runs_.rule.loss_thresholds.empty()) return;
    add(metrics, "loss_rate", "share", share_of(counted([&](const RunScore& run) { return is_lost(run); })));
  }

 private:
  void add(std::vector<Metric>& metrics, std::string name, std::string unit, Estimate figure,
           MetricTable table = MetricTable::figures) const {
    metrics.push_back({std::move(name), std::move(unit), runs_.rule.times_s[time_], figure.value, figure.se, table});
  }

  template <typename Value>
  std::vector<double> finite(const Value& value) const {
    std::vector<double> values;
    for (const RunScore* run : runs_.scores)
      if (const double v = value(*run); std::isfinite(v)) values.push_back(v);
    return values;
  }

  // 1 for a run that `is`, 0 for another that counts.
  template <typename Is>
  std::vector<double> counted(const Is& is) const {
    return finite([&](const RunScore& run) { return run.time_steps[time_] < 0 ? std::nan("") : is(run) ? 1.0 : 0.0; });
  }

  bool is_lost(const RunScore& run) const {
    for (const auto& [name, threshold] : runs_.rule.loss_thresholds)
      if (const auto q = runs_.scorer.quantity(name); q && !(error_at(run, *q, time_) <= threshold)) return true;
    return false;
  }

  const TrackerRuns& runs_;
  std::size_t time_;
};

class TimeMetrics final : public MetricFamily {
 public:
  std::vector<Metric> finish(const TrackerRuns& runs) const override {
    std::vector<Metric> metrics;
    for (std::size_t time = 0; time < runs.rule.times_s.size(); ++time) {
      const TimeFigures figures(runs, time);
      figures.add_quantities(metrics);
      figures.add_consistency(metrics);
    }
    return metrics;
  }

  std::vector<PairedDifference> paired(const TrackerRuns& a, const TrackerRuns& b) const override {
    std::vector<PairedDifference> differences;
    for (std::size_t qa = 0; qa < a.scorer.quantities().size(); ++qa) {
      const std::string& quantity = a.scorer.quantities()[qa];
      const std::optional<std::size_t> qb = b.scorer.quantity(quantity);
      if (!qb) continue;
      for (std::size_t time = 0; time < a.rule.times_s.size(); ++time) {
        std::vector<double> values;
        for (std::size_t run = 0; run < a.scores.size(); ++run) {
          const double value = error_at(*a.scores[run], qa, time) - error_at(*b.scores[run], *qb, time);
          if (std::isfinite(value)) values.push_back(value);
        }
        const Estimate mean = mean_of(values);
        differences.push_back({quantity, mean.value, mean.se, title_of(quantity), a.rule.times_s[time]});
      }
    }
    return differences;
  }
};

}  // namespace

std::shared_ptr<const MetricFamily> time_metrics() {
  return std::make_shared<TimeMetrics>();
}

}  // namespace truebearing
