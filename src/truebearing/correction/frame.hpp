// SPDX-License-Identifier: Apache-2.0
// The frame that a correction works in. Where a target flies to does not matter to how a filter lags behind it: in the
// track frame errors and innovations are along and across the base's estimated velocity, so that what was learnt on one
// course holds on all of them. To a sensor of bearings it matters how a target is seen: in the sight frame they are
// along and across the line from the sensor to the base's estimate. In space both turn about the vertical alone: along and
// across are level, and up stays up.
#pragma once

#include <Eigen/Core>
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

/// The rotation into a frame, for one estimate.
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
    const double length = direction.stableNorm();
    along_ = length > 0.0 ? Eigen::Vector2d(direction / length) : Eigen::Vector2d(0.0, 1.0);
  }

  /// A state, or a position (the first half of one), in the frame. The way back is the same.
  template <typename Derived>
  BoundedVector vector(const Eigen::MatrixBase<Derived>& x) const {
    BoundedVector turned = x;
    if (rotates_)
      for (Eigen::Index i = 0, d = dimensions(x.size()); i < turned.size(); i += d)
        turned.segment<2>(i) = turn(turned.segment<2>(i));
    return turned;
  }
  /// One component of vector(x).
  template <typename Derived>
  double component(const Eigen::MatrixBase<Derived>& x, Eigen::Index i) const {
    const Eigen::Index place = i % dimensions(x.size()), first = i - place;
    if (!rotates_ || place == 2) return x[i];
    return place == 0 ? along_.x() * x[first] + along_.y() * x[first + 1]
                      : along_.y() * x[first] - along_.x() * x[first + 1];
  }
  /// A covariance of states in the frame, and back.
  BoundedMatrix covariance(const BoundedMatrix& P) const {
    if (!rotates_) return P;
    const Eigen::Index n = P.rows(), d = dimensions(n);
    BoundedMatrix turned(n, n);
    const double *from = P.data(), x = along_.x(), y = along_.y();
    double* to = turned.data();
    for (Eigen::Index j = 0; j < n; ++j)  // the rows of each column, then the columns of each row
      for (Eigen::Index i = 0; i < n; i += d) {
        const double* p = from + i + j * n;
        double* q = to + i + j * n;
        q[0] = x * p[0] + y * p[1];
        q[1] = y * p[0] - x * p[1];
        if (d == 3) q[2] = p[2];
      }
    for (Eigen::Index j = 0; j < n; j += d)
      for (Eigen::Index i = 0; i < n; ++i) {
        double *p = to + i + j * n, *q = p + n;
        const double along = x * *p + y * *q, across = y * *p - x * *q;
        *p = along;
        *q = across;
      }
    return turned;
  }
  bool rotates() const { return rotates_; }
  const Eigen::Vector2d& along() const { return along_; }

 private:
  // Of a vector of the plane (2 or 4 components) or of space (3 or 6).
  static Eigen::Index dimensions(Eigen::Index size) { return size % 3 == 0 ? 3 : 2; }

  // [u'; s'] with u along and s = (u_y, -u_x) to starboard: symmetric and its own inverse.
  Eigen::Vector2d turn(const Eigen::Vector2d& p) const {
    return {along_.x() * p.x() + along_.y() * p.y(), along_.y() * p.x() - along_.x() * p.y()};
  }

  bool rotates_ = false;
  Eigen::Vector2d along_{0.0, 1.0};
};

std::string_view to_string(Frame frame);
/// Names of all frames, as studies and model files spell them, and the frame of one of these.
const std::vector<std::string>& frame_names();
Frame frame_of(std::string_view name);

}  // namespace truebearing
