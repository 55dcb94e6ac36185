// SPDX-License-Identifier: Apache-2.0
// The share that frequencies have in the normal equations of a state in modified polar coordinates
// (modified_polar.hpp). In its frame, with r = 1/rho, own ship's departure e from the velocity of its line along and
// across the direction beta, and s^2 = u^2 + v^2,
//
//     v_r = [(r r'/r - e_par) u + (r beta' - e_perp) v] / s
//     u = 1 + (r'/r) tau - rho d_par,  v = beta' tau - rho d_perp
//
// The f0 of every level is taken at its best for y (variable projection: Golub and Pereyra 1973, with the normal matrix
// of Kaufman 1975, A_yy - A_yf A_ff^-1 A_fy), so that the parameters stay four whatever the source did. A level of one
// frequency says nothing.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "truebearing/tma/doppler_window.hpp"
#include "truebearing/tma/modified_polar.hpp"
#include "truebearing/tma/normal_equations.hpp"

namespace truebearing {

class DopplerTerm {
 public:
  /// `polar` has looked at the bearings of the same time. Copies what it needs; allocates only where the window is
  /// longer than any before. Without a window there is no share.
  void look_at(const ModifiedPolar& polar, const DopplerWindow* window);

  /// How many residuals there are, less the f0s that are fitted to them.
  std::size_t degrees_of_freedom() const { return time_s_.size() - levels_.size(); }
  bool empty() const { return time_s_.empty(); }

  /// Adds its share at y = [beta, beta', r'/r, 1/r]; not finite where the target stands on the sensor.
  void add(const Eigen::Vector4d& y, NormalEquations<4>& equations) const;

 private:
  struct Level {
    std::size_t end;  // of its frequencies
    double mean_hz;
  };

  double sound_mps_ = kSoundInWater_mps;
  // Level by level: time from the origin of the polar coordinates; the frequency less the mean of its level, so that no
  // sum cancels; weight; d and e.
  std::vector<double> time_s_, above_hz_, weight_, east_m_, north_m_, east_mps_, north_mps_;
  std::vector<Level> levels_;
};

}  // namespace truebearing
