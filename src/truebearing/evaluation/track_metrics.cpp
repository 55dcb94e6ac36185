#include "truebearing/evaluation/track_metrics.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "truebearing/evaluation/statistics.hpp"
#include "truebearing/evaluation/summary.hpp"

namespace truebearing {
namespace {

using Runs = std::vector<const RunScore*>;

bool is_clean(const RunScore& run) {
  return run.tracks && run.tracks->is_clean();
}

template <typename Wanted>
std::vector<SquaredErrors> errors_of(const Runs& runs, std::size_t quantity, const Wanted& wanted) {
  std::vector<SquaredErrors> errors;
  for (const RunScore* run : runs)
    if (wanted(*run)) errors.push_back(squared_errors(*run, quantity));
  return errors;
}

double mse(const RunScore& run, std::size_t quantity, int phase) {
  return mean_square(phase < 0 ? squared_errors(run, quantity) : squared_errors_in(run, quantity, phase));
}

}  // namespace

std::vector<Metric> track_metrics(const Scorer& scorer, const Runs& scores, const ScoringRule& rule) {
  if (!rule.tracks || !scorer.quantity(rule.tracks->quantity)) return {};
  std::vector<Metric> metrics;
  const auto add = [&](std::string name, std::string unit, Estimate figure) {
    metrics.push_back({std::move(name), std::move(unit), std::nullopt, figure.value, figure.se});
  };
  const auto any = [](const RunScore&) { return true; };
  for (std::size_t q = 0; q < scorer.quantities().size(); ++q) {
    const std::string& quantity = scorer.quantities()[q];
    const Estimate clean = pooled_mse(errors_of(scores, q, is_clean));
    if (quantity != rule.tracks->quantity) {
      add(name_of(quantity) + "_clean_mse", squared_unit_of(quantity), clean);
      continue;
    }
    add("clean_mse", squared_unit_of(quantity), clean);
    add("all_mse", squared_unit_of(quantity), pooled_mse(errors_of(scores, q, any)));
  }

  double swaps = 0.0, losses = 0.0, excursions = 0.0, clean = 0.0;
  std::vector<double> bad;
  for (const RunScore* run : scores) {
    swaps += run->tracks->is_swap();
    losses += run->tracks->is_loss();
    excursions += run->tracks->excursion;
    clean += run->tracks->is_clean();
    bad.push_back(run->tracks->is_swap() || run->tracks->is_loss());
  }
  const auto add_count = [&](const char* name, double count) { add(name, "runs", {count, std::nan("")}); };
  add_count("swap_runs", swaps);
  add_count("lost_runs", losses);
  add("bad_share", "share", share_of(bad));
  add_count("excursion_runs", excursions);
  add_count("clean_runs", clean);
  return metrics;
}

std::vector<Metric> gospa_metrics(const Runs& scores, const ScoringRule& rule) {
  const auto has_none = [](const RunScore* run) { return !run->gospa; };
  if (!rule.gospa || std::any_of(scores.begin(), scores.end(), has_none)) return {};
  const auto over_runs = [&](double GospaSum::*part) {
    std::vector<SquaredErrors> runs;
    for (const RunScore* run : scores) runs.push_back({(*run->gospa).*part, run->gospa->steps});
    return runs;
  };
  std::vector<Metric> metrics;
  const auto add = [&](const char* name, const std::string& unit, Estimate figure) {
    metrics.push_back({name, unit, std::nullopt, figure.value, figure.se});
  };
  const std::string unit = unit_of(rule.gospa->quantity);
  add("gospa", unit, pooled_rmse(over_runs(&GospaSum::squared)));
  add("gospa_localisation", unit, pooled_rmse(over_runs(&GospaSum::localisation)));
  add("missed_targets", "1", pooled_mse(over_runs(&GospaSum::missed)));
  add("false_tracks", "1", pooled_mse(over_runs(&GospaSum::false_tracks)));
  return metrics;
}

bool is_track_metric(const std::string& name) {
  static const std::vector<std::string> names{"all_mse",        "swap_runs",   "lost_runs", "bad_share",
                                              "excursion_runs", "clean_runs",  "gospa",     "gospa_localisation",
                                              "missed_targets", "false_tracks"};
  return name.ends_with("clean_mse") || std::find(names.begin(), names.end(), name) != names.end();
}

std::vector<CleanDifference> clean_differences(const Scorer& scorer_a, const Runs& a, const Scorer& scorer_b,
                                               const Runs& b) {
  const auto has_none = [](const RunScore* run) { return !run->tracks; };
  if (std::any_of(a.begin(), a.end(), has_none) || std::any_of(b.begin(), b.end(), has_none)) return {};
  const int phases = std::max(phase_count(a), phase_count(b));
  std::vector<CleanDifference> differences;
  for (std::size_t qa = 0; qa < scorer_a.quantities().size(); ++qa) {
    const std::string& quantity = scorer_a.quantities()[qa];
    const std::optional<std::size_t> qb = scorer_b.quantity(quantity);
    if (!qb) continue;
    for (int phase = -1; phase < phases; ++phase) {
      std::vector<double> values;
      for (std::size_t run = 0; run < a.size(); ++run) {
        if (!is_clean(*a[run]) || !is_clean(*b[run])) continue;
        const double value = mse(*a[run], qa, phase) - mse(*b[run], *qb, phase);
        if (!std::isnan(value)) values.push_back(value);
      }
      const Estimate mean = mean_of(values);
      differences.push_back({quantity, phase, mean.value, mean.se});
    }
  }
  return differences;
}

}  // namespace truebearing
