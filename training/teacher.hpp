// SPDX-License-Identifier: Apache-2.0
// The teacher: the same simulator, trackers and feature extractor as at run time, with the labels (truth minus
// estimate) joined afterwards by time and, where there are several targets, by track.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "truebearing/core/random.hpp"
#include "truebearing/correction/feature.hpp"
#include "truebearing/evaluation/monte_carlo.hpp"
#include "truebearing/evaluation/ranks.hpp"
#include "truebearing/simulation/scenario.hpp"
#include "truebearing/study/correction_spec.hpp"
#include "truebearing/tracker/ensemble.hpp"

namespace truebearing {

/// One row per taught step of a run, and at one step per target in their order, run after run. d features, n state
/// components. Everything but the features is in the units of the network's output: in the correction's frame, and
/// where the correction says so in standard deviations of the base there.
struct TeacherSet {
  std::vector<FeatureSpec> features;
  Eigen::MatrixXd X;          ///< (N x d), features in their units
  Eigen::MatrixXd Y;          ///< (N x n), truth - base estimate
  Eigen::MatrixXd reference;  ///< (N x n), reference estimate - base estimate
  /// Lower Cholesky factors, one (n n) to a row: of the covariance that the correction's own is made from, and of the
  /// reference's.
  Eigen::MatrixXd covariance_factors;
  Eigen::MatrixXd reference_factors;
  /// (N x 3): the shortest and the longest of the base's last intervals, NaN before it has one, and the time that it
  /// has coasted; seconds.
  Eigen::MatrixXd intervals;
  /// Of whole tracks, else empty: (N), whether a row is the first of its track, whether it is taught (where it is not,
  /// its label, factors and reference are zero), and whether the base used a measurement there, which a network
  /// remembers.
  std::vector<bool> begins, taught, used;
  /// Of rows that a smoother taught, else empty: (N x n), a draw of the error that it says its label has.
  Eigen::MatrixXd unsure = {};

  /// (N x n), of the truth, or as likely as that: what a covariance is to be fitted to.
  Eigen::MatrixXd errors(const Eigen::MatrixXd& outputs) const {
    return unsure.size() > 0 ? Eigen::MatrixXd(Y + unsure - outputs) : Eigen::MatrixXd(Y - outputs);
  }
  Eigen::Index rows() const { return X.rows(); }
  bool is_taught(Eigen::Index row) const { return taught.empty() || taught[static_cast<std::size_t>(row)]; }
};

/// |L^-1 e| per row, for errors e (N x n) and lower factors L (N x n n): their Mahalanobis lengths (N).
Eigen::VectorXd mahalanobis_lengths(const Eigen::MatrixXd& errors, const Eigen::MatrixXd& factors);

/// Quantile of chi-square beyond which the innovation of a teacher's filter says that its models do not fit.
inline constexpr double kSurprise = 0.999;

struct TeacherOptions {
  std::uint64_t seed = 1;
  Role role = Role::training;
  int threads = 0;
  Progress progress;
  /// Every row that the network is asked at, one track behind the other, for networks that remember.
  bool whole_tracks = false;
  Ranks* ranks = nullptr;  ///< share the runs; the first has the set, the others none of it
};

/// Runs `ensemble`, which has the members that `correction` names, over correction.training.runs runs of the scenario.
/// Where correction.training.teacher names one, a smoother among the members stands for the truth, of one target: a
/// step is taught with the probability by which the smoother knows more than its filter, the mean over the components
/// of 1 - P_s / P_f, in [0, 1]; none where it did not look back, and none where its own filter was surprised
/// (kSurprise). Steps without a record, with unknown truth, with features that are not finite or with an error of the
/// base beyond correction.training.leave_out_beyond are left out. Throws InputError where no step is left, or where the
/// truth lacks a component of the base's state or a quantity of those limits, all found by name.
TeacherSet collect_teacher_set(const Ensemble& ensemble, const CorrectionSpec& correction, const Scenario& scenario,
                               const TeacherOptions& options);

}  // namespace truebearing
