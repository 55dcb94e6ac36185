// SPDX-License-Identifier: Apache-2.0
// How a place in space is seen from a sensor: range, bearing (azimuth, clockwise from North) and elevation above the
// horizontal, in m and rad, and their derivatives in the place (3). What measurement models of space share.
//     range = |p|,  bearing = atan2(east, north),  elevation = atan2(up, h),  h = hypot(east, north)
// Straight above the sensor the bearing has no derivative, at the sensor nothing has; they are zero there, so that such
// a measurement leaves the state alone.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace truebearing {

template <typename Scalar>
struct SightInSpace {
  using Place = Eigen::Matrix<Scalar, 3, 1>;

  Scalar range_m;
  Scalar bearing_rad;    ///< in [-pi, pi]
  Scalar elevation_rad;  ///< in [-pi/2, pi/2]
  Place along;           ///< the unit vector from the sensor, d range / d place
  Place bearing_slope;   ///< d bearing / d place, rad/m
  Place elevation_slope;

  /// p: east, north and up of the sensor.
  explicit SightInSpace(const Place& p) {
    const Scalar h = std::hypot(p(0), p(1));
    range_m = std::hypot(h, p(2));
    bearing_rad = std::atan2(p(0), p(1));
    elevation_rad = std::atan2(p(2), h);
    const Scalar inverse_range = range_m > 0 ? 1 / range_m : Scalar(0), inverse_h = h > 0 ? 1 / h : Scalar(0);
    const Scalar sine = p(0) * inverse_h, cosine = p(1) * inverse_h;
    along = p * inverse_range;
    bearing_slope << cosine * inverse_h, -sine * inverse_h, 0;
    elevation_slope << -along(2) * sine, -along(2) * cosine, h * inverse_range;
    elevation_slope *= inverse_range;
  }

  /// The speed away of a target that moves by w (3) against the sensor, and its derivative in the place.
  Scalar range_rate(const Place& w) const { return along.dot(w); }
  Place range_rate_slope(const Place& w) const {
    return range_m > 0 ? Place((w - along * along.dot(w)) / range_m) : Place(Place::Zero());
  }
};

}  // namespace truebearing
