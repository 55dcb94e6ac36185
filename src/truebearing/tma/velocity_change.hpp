// SPDX-License-Identifier: Apache-2.0
// Did a target change its velocity inside a window, and when? The model of one course and speed is set against that of
// two, velocity v until t_c and v + dv from then on, at a number of times t_c. In two steps:
//
// A score test at the least-squares estimate. With e the normalised residuals, J their rows by the motion (and the f0s)
// and G those by dv at t_c, what the motion can take is projected out of both,
//
//     g = G'e - G'J (J'J)^-1 J'e,  S = G'G - G'J (J'J)^-1 J'G,  g' S^-1 g
//
// which is chi-square with two degrees of freedom where there was no change, also where the estimate is not quite the
// minimum (J'e is not 0) and in geometries that leave the range open: directions of which the data say nothing are taken
// out of neither.
//
// The likelihood ratio: twice what the fit of both velocities gains over the fit of one. It holds where a change is
// large and the score, which sees it from a wrong estimate, would date it late. Same law.
#pragma once

#include <Eigen/Core>

#include "truebearing/tma/batch_estimate.hpp"
#include "truebearing/tma/motion_rows.hpp"

namespace truebearing {

struct VelocityChange {
  double time_s = 0.0;  ///< of a change at once: the middle of a turn
  /// With 95 % it was between these, among the times that were looked at.
  double earliest_s = 0.0, latest_s = 0.0;
  Eigen::Vector2d change_mps = Eigen::Vector2d::Zero();
  double end_s = 0.0;                           ///< of the last bearing
  Eigen::Vector4d x = Eigen::Vector4d::Zero();  ///< [east, north, v_east, v_north] there
  Eigen::Matrix4d P = Eigen::Matrix4d::Zero();
  double cost = 0.0;  ///< 1/2 the sum of squares that is left

  /// The course and speed before it, as a state at that time; without P.
  BatchEstimate before(double at_s) const;
};

class VelocityChangeScan {
 public:
  /// At most so many times are looked at.
  static constexpr std::size_t kMostTimes = 40;

  /// `least_squares`: the estimate of one course and speed from these windows, which must outlive this.
  VelocityChangeScan(const BearingWindow& bearings, const DopplerWindow* frequencies,
                     const BatchEstimate& least_squares);

  std::size_t times() const { return times_.size(); }
  /// The statistic that the largest over all times passes with this probability at most (Bonferroni).
  double threshold(double by_chance) const;
  struct Score {
    double statistic = 0.0, time_s = 0.0;
  };
  /// The largest score; nothing of it in windows of fewer than twelve bearings.
  Score largest_score() const;
  /// The best fit with a change; its time to the measurement. times() > 0.
  VelocityChange fit();

  /// The rows at the estimate of one course and speed.
  const MotionRows& rows() const { return rows_; }
  /// The rows at what fit() found last.
  const MotionRows& rows_of_the_fit() const { return tried_; }

 private:
  using State = Eigen::Matrix<double, 6, 1>;  // [y, dv]
  struct Fit {
    std::size_t at;  // the bearing after which the velocity changes
    State state;
    double cost;
  };
  Fit fit_at(std::size_t bearing, const State& start);
  Fit better_at(std::size_t bearing, const State& neighbour);
  VelocityChange conclude(const Fit& best);

  const BearingWindow& bearings_;
  MotionRows rows_;   // stay at the estimate
  MotionRows tried_;  // of the fits
  Eigen::Vector4d y_;
  std::vector<std::size_t> times_;  // bearings after which a change is looked for
};

}  // namespace truebearing
