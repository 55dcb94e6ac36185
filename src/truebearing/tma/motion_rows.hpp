// SPDX-License-Identifier: Apache-2.0
// Residuals of bearings and frequencies about a target that keeps its course and speed, or changes its velocity once,
// and what they are made of to first order: rows of normalised residuals e = (z - h) / sigma with their derivatives by
//
//     y (4)   modified polar coordinates of the motion before the change (modified_polar.hpp)
//     dv (2)  the change of velocity at change_s, m/s
//     f0      of the frequency's level, which takes its best value
//
// What score tests and fits of a change are made from.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <span>
#include <vector>

#include "truebearing/tma/batch_estimate.hpp"
#include "truebearing/tma/bearing_window.hpp"
#include "truebearing/tma/doppler_window.hpp"
#include "truebearing/tma/modified_polar.hpp"
#include "truebearing/tma/normal_equations.hpp"

namespace truebearing {

struct MotionRow {
  double time_s;
  double residual;                           ///< e
  double per_unit;                           ///< 1 / sigma: derivative by a constant error of the sensor
  Eigen::RowVector4d of_y;                   ///< dh / dy / sigma
  Eigen::RowVector2d of_place, of_velocity;  ///< by the target's place and velocity at that time
  int level;                                 ///< of a frequency; -1 for a bearing
  double of_f0;

  /// By a change of the velocity at change_s.
  Eigen::RowVector2d of_change(double change_s) const {
    if (time_s <= change_s) return Eigen::RowVector2d::Zero();
    return (time_s - change_s) * of_place + of_velocity;
  }
};

class MotionRows {
 public:
  /// The windows must outlive this. `frequencies` may be nullptr.
  MotionRows(const BearingWindow& bearings, const DopplerWindow* frequencies);

  /// y at polar().origin_s().
  void look_at(const Eigen::Vector4d& y, const Eigen::Vector2d& dv_mps = Eigen::Vector2d::Zero(),
               double change_s = std::numeric_limits<double>::infinity());

  std::span<const MotionRow> all() const { return rows_; }
  std::span<const MotionRow> bearings() const { return std::span(rows_).first(bearings_.size()); }
  std::span<const MotionRow> frequencies() const { return std::span(rows_).subspan(bearings_.size()); }
  const ModifiedPolar& polar() const { return polar_; }

  /// For the derivatives that `of(row)` gives (1 x N), f0s at their best.
  template <int N, typename Of>
  NormalEquations<N> equations(const Of& of) const {
    NormalEquations<N> equations;
    std::vector<Eigen::Matrix<double, N, 1>> of_level(level_.size(), Eigen::Matrix<double, N, 1>::Zero());
    for (const MotionRow& row : rows_) {
      const Eigen::Matrix<double, N, 1> j = of(row).transpose();
      equations.cost += 0.5 * row.residual * row.residual;
      equations.gradient += row.residual * j;
      equations.A += j * j.transpose();
      if (row.level >= 0) of_level[static_cast<std::size_t>(row.level)] += row.of_f0 * j;
    }
    for (std::size_t l = 0; l < level_.size(); ++l)
      equations.A -= of_level[l] * of_level[l].transpose() / level_[l].information;
    return equations;
  }
  /// In [y, dv].
  NormalEquations<6> equations(double change_s) const;

  /// What the four of y (and f0) take of each row's variance: its leverage.
  std::vector<double> leverages(const Eigen::Matrix4d& P) const;

 private:
  struct Level {
    double product, information;  // of w g f and w g^2
  };
  void look_at_frequencies(const Eigen::Vector4d& x, const Eigen::Matrix4d& T, const Eigen::Vector2d& dv_mps,
                           double change_s);

  const BearingWindow& bearings_;
  const DopplerWindow* frequencies_;
  ModifiedPolar polar_;
  std::vector<MotionRow> rows_;
  std::vector<Level> level_;
};

/// y of an estimate.
Eigen::Vector4d polar_of(const BatchEstimate& estimate, const ModifiedPolar& polar);

/// Root L of the inverse L L' of an information matrix of four or six, without the directions of which it says nothing but rounding (less than a part in
/// 1e11 of what its diagonal says): nothing is taken along them.
template <int N>
Eigen::Matrix<double, N, N> root_of_inverse(const Eigen::Matrix<double, N, N>& information);
/// The inverse itself.
Eigen::Matrix4d inverse_of_what_is_known(const Eigen::Matrix4d& information);

}  // namespace truebearing
