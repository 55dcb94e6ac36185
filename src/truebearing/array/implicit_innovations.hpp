// SPDX-License-Identifier: Apache-2.0
// ImplicitInnovation (angular_innovation.hpp) of all targets at once, as a tracker wants them: steering vectors and
// their derivatives as well, targets in the lanes of SIMD registers. Re(b^H a) = 0, as a steering vector turns at right
// angles to itself:
//     d_theta = Re(yb^H ya) / (|b|^2 - |yb|^2)
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "truebearing/array/angular_innovation.hpp"

namespace truebearing {

class ImplicitInnovations {
 public:
  /// At those predicted angles (N), of the subspace that W (rows of M and padding x N) spans; live (M): 0 for a sensor
  /// that hears nothing. Allocates where there are more of them than ever before.
  void find(const LineArray& array, std::span<const double> live, std::span<const double> angles_rad,
            const SplitMatrix<double>& W);

  AngularInnovation<double> operator[](std::size_t n) const { return {angle_[n], curvature_[n]}; }
  /// |b|^2
  double derivative_norm2(std::size_t n) const { return b2_[n]; }

 private:
  std::vector<double> theta_, angle_, curvature_, b2_;  // (lanes)
  std::vector<double> a_re_, a_im_;                     // (lanes x M)
  std::vector<double> ya_re_, ya_im_, yb_re_, yb_im_;   // (lanes x N)
  std::vector<double> L_re_, L_im_;                     // (N x N)
};

}  // namespace truebearing
