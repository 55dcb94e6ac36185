#include "truebearing/evaluation/time_metrics.hpp"

#include <algorithm>
#include <cmath>

#include "truebearing/core/chi_square.hpp"
#include "truebearing/evaluation/statistics.hpp"

namespace truebearing {
namespace {

using Runs = std::vector<const RunScore*>;

// One run's value at the time of that number, NaN where it has none.
double error_at(const RunScore& run, std::size_t quantity, std::size_t time) {
  const int step = run.at_times[time].step;
  return step < 0 ? std::nan("") : run.error[quantity][static_cast<std::size_t>(step)];
}

double nees_at(const RunScore& run, std::size_t time) {
  const int step = run.at_times[time].step;
  return step < 0 ? std::nan("") : run.nees[static_cast<std::size_t>(step)];
}

template <typename Value>
std::vector<double> finite(const Runs& runs, const Value& value) {
  std::vector<double> values;
  for (const RunScore* run : runs)
    if (const double v = value(*run); std::isfinite(v)) values.push_back(v);
  return values;
}

Estimate rmse(const std::vector<double>& errors) {
  std::vector<SquaredErrors> runs;
  for (const double error : errors) runs.emplace_back().add(error);
  return pooled_rmse(runs);
}

class TimeFigures {
 public:
  TimeFigures(const Scorer& scorer, const Runs& runs, const ScoringRule& rule)
      : scorer_(scorer), runs_(runs), rule_(rule) {}

  std::vector<Metric> all() {
    for (time_ = 0; time_ < rule_.times_s.size(); ++time_) {
      add_quantities();
      add_consistency();
      if (rule_.target_motion) add_target_motion();
    }
    if (rule_.target_motion) add_time_to_20_percent();
    add_batch();
    return std::move(metrics_);
  }

 private:
  void add(std::string name, std::string unit, Estimate figure) {
    metrics_.push_back({std::move(name), std::move(unit), rule_.times_s[time_], figure.value, figure.se});
  }

  void add_quantities() {
    for (std::size_t q = 0; q < scorer_.quantities().size(); ++q) {
      const std::string name = name_of(scorer_.quantities()[q]), unit = unit_of(scorer_.quantities()[q]);
      const std::vector<double> errors = finite(runs_, [&](const RunScore& run) { return error_at(run, q, time_); });
      add(name + "_rmse", unit, rmse(errors));
      add(name + "_median", unit, {median_of(errors), std::nan("")});
    }
  }

  void add_consistency() {
    const std::vector<double> nees = finite(runs_, [&](const RunScore& run) { return nees_at(run, time_); });
    const double quantile = chi_square_quantile(0.95, scorer_.dimension());
    add("nees", "1", mean_of(nees));
    std::vector<double> covered;
    for (const double value : nees) covered.push_back(value <= quantile ? 1.0 : 0.0);
    add("coverage95", "share", share_of(covered));
    // 1 for a run that is missing or lost, 0 for another that counts.
    const auto counted = [&](const auto& is) {
      return finite(runs_, [&](const RunScore& run) {
        return run.at_times[time_].step < 0 ? std::nan("") : is(run) ? 1.0 : 0.0;
      });
    };
    const auto is_missing = [&](const RunScore& run) { return !std::isfinite(error_at(run, 0, time_)); };
    add("missing_share", "share", share_of(counted(is_missing)));
    if (rule_.loss_thresholds.empty()) return;
    const auto is_lost = [&](const RunScore& run) {
      for (const auto& [name, threshold] : rule_.loss_thresholds)
        for (std::size_t q = 0; q < scorer_.quantities().size(); ++q)
          if (scorer_.quantities()[q] == name && !(error_at(run, q, time_) <= threshold)) return true;
      return false;
    };
    add("loss_rate", "share", share_of(counted(is_lost)));
  }

