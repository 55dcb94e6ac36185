// SPDX-License-Identifier: Apache-2.0
// The sample covariance of a line array's snapshots in real numbers. The covariance of uncorrelated signals at a
// uniform line array is centro-Hermitian, and a unitary transformation of pairs of sensors, one as far on this side of
// the middle as the other on that,
//     (x_+ + x_-) / sqrt(2),  (x_+ - x_-) / (j sqrt(2)),  and the sensor in the middle where there is one,
// makes it real (Lee 1980; Huarng and Yeh 1991), and steering vectors, their phases counted from the middle, as well:
//     a (M): sqrt(2) cos phi_i,  sqrt(2) sin phi_i,  1;   phi_i = 2 pi d/lambda p_i sin theta, p_i the distance from it
// The likelihood of the signals' model needs no more of the data than Re(R) of the transformed snapshots, and is exact.
// A dead sensor takes the other of its pair with it.
#pragma once

#include <Eigen/Core>

#include "truebearing/array/interval.hpp"

namespace truebearing {

/// Geometry of the transformed array, rows padded with zeros to whole lanes (simd_lanes.hpp).
struct RealArray {
  int pairs = 0;        ///< rows 0 .. pairs - 1 are the cosines, pairs .. 2 pairs - 1 the sines, then the middle
  bool middle = false;  ///< an odd number of sensors
  int padded = 0;       ///< rows
  double spacing_wavelengths = 0.5;
  Eigen::VectorXd live;  ///< (padded): 1 for rows that are used, 0 for those of dead sensors and the padding
  int live_rows = 0;

  /// Rows but the padding.
  int rows() const { return 2 * pairs + (middle ? 1 : 0); }
  /// Distance of pair i from the middle, in spacings.
  double position(int i) const { return middle ? i + 1.0 : i + 0.5; }
};

/// Of one block of snapshots.
struct RealCovariance {
  Eigen::MatrixXd R;  ///< (padded x padded), Re of the sample covariance; zero where a row is not live
  double snapshots = 0.0;
  double trace = 0.0;
  double time_s = 0.0;  ///< mean time of its snapshots, from the end of the interval
};

class RealInterval {
 public:
  /// Splits the usable snapshots into `blocks` of consecutive times, each with a covariance of its own. Allocates where
  /// the array is larger than any before.
  void take(const Interval& interval, int blocks);

  const RealArray& array() const { return array_; }
  /// Blocks that have snapshots, `count()` of them.
  const RealCovariance& block(int b) const { return blocks_[static_cast<std::size_t>(b)]; }
  int count() const { return count_; }
  double snapshots() const { return snapshots_; }

 private:
  RealArray array_;
  std::vector<RealCovariance> blocks_;
  int count_ = 0;
  double snapshots_ = 0.0;
  Eigen::MatrixXd rows_;  // transformed snapshots, real parts and imaginary ones as columns (padded x 2 Ns)
};

}  // namespace truebearing
