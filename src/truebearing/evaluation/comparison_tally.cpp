// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/comparison_tally.hpp"

#include <string>
#include <utility>

#include "truebearing/core/error.hpp"

namespace truebearing {
namespace {

std::size_t index_of(const TrackerSet& trackers, const std::string& name) {
  for (int i = 0; i < trackers.size(); ++i)
    if (trackers.name(i) == name) return static_cast<std::size_t>(i);
  throw InputError("scoring", "there is no tracker \"" + name + "\" in this comparison");
}

}  // namespace

std::vector<std::optional<CorrectionTally>> correction_tallies(const TrackerSet& trackers) {
  std::vector<std::optional<CorrectionTally>> tallies(static_cast<std::size_t>(trackers.size()));
  for (int i = 0; i < trackers.size(); ++i)
    if (const Correction* correction = trackers.correction(i))
      tallies[static_cast<std::size_t>(i)].emplace(*correction);
  return tallies;
}

ComparisonTally::ComparisonTally(const TrackerSet& trackers, const std::vector<Scorer>& scorers,
                                 const ComparisonOptions& options, std::size_t kept_apart, bool details)
    : options_(options) {
  for (std::size_t i = 0; i < scorers.size(); ++i) {
    const std::string& name = trackers.name(static_cast<int>(i));
    trackers_.push_back(
        {SummaryTally(name, scorers[i], options.scoring, kept_apart), MetricTallies(options.scoring, scorers[i]), {}});
    if (details) details_.emplace_back(scorers[i].dimension());
  }
  if (options.details) corrections_ = correction_tallies(trackers);
  if (!options.global_minimum.empty()) global_minimum_ = index_of(trackers, options.global_minimum);
  for (const auto& [a, b] : options.pairs) {
    const std::size_t ia = index_of(trackers, a), ib = index_of(trackers, b);
    pairs_.push_back(
        {ia, ib, DifferenceTally(scorers[ia], scorers[ib]), PairTallies(options.scoring, scorers[ia], scorers[ib])});
  }
}

void ComparisonTally::add(const RunOutcome& run) {
  for (std::size_t i = 0; i < trackers_.size(); ++i) {
    trackers_[i].summary.add(run.scores[i]);
    trackers_[i].metrics.add(run.scores[i]);
    if (!details_.empty()) details_[i].add(run.scores[i]);
    if (!corrections_.empty() && corrections_[i]) corrections_[i]->add(*run.corrections[i]);
    if (global_minimum_ && *global_minimum_ != i)
      trackers_[i].global_minimum.add(run.scores[i], run.scores[*global_minimum_]);
  }
  for (Pair& pair : pairs_) {
    pair.rmse.add(run.scores[pair.a], run.scores[pair.b]);
    pair.metrics.add(run.scores[pair.a], run.scores[pair.b]);
  }
  if (options_.cramer_rao) bound_.add(run.bound);
  if (options_.angle_bound) angle_bound_.add(run.angle_bound);
}

void ComparisonTally::exchange(TallyStream& stream) {
  for (OfTracker& tracker : trackers_) {
    tracker.summary.exchange(stream);
    tracker.metrics.exchange(stream);
    tracker.global_minimum.exchange(stream);
  }
  for (std::optional<CorrectionTally>& correction : corrections_)
    if (correction) correction->exchange(stream);
  for (Pair& pair : pairs_) {
    pair.rmse.exchange(stream);
    pair.metrics.exchange(stream);
  }
  bound_.exchange(stream);
  angle_bound_.exchange(stream);
  for (DetailsTally& details : details_) details.exchange(stream);
}

std::string ComparisonTally::bytes(bool compact) {
  TallyStream stream(compact);
  exchange(stream);
  return std::move(stream).written();
}

void ComparisonTally::add(std::string_view bytes) {
  TallyStream stream(bytes);
  exchange(stream);
  if (!details_.empty() || !options_.details) stream.finish();
}

Comparison ComparisonTally::comparison() const {
  Comparison comparison;
  comparison.seed = options_.seed;
  comparison.runs = options_.runs;
  comparison.bounds = options_.bounds;
  if (options_.angle_bound) comparison.angle_bounds = angle_bound_.summaries();
  if (options_.cramer_rao) comparison.cramer_rao = bound_.summary(options_.scoring.times_s);
  for (const OfTracker& tracker : trackers_) {
    TrackerSummary& summary = comparison.trackers.emplace_back(tracker.summary.summary());
    const auto add_metrics = [&](const std::vector<Metric>& metrics) {
      summary.metrics.insert(summary.metrics.end(), metrics.begin(), metrics.end());
    };
    add_metrics(tracker.metrics.metrics());
    if (options_.cramer_rao) add_metrics(range_efficiency(summary.metrics, comparison.cramer_rao->metrics));
    add_metrics(tracker.global_minimum.metrics());
  }
  for (const DetailsTally& tally : details_) comparison.details.push_back(tally.details());
  for (const std::optional<CorrectionTally>& tally : corrections_) {
    comparison.corrections.emplace_back();
    if (tally) comparison.corrections.back() = tally->details();
  }
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const auto& [a, b] = options_.pairs[i];
    Comparison::Pair& pair = comparison.pairs.emplace_back(Comparison::Pair{a, b, pairs_[i].rmse.differences()});
    for (PairedDifference& difference : pairs_[i].metrics.differences())
      pair.differences.push_back(std::move(difference));
  }
  return comparison;
}

}  // namespace truebearing
