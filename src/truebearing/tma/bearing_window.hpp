// SPDX-License-Identifier: Apache-2.0
// The bearings that a batch estimate is made from, and the normal equations of the target's state over them: for a
// state in Cartesian coordinates (Cho 2015, equation 2), and for one in modified polar coordinates
// (modified_polar.hpp). Arrays by component, so that a pass over the window runs in SIMD instructions.
#pragma once

#include <span>
#include <vector>

#include "truebearing/measurement/measurement.hpp"
#include "truebearing/tma/normal_equations.hpp"

namespace truebearing {

struct BearingArrays;  // bearing_sums.hpp

class BearingWindow {
 public:
  /// Appends one bearing of a sensor that stands at site_m; times do not decrease. sigma_rad > 0.
  void add(double time_s, double bearing_rad, double sigma_rad, const Eigen::Vector2d& site_m);
  /// Drops what is older than `time_s`.
  void drop_before(double time_s);
  /// Those whose place is not in `left_out`, which rises.
  BearingWindow without(std::span<const std::size_t> left_out) const;
  void clear();
  void reserve(std::size_t count);

  std::size_t size() const { return time_s_.size(); }
  double time_s(std::size_t i) const { return time_s_[i]; }
  double first_time_s() const { return time_s_.front(); }
  double last_time_s() const { return time_s_.back(); }
  double bearing_rad(std::size_t i) const { return bearing_rad_[i]; }
  double weight(std::size_t i) const { return weight_[i]; }  ///< 1 / sigma^2
  Eigen::Vector2d site_m(std::size_t i) const { return {east_m_[i], north_m_[i]}; }
  /// All of them, until the window changes.
  BearingArrays arrays() const;

  /// F, J'Wr, J'WJ for x0 = [east, north, v_east, v_north] at time origin_s. Residuals wrap.
  NormalEquations<4> cartesian(const Eigen::Vector4d& x0, double origin_s) const;
  /// z - h(x0) of one bearing, in [-pi, pi], and its row of J.
  double residual(std::size_t i, const Eigen::Vector4d& x0, double origin_s) const;
  Eigen::RowVector4d jacobian(std::size_t i, const Eigen::Vector4d& x0, double origin_s) const;

 private:
  friend class ModifiedPolar;

  std::vector<double> time_s_, bearing_rad_, sine_, cosine_, weight_, east_m_, north_m_;
};

}  // namespace truebearing
