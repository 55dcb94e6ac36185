#include "truebearing/tma/frequency_changes.hpp"

#include <algorithm>
#include <cmath>

#include "truebearing/core/chi_square.hpp"
#include "truebearing/core/linear_algebra.hpp"

namespace truebearing {

using Handling = FrequencyChangeOptions::Handling;

void number_segments(const DopplerWindow& frequencies, double gamma, std::vector<int>& segment) {
  segment.assign(frequencies.size(), 0);
  for (std::size_t i = 1; i < frequencies.size(); ++i) {
    const double difference = frequencies.frequency_hz(i) - frequencies.frequency_hz(i - 1);
    const double sigma = std::hypot(frequencies.sigma_hz(i), frequencies.sigma_hz(i - 1));
    segment[i] = segment[i - 1] + (std::abs(difference) < gamma * sigma ? 0 : 1);
  }
}

FrequencyChangeBatch::FrequencyChangeBatch(FrequencyChangeOptions options)
    : options_(options), gamma_(normal_quantile(1.0 - 0.5 * options.false_alarm_probability)) {}

BatchEstimate FrequencyChangeBatch::solve(TargetMotionBatch& batch, const BearingWindow& window,
                                          DopplerWindow& frequencies, const std::optional<BatchPrior>& prior,
                                          const Eigen::Vector4d* warm) {
  if (options_.handling == Handling::ignored)
    level_.assign(frequencies.size(), 0);
  else
    number_segments(frequencies, gamma_, level_);
  frequencies.set_levels(level_);
  used_ = options_.handling != Handling::bearings_only || frequencies.levels() <= 1;
  BatchEstimate estimate = batch.solve(window, prior, warm, used_ ? &frequencies : nullptr);
  if (estimate.found && options_.handling == Handling::levels) {
    apart_.clear();
    bool changed = merge(batch, window, prior, frequencies, estimate);
    for (int splits = 0; splits < options_.most_splits; ++splits) {
      const IntervalScore interval = scan(frequencies, estimate);
      if (interval.statistic <= options_.scan_threshold) break;
      split(interval, frequencies);
      const BatchEstimate refined = batch.refine(estimate.x, window, prior, &frequencies);
      if (refined.found) estimate = refined;
      changed = true;
      merge(batch, window, prior, frequencies, estimate);
    }
    // The first solution may have been led astray; from all starts once more.
    if (changed) estimate = batch.solve(window, prior, &estimate.x, &frequencies);
  }
  list_changes(frequencies, estimate);
  return estimate;
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
    double least = options_.alike;
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
    const BatchEstimate refined = batch.refine(estimate.x, window, prior, &frequencies);
    if (refined.found && 2.0 * (refined.objective - estimate.objective) < options_.alike) {
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
  int current = -1;
  for (std::size_t i = 1; i < frequencies.size(); ++i) {
    const int level = frequencies.level(i);
    if (level == current || level != frequencies.level(i - 1)) continue;  // one alone is none
    if (current >= 0)
      changes_.push_back({frequencies.time_s(i - 1), sources_[static_cast<std::size_t>(level)].frequency_hz});
    current = level;
  }
  if (current >= 0) last_level_ = current;
}

}  // namespace truebearing
