// SPDX-License-Identifier: Apache-2.0
// How a filter begins: from a prior that belongs to a time, from its first measurement, or from its first two.
#pragma once

#include <Eigen/Core>
#include <variant>

#include "truebearing/core/bounded.hpp"
#include "truebearing/tma/range_prior.hpp"

namespace truebearing {

/// x ~ N(x, P) at time_s, before any measurement.
struct PriorStart {
  BoundedVector x;
  BoundedMatrix P;
  double time_s = 0.0;
};

/// From one measured position z (d) with covariance R: x = [z, 0], P = diag(R, sigma^2).
struct OnePointStart {
  double velocity_sigma_mps = 0.0;  ///< per axis
  double rest_sigma = 0.0;          ///< of each component behind the velocities, which begin at 0
  double position_sigma_m = 0.0;    ///< per axis, in place of R where it is given; else 0
  double climb_sigma_mps = 0.0;     ///< in space of v_up, in place of velocity_sigma_mps where it is given; else 0
};

/// Two-point differencing (Bar-Shalom, Li and Kirubarajan 2001, sec. 5.5.3) of measured positions z1, z2 (d), dt apart,
/// for states [position (d), velocity (d)]: x = [z2, (z2 - z1) / dt], P = [R2, R2/dt; R2/dt, (R1 + R2)/dt^2].
struct TwoPointStart {
  double rest_sigma = 0.0;  ///< of each component behind the velocities, which begin at 0
};

/// From another tracker's estimate (successor.hpp), and not before.
struct HandOverStart {
  double rest_sigma = 0.0;  ///< of each component that the other does not have; they begin at 0
};

/// Bearings tell no position: their tracks begin with the first of them and what is believed of the range.
using Start = std::variant<PriorStart, OnePointStart, TwoPointStart, RangePrior, HandOverStart>;

/// A measured position (d) and its covariance (d x d), as a track may begin with.
struct PositionFix {
  BoundedVector z;
  BoundedMatrix R;
};

PriorStart one_point_state(PositionFix fix, const OnePointStart& start);
/// With the climb that the prior believes in, where it does and the state is one in space: its component 5.
PriorStart with_climb(PriorStart start, double climb_sigma_mps);
/// dt_s > 0.
PriorStart two_point_state(const PositionFix& first, const PositionFix& second, double dt_s);

/// [x, 0] and diag(P, rest_sigma^2) with `states` components, at least as many as x has.
PriorStart lengthened(const PriorStart& start, int states, double rest_sigma);

}  // namespace truebearing
