#include "truebearing/evaluation/summary.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "truebearing/core/chi_square.hpp"
#include "truebearing/core/constants.hpp"

namespace truebearing {
namespace {

std::vector<QuantitySummary::Phase> summarise_phases(std::size_t q, const std::vector<const RunScore*>& scores) {
  const int count = phase_count(scores);
  std::vector<QuantitySummary::Phase> phases;
  for (int phase = 0; phase < count; ++phase) {
    std::vector<SquaredErrors> runs;
    for (const RunScore* score : scores) runs.push_back(squared_errors_in(*score, q, phase));
    const Estimate rmse = pooled_rmse(runs);
    phases.push_back({rmse.value, rmse.se});
  }
  return phases;
}

QuantitySummary summarise_quantity(const std::string& name, std::size_t q, int dimension,
                                   const std::vector<const RunScore*>& scores) {
  QuantitySummary summary;
  summary.name = name;
  std::vector<SquaredErrors> runs;
  std::vector<double> all;
  std::vector<SquaredErrors> steps;
  for (const RunScore* score : scores) {
    const std::vector<double>& errors = score->error[q];
    runs.push_back(squared_errors(*score, q));
    steps.resize(std::max(steps.size(), score->steps()));
    for (std::size_t place = 0; place < errors.size(); ++place) {
      if (std::isnan(errors[place])) continue;
      all.push_back(errors[place]);
      steps[place % score->steps()].add(errors[place]);
    }
  }
  const Estimate rmse = pooled_rmse(runs);
  summary.rmse = rmse.value;
  summary.rmse_se = rmse.se;
  summary.median = median_of(std::move(all));
  for (const SquaredErrors& step : steps) summary.series.push_back(root_mean(step));
  summary.phases = summarise_phases(q, scores);
  const double quantile = chi_square_quantile(0.95, dimension);
  double covered = 0.0, count = 0.0;
  for (const RunScore* score : scores)
    for (const double nees : score->quantity_nees[q]) {
      if (std::isnan(nees)) continue;
      covered += nees <= quantile ? 1.0 : 0.0;
      count += 1.0;
    }
  summary.coverage95 = count > 0.0 ? covered / count : kNaN;
  return summary;
}

// Is the last error of any target beyond its threshold?
bool is_lost(const RunScore& score, const Scorer& scorer, const ScoringRule& rule) {
  for (const auto& [name, threshold] : rule.loss_thresholds) {
    const std::optional<std::size_t> q = scorer.quantity(name);
    if (!q) continue;
    for (std::size_t target = 0; target < score.targets; ++target) {
      const std::span errors = std::span(score.error[*q]).subspan(target * score.steps(), score.steps());
      const auto last = std::find_if(errors.rbegin(), errors.rend(), [](double e) { return !std::isnan(e); });
      if (last == errors.rend() || *last > threshold) return true;
    }
  }
  return false;
}

}  // namespace

SquaredErrors squared_errors(const RunScore& score, std::size_t quantity) {
  SquaredErrors total;
  for (const double error : score.error[quantity])
    if (!std::isnan(error)) total.add(error);
  return total;
}

SquaredErrors squared_errors_in(const RunScore& score, std::size_t quantity, int phase) {
  const std::vector<double>& errors = score.error[quantity];
  SquaredErrors total;
  for (std::size_t place = 0; place < std::min(errors.size(), score.phase.size()); ++place)
    if (score.phase[place] == phase && !std::isnan(errors[place])) total.add(errors[place]);
  return total;
}

int phase_count(const std::vector<const RunScore*>& scores) {
  int count = 0;
  for (const RunScore* score : scores)
    for (const int phase : score->phase) count = std::max(count, phase + 1);
  return count;
}

const QuantitySummary* TrackerSummary::quantity(const std::string& quantity_name) const {
  for (const QuantitySummary& summary : quantities)
    if (summary.name == quantity_name) return &summary;
  return nullptr;
}

TrackerSummary summarise(const std::string& name, const Scorer& scorer, const std::vector<const RunScore*>& scores,
                         const ScoringRule& rule) {
  TrackerSummary summary;
  summary.name = name;
  summary.dimension = scorer.dimension();
  for (std::size_t q = 0; q < scorer.quantities().size(); ++q)
    summary.quantities.push_back(summarise_quantity(scorer.quantities()[q], q, scorer.dimension(q), scores));

  const double quantile = chi_square_quantile(0.95, scorer.dimension());
  double nees_sum = 0.0, covered = 0.0, count = 0.0, gate_sum = 0.0, limited = 0.0, lost = 0.0;
  for (const RunScore* score : scores) {
    for (const double nees : score->nees) {
      if (std::isnan(nees)) continue;
      nees_sum += nees;
      covered += nees <= quantile ? 1.0 : 0.0;
      count += 1.0;
    }
    if (!score->error.empty())
      summary.scored_steps +=
          std::count_if(score->error[0].begin(), score->error[0].end(), [](double e) { return !std::isnan(e); });
    summary.corrected_steps += score->corrected;
    gate_sum += score->gate_sum;
    limited += score->gate_limited;
    lost += is_lost(*score, scorer, rule) ? 1.0 : 0.0;
  }
  summary.nees = count > 0.0 ? nees_sum / count : kNaN;
  summary.coverage95 = count > 0.0 ? covered / count : kNaN;
  summary.loss_rate = scores.empty() ? kNaN : lost / static_cast<double>(scores.size());
  if (summary.corrected_steps > 0) {
    summary.limited_share = limited / static_cast<double>(summary.corrected_steps);
    summary.mean_gate = gate_sum / static_cast<double>(summary.corrected_steps);
  }
  return summary;
}

std::vector<PairedDifference> paired_difference(const Scorer& scorer_a, const std::vector<const RunScore*>& a,
                                                const Scorer& scorer_b, const std::vector<const RunScore*>& b) {
  std::vector<PairedDifference> differences;
  for (std::size_t qa = 0; qa < scorer_a.quantities().size(); ++qa)
    for (std::size_t qb = 0; qb < scorer_b.quantities().size(); ++qb) {
      if (scorer_a.quantities()[qa] != scorer_b.quantities()[qb]) continue;
      std::vector<double> values;
      for (std::size_t run = 0; run < a.size(); ++run) {
        const double value = root_mean(squared_errors(*a[run], qa)) - root_mean(squared_errors(*b[run], qb));
        if (!std::isnan(value)) values.push_back(value);
      }
      const Estimate mean = mean_of(values);
      const std::string& quantity = scorer_a.quantities()[qa];
      differences.push_back({quantity, mean.value, mean.se, title_of(quantity)});
    }
  return differences;
}

}  // namespace truebearing
