// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tma/frequency_changes.hpp"

#include <algorithm>
#include <cmath>

#include "truebearing/core/chi_square.hpp"
#include "truebearing/core/linear_algebra.hpp"
#include "truebearing/tma/outlier_deletion.hpp"
#include "truebearing/tma/velocity_change.hpp"

namespace truebearing {

namespace {

constexpr std::size_t kFewestInARow = 4;  // frequencies: fewer are strays

double sigmas_apart(const DopplerWindow& frequencies, std::size_t i, std::size_t j) {
  return std::abs(frequencies.frequency_hz(i) - frequencies.frequency_hz(j)) /
         std::hypot(frequencies.sigma_hz(i), frequencies.sigma_hz(j));
}

// By the bearings alone: levels that are not yet found would be taken for misfits of the bearings.
std::vector<Outlier> outliers_among(TargetMotionBatch& batch, const BearingWindow& window) {
  constexpr std::size_t kFewest = 5;
  if (window.size() < kFewest) return {};
  const BatchEstimate estimate = batch.solve(window);
  if (!estimate.found) return {};
  return OutlierDeletion(window, nullptr).find(estimate);
}

}  // namespace

using Handling = FrequencyChangeOptions::Handling;

void number_segments(const DopplerWindow& frequencies, double gamma, std::vector<int>& segment) {
  segment.assign(frequencies.size(), 0);
  for (std::size_t i = 1; i < frequencies.size(); ++i)
    segment[i] = segment[i - 1] + (sigmas_apart(frequencies, i, i - 1) < gamma ? 0 : 1);
}

void number_segments_past_strays(const DopplerWindow& frequencies, double gamma, std::vector<int>& segment) {
  const std::size_t n = frequencies.size();
  segment.assign(n, 0);
  const auto comes_back = [&](std::size_t i, std::size_t last) {
    for (std::size_t j = i + 1; j < std::min(n, i + kFewestInARow); ++j)
      if (sigmas_apart(frequencies, j, last) < gamma) return true;
    return false;
  };
  int edges = 0;
  for (std::size_t i = 1, last = 0; i < n; ++i) {
    const bool same = sigmas_apart(frequencies, i, last) < gamma;
    segment[i] = same ? segment[last] : ++edges;
    if (same || !comes_back(i, last)) last = i;
  }
}

void list_runs(const DopplerWindow& frequencies, std::vector<LevelRun>& runs) {
  const std::size_t n = frequencies.size();
  const auto end_of_row = [&](std::size_t begin) {
    std::size_t end = begin + 1;
    while (end < n && frequencies.level(end) == frequencies.level(begin)) ++end;
    return end;
  };
  std::size_t longest = 0;
  for (std::size_t begin = 0, end; begin < n; begin = end)
    longest = std::max(longest, (end = end_of_row(begin)) - begin);
  runs.clear();
  for (std::size_t begin = 0, end; begin < n; begin = end) {
    end = end_of_row(begin);
    const int level = frequencies.level(begin);
    const bool goes_on = !runs.empty() && runs.back().level == level;
    if (!goes_on && end - begin < std::min(longest, kFewestInARow)) continue;
    if (!goes_on) {
      runs.push_back({level, begin, end, 0});
      // What came before it among strays.
      const std::size_t since = runs.size() > 1 ? runs[runs.size() - 2].end : 0;
      for (std::size_t i = begin; i-- > since;)
        if (frequencies.level(i) == level) {
          runs.back().begin = i;
          ++runs.back().count;
        }
    }
    runs.back().end = end;
    runs.back().count += end - begin;
  }
}

FrequencyChangeBatch::FrequencyChangeBatch(FrequencyChangeOptions options)
    : options_(options), gamma_(normal_quantile(1.0 - 0.5 * options.false_alarm_probability)) {}

double FrequencyChangeBatch::scan_threshold(std::size_t frequencies) const {
  constexpr double kIntervals = 10.0;  // of each frequency
  constexpr double kWays = 3.0;        // to a false change: an edge, a stray that goes on, the scan
  if (!options_.by_chance) return options_.scan_threshold;
  return chi_square_quantile(1.0 - *options_.by_chance / (kWays * kIntervals * static_cast<double>(frequencies)), 1.0);
}

double FrequencyChangeBatch::alike(std::size_t frequencies) const {
  return options_.by_chance ? scan_threshold(frequencies) : options_.alike;
}

BatchEstimate FrequencyChangeBatch::solve(TargetMotionBatch& batch, const BearingWindow& window,
                                          DopplerWindow& frequencies, const std::optional<BatchPrior>& prior,
                                          const Eigen::Vector4d* warm) {
  if (options_.handling == Handling::ignored)
    level_.assign(frequencies.size(), 0);
  else if (options_.handling == Handling::levels)
    number_segments_past_strays(frequencies, gamma_, level_);
  else
    number_segments(frequencies, gamma_, level_);
  frequencies.set_levels(level_);
  used_ = options_.handling != Handling::bearings_only || frequencies.levels() <= 1;
  BatchEstimate estimate = batch.solve(window, prior, warm, used_ ? &frequencies : nullptr);
  if (estimate.found && options_.handling == Handling::levels && frequencies.size() > 0) {
    const bool steady =
        frequencies.levels() == 1 && scan(frequencies, estimate).statistic <= scan_threshold(frequencies.size());
    if (!steady) {
      // Bearings that are outliers pull at the state, and the frequencies then seem to disagree with it.
      // The thorough search is for one answer about a log; trackers, which solve anew and anew, allocate nothing.
      const std::vector<Outlier> thorough = options_.by_chance ? outliers_among(batch, window) : std::vector<Outlier>();
      const std::span<const Outlier> outliers =
          options_.by_chance ? std::span(thorough) : find_outliers_(window, estimate);
      if (outliers.empty())
        find_levels(batch, window, frequencies, prior, estimate);
      else
        find_levels_without(places(outliers), batch, window, frequencies, prior, estimate);
      // The first solution may have been led astray; from all starts once more.
      const BatchEstimate again = batch.solve(window, prior, &estimate.x, &frequencies);
      if (again.found) estimate = again;
    }
  }
  list_changes(frequencies, estimate);
  return estimate;
}

void FrequencyChangeBatch::find_levels(TargetMotionBatch& batch, const BearingWindow& window,
                                       DopplerWindow& frequencies, const std::optional<BatchPrior>& prior,
                                       BatchEstimate& estimate) {
  const auto refine = [&] {
    const BatchEstimate refined = batch.refine(estimate.x, window, prior, &frequencies);
    if (refined.found) estimate = refined;
  };
  apart_.clear();
  merge(batch, window, prior, frequencies, estimate);
  if (set_strays_apart(frequencies, estimate)) {
    refine();
    merge(batch, window, prior, frequencies, estimate);
  }
  for (int splits = 0; splits < options_.most_splits; ++splits) {
    const IntervalScore interval = scan(frequencies, estimate);
    if (interval.statistic <= scan_threshold(frequencies.size())) break;
    const bool long_enough = interval.end - interval.begin >= kFewestInARow;
    if (options_.weigh_manoeuvres && long_enough && manoeuvre_explains_more(window, frequencies, estimate, interval))
      break;
    split(interval, frequencies);
    refine();
    merge(batch, window, prior, frequencies, estimate);
  }
}

void FrequencyChangeBatch::find_levels_without(std::span<const std::size_t> outliers, TargetMotionBatch& batch,
                                               const BearingWindow& window, DopplerWindow& frequencies,
                                               const std::optional<BatchPrior>& prior, BatchEstimate& estimate) {
  const BearingWindow rest = window.without(outliers);
  const BatchEstimate better = batch.solve(rest, prior, &estimate.x, &frequencies);
  if (!better.found) return;
  estimate = better;
  find_levels(batch, rest, frequencies, prior, estimate);
}

bool FrequencyChangeBatch::merge(TargetMotionBatch& batch, const BearingWindow& window,
                                 const std::optional<BatchPrior>& prior, DopplerWindow& frequencies,
                                 BatchEstimate& estimate) {
  bool merged = false;
  while (frequencies.levels() > 1) {
    // Those that are most alike are neighbours in order of their frequencies.
    frequencies.sources(estimate.x, estimate.time_s, sources_);
    ranked_.resize(sources_.size());
    for (std::size_t l = 0; l < sources_.size(); ++l) ranked_[l] = {sources_[l].frequency_hz, static_cast<int>(l), 0};
    for (std::size_t i = frequencies.size(); i-- > 0;)
      ranked_[static_cast<std::size_t>(frequencies.level(i))].first = i;
    std::sort(ranked_.begin(), ranked_.end(),
              [](const Ranked& a, const Ranked& b) { return a.frequency_hz < b.frequency_hz; });
    double least = alike(frequencies.size());
    const Ranked *one = nullptr, *other = nullptr;
    for (std::size_t k = 1; k < ranked_.size(); ++k) {
      const SourceFrequency& a = sources_[static_cast<std::size_t>(ranked_[k - 1].level)];
      const SourceFrequency& b = sources_[static_cast<std::size_t>(ranked_[k].level)];
      const double difference = b.frequency_hz - a.frequency_hz;
      const SourceFrequency joint{difference, a.variance + b.variance, b.per_state - a.per_state};
      const double statistic = difference * difference / joint.variance_with(estimate.P);
      const std::pair<std::size_t, std::size_t> pair = std::minmax(ranked_[k - 1].first, ranked_[k].first);
      if (!(statistic < least) || std::find(apart_.begin(), apart_.end(), pair) != apart_.end()) continue;
      least = statistic;
      one = &ranked_[k - 1];
      other = &ranked_[k];
    }
    if (!one) break;

    // The statistic is as good as the covariance; what the data say of it is the likelihood ratio.
    for (std::size_t i = 0; i < frequencies.size(); ++i) level_[i] = frequencies.level(i);
    merged_ = level_;
    std::replace(merged_.begin(), merged_.end(), other->level, one->level);
    frequencies.set_levels(merged_);
    const auto are_one = [&](const BatchEstimate& joint) {
      return joint.found && 2.0 * (joint.objective - estimate.objective) < alike(frequencies.size());
    };
    BatchEstimate refined = batch.refine(estimate.x, window, prior, &frequencies);
    // Where the range is open the way from one minimum to the other is long: of one answer about a log, from all starts
    // before it is denied.
    if (options_.by_chance && !are_one(refined)) refined = batch.solve(window, prior, &estimate.x, &frequencies);
    if (are_one(refined)) {
      estimate = refined;
      merged = true;
    } else {
      frequencies.set_levels(level_);
      apart_.push_back(std::minmax(one->first, other->first));
    }
  }
  return merged;
}

IntervalScore FrequencyChangeBatch::scan(const DopplerWindow& frequencies, const BatchEstimate& estimate) {
  constexpr double kRounding = 1e-6;
  constexpr std::size_t kMostPlaces = 400;
  Eigen::Matrix4d L;
  cholesky(estimate.P, L);
  frequencies.sources(estimate.x, estimate.time_s, sources_);
  IntervalScore best;
  for (int level = 0; level < frequencies.levels(); ++level) {
    const double f0 = sources_[static_cast<std::size_t>(level)].frequency_hz;
    Sum sum{0.0, 0.0, Eigen::Vector4d::Zero(), 0};
    sums_.clear();
    for (std::size_t i = 0; i < frequencies.size(); ++i) {
      if (frequencies.level(i) != level) continue;
      sum.begin = i;
      sums_.push_back(sum);
      const DopplerWindow::Shift g = frequencies.shift(i, estimate.x, estimate.time_s);
      const double weighted = frequencies.weight(i) * g.value;
      sum.residual += weighted * (frequencies.frequency_hz(i) - f0 * g.value);
      sum.information += weighted * g.value;
      sum.coupling += weighted * f0 * (g.per_state * L).transpose();
    }
    const std::size_t n = sums_.size(), step = 1 + n / kMostPlaces;
    sum.begin = frequencies.size();
    sums_.push_back(sum);
    // Intervals from the first frequency on are the rest of those to the last.
    for (std::size_t a = 1; a < n; a += step) {
      const Sum& from = sums_[a];
      for (std::size_t b = a + 1;; b = std::min(b + step, n)) {
        const Sum& to = sums_[b];
        const double s = to.residual - from.residual, information = to.information - from.information;
        const double share = information / sum.information;
        const Eigen::Vector4d coupling = to.coupling - from.coupling - share * sum.coupling;
        const double V = information * (1.0 - share) - coupling.squaredNorm();
        if (V > kRounding * information && s * s > best.statistic * V) best = {s * s / V, from.begin, to.begin, level};
        if (b == n) break;
      }
    }
  }
  return best;
}

// (One change of velocity has two unknowns and a time; one interval of another tone an unknown and two times.)
bool FrequencyChangeBatch::manoeuvre_explains_more(const BearingWindow& window, const DopplerWindow& frequencies,
                                                   const BatchEstimate& estimate, const IntervalScore& interval) const {
  VelocityChangeScan changes(window, &frequencies, estimate);
  if (changes.times() == 0) return false;
  return 2.0 * (estimate.cost - changes.fit().cost) > interval.statistic;
}

// Outliers at the end of a window have no edge behind them, and a state that is hardly known gives way to them.
bool FrequencyChangeBatch::set_strays_apart(DopplerWindow& frequencies, const BatchEstimate& estimate) {
  frequencies.sources(estimate.x, estimate.time_s, sources_);
  const int levels = frequencies.levels();
  int fresh = levels;
  level_.resize(frequencies.size());
  for (std::size_t i = 0; i < frequencies.size(); ++i) level_[i] = frequencies.level(i);
  for (int level = 0; level < levels; ++level) {
    members_.clear();
    residuals_.clear();
    const double f0 = sources_[static_cast<std::size_t>(level)].frequency_hz;
    for (std::size_t i = 0; i < frequencies.size(); ++i) {
      if (frequencies.level(i) != level) continue;
      const double shifted_hz = f0 * frequencies.shift(i, estimate.x, estimate.time_s).value;
      members_.push_back(i);
      residuals_.push_back((frequencies.frequency_hz(i) - shifted_hz) / frequencies.sigma_hz(i));
    }
    for (const Outlier& outlier : find_outliers_(residuals_)) {
      if (fresh == levels) apart_.clear();  // what was unlike a level with strays may be like it without them
      level_[members_[outlier.at]] = fresh++;
      apart_.push_back(std::minmax(members_.front(), members_[outlier.at]));
    }
  }
  if (fresh > levels) frequencies.set_levels(level_);
  return fresh > levels;
}

void FrequencyChangeBatch::split(const IntervalScore& interval, DopplerWindow& frequencies) {
  const int fresh = frequencies.levels();
  for (std::size_t i = 0; i < frequencies.size(); ++i) {
    const bool inside = i >= interval.begin && i < interval.end && frequencies.level(i) == interval.level;
    level_[i] = inside ? fresh : frequencies.level(i);
  }
  frequencies.set_levels(level_);
}

void FrequencyChangeBatch::list_changes(const DopplerWindow& frequencies, const BatchEstimate& estimate) {
  changes_.clear();
  last_level_ = std::max(frequencies.levels() - 1, 0);
  if (frequencies.size() > 0) last_level_ = frequencies.level(frequencies.size() - 1);
  if (!estimate.found) return;
  frequencies.sources(estimate.x, estimate.time_s, sources_);
  list_runs(frequencies, runs_);
  for (std::size_t k = 1; k < runs_.size(); ++k)
    changes_.push_back(
        {frequencies.time_s(runs_[k].begin), sources_[static_cast<std::size_t>(runs_[k].level)].frequency_hz});
  if (!runs_.empty()) last_level_ = runs_.back().level;
}

}  // namespace truebearing
