// SPDX-License-Identifier: Apache-2.0
// The batch estimate of a target at constant velocity from bearings, and from Doppler-shifted frequencies where there
// are any: maximum likelihood, or maximum a posteriori where something is believed beforehand, by Levenberg-Marquardt
// in modified polar coordinates from a few starts. Before the range is observable the likelihood has no maximum at a
// finite range; a prior keeps the estimate, and biases it.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <vector>

#include "truebearing/tma/batch_estimate.hpp"
#include "truebearing/tma/bearing_window.hpp"
#include "truebearing/tma/doppler_term.hpp"
#include "truebearing/tma/levenberg_marquardt.hpp"
#include "truebearing/tma/modified_polar.hpp"
#include "truebearing/tma/observability.hpp"

namespace truebearing {

/// Gaussian beliefs on the velocity, and on the distance from a place at a time.
struct BatchPrior {
  Eigen::Vector2d velocity_mps = Eigen::Vector2d::Zero();
  Eigen::Matrix2d velocity_information = Eigen::Matrix2d::Zero();  ///< inverse of its covariance
  struct Range {
    double mean_m;
    double sigma_m;
    Eigen::Vector2d from_m;
    double time_s;
  };
  std::optional<Range> range;

  /// Adds its share at y.
  void add(const ModifiedPolar& polar, const Eigen::Vector4d& y, NormalEquations<4>& equations) const;
};

struct TargetMotionBatchOptions {
  /// For own ship that sails kilometres; in proportion where it sails less or more (ModifiedPolar::scale).
  std::vector<double> start_ranges_m{2500.0, 6000.0, 14000.0};
  bool start_grid = false;  ///< besides, from the 225 starts of Cho 2015: to see that a few are enough
  /// Bearings beyond are outliers (Huber 1964). Frequencies that are become levels of their own
  /// (frequency_changes.hpp).
  double huber_sigmas = std::numeric_limits<double>::infinity();
  int max_iterations = 60;
};

/// A minimum that is not the best but explains the bearings nearly as well.
struct Ambiguity {
  Eigen::Vector4d x;  ///< at the time of the estimate
  double cost;        ///< prior included, above the best
};

class TargetMotionBatch {
 public:
  explicit TargetMotionBatch(TargetMotionBatchOptions options = {})
      : options_(std::move(options)), polar_(options_.huber_sigmas) {}

  /// `found` is false for fewer than three bearings or where they all have one time. Starts from the ranges of the
  /// options and, where given, from `warm`: a state at the time of the last bearing; from nine more where all that
  /// these lead to misses the data by far. `frequencies`, where given: each level of them with an f0 of its own.
  BatchEstimate solve(const BearingWindow& window, const std::optional<BatchPrior>& prior = std::nullopt,
                      const Eigen::Vector4d* warm = nullptr, const DopplerWindow* frequencies = nullptr);
  /// From `start` alone, a state at the time of the last bearing; leaves what is told below as it is.
  BatchEstimate refine(const Eigen::Vector4d& start, const BearingWindow& window,
                       const std::optional<BatchPrior>& prior, const DopplerWindow* frequencies);

  // Of the last estimate that solve() found:

  /// By the data alone, without the prior.
  const Observability& observability() const { return observability_; }
  /// Minima within 1.92 of the best (95 % of a likelihood ratio) whose range differs by more than a fifth.
  const std::vector<Ambiguity>& ambiguities() const { return ambiguities_; }

 private:
  void look_at(const BearingWindow& window, const std::optional<BatchPrior>& prior, const DopplerWindow* frequencies);
  /// Without the prior's share.
  NormalEquations<4> data(const Eigen::Vector4d& y) const;
  NormalEquations<4> data(const Minimum<4>& minimum) const;
  NormalEquations<4> objective(const Eigen::Vector4d& y) const;
  LevenbergMarquardtOptions<4> descent_options() const;
  void descend(const Eigen::Vector4d& start, BatchEstimate& estimate);
  const Minimum<4>& best() const;
  void conclude(const Minimum<4>& minimum, BatchEstimate& estimate) const;
  /// 1/2 the sum of squares of the target infinitely far away that fits best.
  double cost_at_infinity(const Eigen::Vector4d& best) const;
  Eigen::Vector4d from_end(Eigen::Vector4d x) const;  // to y
  Eigen::Vector4d at_end(const Eigen::Vector4d& y) const;

  TargetMotionBatchOptions options_;
  ModifiedPolar polar_;
  DopplerTerm doppler_;
  std::optional<BatchPrior> prior_;
  double end_s_ = 0.0;  // the last bearing
  std::vector<Minimum<4>> minima_;
  Observability observability_;
  std::vector<Ambiguity> ambiguities_;
};

}  // namespace truebearing
