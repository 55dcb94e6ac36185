// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/summary.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "truebearing/core/constants.hpp"
#include "truebearing/evaluation/loss_score.hpp"

namespace truebearing {

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

namespace {

// How many of the values are numbers, and how many of those are no greater than a limit.
struct Covered {
  double covered, count;

  Covered(const std::vector<double>& values, double limit) {
    long below = 0, numbers = 0;
    for (const double value : values) {
      below += value <= limit;
      numbers += !std::isnan(value);
    }
    covered = static_cast<double>(below);
    count = static_cast<double>(numbers);
  }
};

}  // namespace

SquaredErrors SummaryTally::QuantityTally::add(const RunScore& run, std::size_t quantity, std::size_t phases_of_run,
                                               double nees95) {
  const std::vector<double>& errors = run.error[quantity];
  median.add(errors);
  steps.resize(std::max(steps.size(), run.steps()));
  phases.resize(std::max(phases.size(), phases_of_run));
  SquaredErrors all;
  std::vector<SquaredErrors> of_phases(phases.size());
  for (std::size_t place = 0, step = 0; place < errors.size();) {  // stretch by stretch of one phase
    const int phase = run.phase_at(place);
    SquaredErrors of_none, &of_phase = phase < 0 ? of_none : of_phases[static_cast<std::size_t>(phase)];
    SquaredErrors sum = of_phase;
    for (; place < errors.size() && run.phase_at(place) == phase; ++place) {
      const double error = errors[place];
      if (!std::isnan(error)) {
        all.add(error);
        sum.add(error);
        steps[step].add(error);
      }
      if (++step == run.steps()) step = 0;  // the next target's
    }
    of_phase = sum;
  }
  runs.add(all);
  for (std::size_t phase = 0; phase < phases.size(); ++phase) phases[phase].add(of_phases[phase]);
  const Covered inside(run.quantity_nees[quantity], nees95);
  covered += inside.covered;
  count += inside.count;
  return all;
}

SummaryTally::SummaryTally(std::string name, const Scorer& scorer, const ScoringRule& rule, std::size_t kept_apart)
    : name_(std::move(name)),
      scorer_(scorer),
      rule_(rule),
      quantities_(scorer.quantities().size(), QuantityTally(kept_apart)) {}

void SummaryTally::add_consistency(const RunScore& run) {
  double sum = nees_sum_;  // not in memory, which the values could share for all the compiler knows
  for (const double nees : run.nees)
    if (!std::isnan(nees)) sum += nees;
  nees_sum_ = sum;
  const Covered inside(run.nees, scorer_.nees95());
  covered_ += inside.covered;
  count_ += inside.count;
}

void SummaryTally::add(const RunScore& run) {
  const auto phases = static_cast<std::size_t>(phase_count({&run}));
  for (std::size_t q = 0; q < quantities_.size(); ++q) {
    const SquaredErrors errors = quantities_[q].add(run, q, phases, scorer_.nees95(q));
    if (q == 0) scored_steps_ += static_cast<long>(errors.count);
  }
  add_consistency(run);
  corrected_steps_ += run.corrected;
  gate_sum_ += run.gate_sum;
  limited_ += run.gate_limited;
  lost_ += loss_score(run, scorer_, rule_) > 1.0 ? 1.0 : 0.0;
  runs_ += 1.0;
}

void SummaryTally::QuantityTally::exchange(TallyStream& stream) {
  runs.exchange(stream);
  median.exchange(stream);
  stream.list(steps, [&](SquaredErrors& step) { truebearing::exchange(step, stream); });
  stream.list(phases, [&](RunErrors& phase) { phase.exchange(stream); });
  stream.sum(covered);
  stream.sum(count);
}

void SummaryTally::exchange(TallyStream& stream) {
  for (QuantityTally& quantity : quantities_) quantity.exchange(stream);
  for (double* sum : {&nees_sum_, &covered_, &count_, &gate_sum_, &limited_, &lost_, &runs_}) stream.sum(*sum);
  stream.sum(scored_steps_);
  stream.sum(corrected_steps_);
}

TrackerSummary SummaryTally::summary() const {
  TrackerSummary summary;
  summary.name = name_;
  summary.dimension = scorer_.dimension();
  for (std::size_t q = 0; q < quantities_.size(); ++q) {
    const QuantityTally& tally = quantities_[q];
    QuantitySummary& quantity = summary.quantities.emplace_back();
    quantity.name = scorer_.quantities()[q];
    const Estimate rmse = tally.runs.rmse();
    quantity.rmse = rmse.value;
    quantity.rmse_se = rmse.se;
    quantity.median = tally.median.value();
    quantity.coverage95 = tally.count > 0.0 ? tally.covered / tally.count : kNaN;
    for (const SquaredErrors& step : tally.steps) quantity.series.push_back(root_mean(step));
    for (const RunErrors& phase : tally.phases) {
      const Estimate of_phase = phase.rmse();
      quantity.phases.push_back({of_phase.value, of_phase.se});
    }
  }
  summary.nees = count_ > 0.0 ? nees_sum_ / count_ : kNaN;
  summary.coverage95 = count_ > 0.0 ? covered_ / count_ : kNaN;
  summary.loss_rate = runs_ > 0.0 ? lost_ / runs_ : kNaN;
  summary.scored_steps = scored_steps_;
  summary.corrected_steps = corrected_steps_;
  if (corrected_steps_ > 0) {
    summary.limited_share = limited_ / static_cast<double>(corrected_steps_);
    summary.mean_gate = gate_sum_ / static_cast<double>(corrected_steps_);
  }
  return summary;
}

DifferenceTally::DifferenceTally(const Scorer& a, const Scorer& b) {
  for (std::size_t qa = 0; qa < a.quantities().size(); ++qa)
    if (const std::optional<std::size_t> qb = b.quantity(a.quantities()[qa]))
      quantities_.push_back({a.quantities()[qa], qa, *qb, {}});
}

void DifferenceTally::add(const RunScore& a, const RunScore& b) {
  for (Compared& compared : quantities_) {
    const double value = root_mean(squared_errors(a, compared.in_a)) - root_mean(squared_errors(b, compared.in_b));
    if (!std::isnan(value)) compared.differences.add(value);
  }
}

void DifferenceTally::exchange(TallyStream& stream) {
  for (Compared& compared : quantities_) compared.differences.exchange(stream);
}

std::vector<PairedDifference> DifferenceTally::differences() const {
  std::vector<PairedDifference> differences;
  for (const Compared& compared : quantities_) {
    const Estimate mean = compared.differences.mean();
    differences.push_back({compared.name, mean.value, mean.se, title_of(compared.name)});
  }
  return differences;
}

TrackerSummary summarise(const std::string& name, const Scorer& scorer, const std::vector<const RunScore*>& scores,
                         const ScoringRule& rule) {
  SummaryTally tally(name, scorer, rule);
  for (const RunScore* score : scores) tally.add(*score);
  return tally.summary();
}

std::vector<PairedDifference> paired_difference(const Scorer& scorer_a, const std::vector<const RunScore*>& a,
                                                const Scorer& scorer_b, const std::vector<const RunScore*>& b) {
  DifferenceTally tally(scorer_a, scorer_b);
  for (std::size_t run = 0; run < a.size(); ++run) tally.add(*a[run], *b[run]);
  return tally.differences();
}

}  // namespace truebearing
