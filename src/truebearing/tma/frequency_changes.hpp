// SPDX-License-Identifier: Apache-2.0
// Sources that change their tone: which of a window's frequencies belong to one level of f0, found by an edge detector
// (Kim and Song: |z_k - z_k-1| / (sqrt(2) sigma) against a threshold gamma) and, for jumps that are too small for it,
// by a score scan of the residuals after a batch. For every interval [a, b) of a level, w the weights, g = 1 - v_r / c:
//
//     s = sum_[a,b) w g r
//     V = the sum of w g^2 there less what the state and the levels' f0s can take of it
//
// s^2 / V is chi-square with one degree of freedom where f0 did not differ there. (The paper leaves out the frequencies
// once an edge is found. One f0 for each level costs no accuracy.) A target that changes its velocity sounds much like
// a small jump of its tone, and is taken for one.
#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "truebearing/tma/outliers.hpp"
#include "truebearing/tma/target_motion_batch.hpp"

namespace truebearing {

struct FrequencyChangeOptions {
  enum class Handling {
    ignored,        ///< one f0 for all: wrong where the source did change
    bearings_only,  ///< as the paper: with an edge anywhere, no frequency is used
    segments,       ///< one f0 from edge to edge
    levels          ///< segments of equal f0 made one, and small jumps looked for
  };
  Handling handling = Handling::levels;
  double false_alarm_probability = 1.5e-6;  ///< of the edge detector, per pair of frequencies
  double scan_threshold = 25.0;             ///< of s^2 / V, over all intervals
  /// Likelihood ratio, 2 ln, below which two levels are one: three standard deviations, for trackers, which see every
  /// jump anew with each solution and follow small ones.
  double alike = 9.0;
  int most_splits = 8;  ///< by the scan
  /// Before the scan splits a level: is it the target that changed its velocity (velocity_change.hpp)? Where that
  /// explains more, the tone is left in peace. Costs tens of milliseconds where there is something to split.
  bool weigh_manoeuvres = false;

  /// Where given, in place of both thresholds: how often a change is found in a window of one tone. A third of it is
  /// the scan's, whose n^2 / 2 intervals overlap: they are as good as 10 n that do not (simulated, n from 43 to 900).
  std::optional<double> by_chance;

  /// For one answer about a whole log, where a change that was none is believed: no level is kept that the scan would
  /// not have told apart (among many pieces some differ by three standard deviations by chance), and manoeuvres are
  /// weighed.
  static FrequencyChangeOptions of_a_log() {
    FrequencyChangeOptions options;
    options.by_chance = 1e-3;
    options.weigh_manoeuvres = true;
    return options;
  }
};

/// From this frequency on the source has another f0.
struct FrequencyChange {
  double time_s;
  double frequency_hz;
};

/// Frequencies that keep one level, strays of other levels among them apart.
struct LevelRun {
  int level;
  std::size_t begin, end;  ///< its first frequency, and one past its last
  std::size_t count;       ///< of its own
};
/// In order of time. A level that is kept for less than four frequencies in a row is no level of the source: outliers
/// come in twos and threes by chance. Where none is kept for longer, the longest is.
void list_runs(const DopplerWindow& frequencies, std::vector<LevelRun>& runs);

/// The number of edges so far, for each frequency. `gamma` in standard deviations of a difference.
void number_segments(const DopplerWindow& frequencies, double gamma, std::vector<int>& segment);
/// The same, but up to three in a row that are followed by one like those before are strays: segments of their own, past
/// which that before goes on. Else outliers would cut a level into pieces whose means differ by chance, and the more
/// pieces, the more. A jump hardly larger than gamma may be taken for one, and is left to the scan.
void number_segments_past_strays(const DopplerWindow& frequencies, double gamma, std::vector<int>& segment);

/// The interval whose f0 differs most from that of its level: the positions of its frequencies in the window, of which
/// those of other levels do not count.
struct IntervalScore {
  double statistic = 0.0;
  std::size_t begin = 0, end = 0;
  int level = 0;
};

/// Batch estimates from bearings and from the frequencies of a source that may change its tone.
class FrequencyChangeBatch {
 public:
  explicit FrequencyChangeBatch(FrequencyChangeOptions options = {});

  /// As TargetMotionBatch::solve, which does the work. Sets the levels of `frequencies`.
  BatchEstimate solve(TargetMotionBatch& batch, const BearingWindow& window, DopplerWindow& frequencies,
                      const std::optional<BatchPrior>& prior = std::nullopt, const Eigen::Vector4d* warm = nullptr);

  // Of the last call of solve():

  /// False where they were left out.
  bool used_frequencies() const { return used_; }
  /// Less than four frequencies in a row are outliers and no change, or not yet (list_runs).
  std::span<const FrequencyChange> changes() const { return changes_; }
  /// The level that the source has at the end.
  int last_level() const { return last_level_; }

  /// Of the score scan, and of the likelihood ratio of two levels, in a window of so many frequencies.
  double scan_threshold(std::size_t frequencies) const;
  double alike(std::size_t frequencies) const;

  /// The score scan at an estimate that was made from these levels.
  IntervalScore scan(const DopplerWindow& frequencies, const BatchEstimate& estimate);

 private:
  /// Makes levels one until no two are alike; false where there was nothing to do.
  bool merge(TargetMotionBatch& batch, const BearingWindow& window, const std::optional<BatchPrior>& prior,
             DopplerWindow& frequencies, BatchEstimate& estimate);
  void find_levels(TargetMotionBatch& batch, const BearingWindow& window, DopplerWindow& frequencies,
                   const std::optional<BatchPrior>& prior, BatchEstimate& estimate);
  void find_levels_without(std::span<const std::size_t> outliers, TargetMotionBatch& batch, const BearingWindow& window,
                           DopplerWindow& frequencies, const std::optional<BatchPrior>& prior, BatchEstimate& estimate);
  bool manoeuvre_explains_more(const BearingWindow& window, const DopplerWindow& frequencies,
                               const BatchEstimate& estimate, const IntervalScore& interval) const;
  /// Each that does not belong to its neighbours of the same level; false where there is none.
  bool set_strays_apart(DopplerWindow& frequencies, const BatchEstimate& estimate);
  void split(const IntervalScore& interval, DopplerWindow& frequencies);
  void list_changes(const DopplerWindow& frequencies, const BatchEstimate& estimate);

  FrequencyChangeOptions options_;
  double gamma_;
  bool used_ = true;
  int last_level_ = 0;
  std::vector<FrequencyChange> changes_;

  // Scratch.
  struct Sum {
    double residual, information;  // of w g r, w g^2
    Eigen::Vector4d coupling;      // of w g J L, with P = L L'
    std::size_t begin;             // the place of the frequency that comes next
  };
  struct Ranked {
    double frequency_hz;
    int level;
    std::size_t first;  // frequency that has it
  };
  std::vector<Sum> sums_;
  std::vector<Ranked> ranked_;
  std::vector<SourceFrequency> sources_;
  std::vector<int> level_, merged_;
  std::vector<LevelRun> runs_;
  OutlierSearch find_outliers_;
  std::vector<std::size_t> members_;
  std::vector<double> residuals_;
  std::vector<std::pair<std::size_t, std::size_t>> apart_;
};

}  // namespace truebearing