  void add_target_motion() {
    const auto errors = [&](double TargetMotionError::*part) {
      return finite(runs_, [&](const RunScore& run) { return run.at_times[time_].motion.*part; });
    };
    std::vector<double> range = errors(&TargetMotionError::range_percent);
    const Estimate mean = mean_of(range);
    add("range_error_mean", "percent", mean);
    add("range_error_std", "percent", standard_deviation_of(range));
    add("range_error_rmse", "percent", rmse(range));
    for (double& error : range) error = std::abs(error);
    add("range_error_median", "percent", {median_of(std::move(range)), std::nan("")});
    add("course_error_rmse", "deg", rmse(errors(&TargetMotionError::course_deg)));
    add("speed_error_rmse", "m/s", rmse(errors(&TargetMotionError::speed_mps)));
    if (!time_to_20_s_ && std::abs(mean.value) <= 20.0) time_to_20_s_ = rule_.times_s[time_];
  }

  void add_time_to_20_percent() {
    metrics_.push_back({"time_to_20_percent", "s", std::nullopt, time_to_20_s_.value_or(std::nan("")), std::nan("")});
  }

  void add_batch() {
    std::vector<double> non_finite, iterations;
    for (const RunScore* run : runs_)
      for (const TimeScore& at : run->at_times)
        if (at.batch) {
          non_finite.push_back(at.batch->non_finite_starts);
          iterations.push_back(at.batch->iterations);
        }
    if (non_finite.empty()) return;
    metrics_.push_back({"non_finite_starts", "1", std::nullopt, mean_of(non_finite).value, std::nan("")});
    metrics_.push_back({"iterations", "1", std::nullopt, mean_of(iterations).value, std::nan("")});
  }

  const Scorer& scorer_;
  const Runs& runs_;
  const ScoringRule& rule_;
  std::size_t time_ = 0;
  std::vector<Metric> metrics_;
  std::optional<double> time_to_20_s_;
};

}  // namespace

std::vector<Metric> time_metrics(const Scorer& scorer, const Runs& scores, const ScoringRule& rule) {
  if (rule.times_s.empty()) return {};
  return TimeFigures(scorer, scores, rule).all();
}

std::vector<Metric> global_minimum_share(const Runs& scores, const Runs& reference) {
  double solved = 0.0, compared = 0.0, found = 0.0;
  for (std::size_t run = 0; run < scores.size(); ++run)
    for (std::size_t time = 0; time < scores[run]->at_times.size(); ++time) {
      const auto& other = scores[run]->at_times[time].batch;
      const auto& best = reference[run]->at_times[time].batch;
      solved += other.has_value();
      if (!best) continue;
      compared += 1.0;
      found += other && other->cost <= best->cost * (1.0 + 1e-6) + 1e-6;
    }
  if (solved == 0.0 || compared == 0.0) return {};
  return {{"global_minimum_share", "share", std::nullopt, found / compared, std::nan("")}};
}

std::vector<TimedDifference> timed_differences(const Scorer& scorer_a, const Runs& a, const Scorer& scorer_b,
                                               const Runs& b, const ScoringRule& rule) {
  std::vector<TimedDifference> differences;
  for (std::size_t qa = 0; qa < scorer_a.quantities().size(); ++qa)
    for (std::size_t qb = 0; qb < scorer_b.quantities().size(); ++qb) {
      if (scorer_a.quantities()[qa] != scorer_b.quantities()[qb]) continue;
      for (std::size_t time = 0; time < rule.times_s.size(); ++time) {
        std::vector<double> values;
        for (std::size_t run = 0; run < a.size(); ++run) {
          const double value = error_at(*a[run], qa, time) - error_at(*b[run], qb, time);
          if (std::isfinite(value)) values.push_back(value);
        }
        const Estimate mean = mean_of(values);
        differences.push_back({scorer_a.quantities()[qa], rule.times_s[time], mean.value, mean.se});
      }
    }
  return differences;
}

}  // namespace truebearing
