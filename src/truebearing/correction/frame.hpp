// SPDX-License-Identifier: Apache-2.0
// The frame that a correction works in. Where a target flies to does not matter to how a filter lags behind it: in the
// track frame errors and innovations are along and across the base's estimated velocity, so that what was learnt on one
// course holds on all of them. To a sensor of bearings it matters how a target is seen: in the sight frame they are
// along and across the line from the sensor to the base's estimate. In space both turn about the vertical alone: along
// and across are level, and up stays up.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "truebearing/core/bounded.hpp"
#include "truebearing/core/state_space.hpp"
#include "truebearing/measurement/measurement.hpp"

namespace truebearing {

enum class Frame {
  state,  ///< the state's own components
  track,  ///< of the plane: [along_m, cross_m, along_mps, cross_mps], cross to starboard; of space, up behind either two
  sight   ///< the same along the line of sight, cross clockwise; the axes do not turn with the sight
};

/// Names of the components of a state in that frame.
const StateSpace& space_in(Frame frame, const StateSpace& space);

/// +1 where the component of a state stays as it is for a mirrored target, -1 where it changes sign. In the track frame
/// the mirror stands along the track, in the sight frame along the line of sight; in the state's own every component
/// changes sign.
int component_parity(Frame frame, const StateSpace& space, int component);

/// The velocity in the plane of a state of the plane (4) or of space (6).
inline Eigen::Vector2d level_velocity(const BoundedVector& x) {
  return x.segment<2>(x.size() / 2);
}

/// The rotation into a frame, for one estimate: [u'; s'] with u along and s = (u_y, -u_x) to starboard, symmetric and
/// its own inverse.
class FrameRotation {
 public:
  FrameRotation() = default;
  /// x (n): the estimate whose velocity is the track, or that is seen from the sensor (from the origin where there is
  /// none). One that stands still is taken to head North, one at the sensor to be seen there.
  FrameRotation(Frame frame, const BoundedVector& x, const std::optional<SensorState>& sensor = {})
      : rotates_(frame != Frame::state) {
    if (!rotates_) return;
    Eigen::Vector2d direction = frame == Frame::track ? level_velocity(x) : x.head<2>();
    if (frame == Frame::sight && sensor) direction -= sensor->position_m;
    double squared = direction.squaredNorm();
    if (!(squared > 1e-200 && squared < 1e200)) {  // or a square may have lost its digits
      const double length = direction.stableNorm();
      if (!(length > 0.0)) return;
      direction /= length;
      squared = direction.squaredNorm();
    }
    along_ = direction / std::sqrt(squared);
  }

  /// Turns a state, or a position (the first half of one), into the frame. The way back is the same.
  template <typename Vector>
  void turn(Vector& v) const {
    if (!rotates_) return;
    const Eigen::Index n = v.size(), d = dimensions(n);
    const double x = along_.x(), y = along_.y();
#pragma GCC unroll 8
    for (Eigen::Index i = 0; i + 1 < n; i += d) {
      const double first = v[i], second = v[i + 1];
      v[i] = x * first + y * second;
      v[i + 1] = y * first - x * second;
    }
  }
  /// A copy that is turned.
  template <typename Derived>
  BoundedVector vector(const Eigen::MatrixBase<Derived>& x) const {
    BoundedVector turned = x;
    turn(turned);
    return turned;
  }
  /// One component of vector(x).
  template <typename Derived>
  double component(const Eigen::MatrixBase<Derived>& x, Eigen::Index i) const {
    const Eigen::Index place = dimensions(x.size()) == 3 ? i % 3 : i % 2, first = i - place;
    if (!rotates_ || place == 2) return x[i];
    return place == 0 ? along_.x() * x[first] + along_.y() * x[first + 1]
                      : along_.y() * x[first] - along_.x() * x[first + 1];
  }
  /// Turns a covariance of states, of which the lower half counts in the end.
  template <typename Matrix>
  void turn_covariance(Matrix& P) const {
    if (!rotates_) return;
    const Eigen::Index n = P.rows(), d = dimensions(n);
    const double x = along_.x(), y = along_.y();
    double* const data = P.data();
    // The rows of each column, then the columns of each row.
#pragma GCC unroll 8
    for (Eigen::Index j = 0; j < n; ++j)
#pragma GCC unroll 8
      for (Eigen::Index i = 0; i + 1 < n; i += d) {
        double *p = data + i + j * n, *q = p + 1;
        const double along = x * *p + y * *q, across = y * *p - x * *q;
        *p = along;
        *q = across;
      }
#pragma GCC unroll 8
    for (Eigen::Index j = 0; j + 1 < n; j += d)
#pragma GCC unroll 8
      for (Eigen::Index i = j; i < n; ++i) {
        double *p = data + i + j * n, *q = p + n;
        const double along = x * *p + y * *q, across = y * *p - x * *q;
        *p = along;
        *q = across;
      }
#pragma GCC unroll 8
    for (Eigen::Index j = 1; j < n; ++j)
#pragma GCC unroll 8
      for (Eigen::Index i = 0; i < j; ++i) data[i + j * n] = data[j + i * n];
  }
  /// A copy that is turned.
  BoundedMatrix covariance(const BoundedMatrix& P) const {
    BoundedMatrix turned = P;
    turn_covariance(turned);
    return turned;
  }
  /// Its diagonal.
  template <typename Matrix>
  auto variances(const Matrix& P) const {
    Eigen::Matrix<double, Matrix::RowsAtCompileTime, 1, 0, Matrix::MaxRowsAtCompileTime, 1> turned = P.diagonal();
    if (!rotates_) return turned;
    const Eigen::Index n = P.rows(), d = dimensions(n);
    const double x = along_.x(), y = along_.y();
#pragma GCC unroll 8
    for (Eigen::Index i = 0; i + 1 < n; i += d) {
      const double a = P(i, i), b = P(i + 1, i), c = P(i + 1, i + 1);
      turned[i] = x * (x * a + y * b) + y * (x * b + y * c);
      turned[i + 1] = y * (y * a - x * b) - x * (y * b - x * c);
    }
    return turned;
  }
  bool rotates() const {
    return rotates_;
  }
  const Eigen::Vector2d& along() const {
    return along_;
  }
  /// along(), or nullptr where the frame is the state's own.
  const double* axis() const {
    return rotates_ ? along_.data() : nullptr;
  }

 private:
  // Of a vector of the plane (2 or 4 components) or of space (3 or 6).
  static Eigen::Index dimensions(Eigen::Index size) {
    return size % 3 == 0 ? 3 : 2;
  }

  bool rotates_ = false;
  Eigen::Vector2d along_{0.0, 1.0};
};

std::string_view to_string(Frame frame);
/// Names of all frames, as studies and model files spell them, and the frame of one of these.
const std::vector<std::string>& frame_names();
Frame frame_of(std::string_view name);

}  // namespace truebearing
