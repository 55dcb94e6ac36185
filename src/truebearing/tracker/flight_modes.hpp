// SPDX-License-Identifier: Apache-2.0
// What a target of a planar flight (simulation/planar_flight.hpp) may be doing, and what it does to position and
// velocity over a step: legs, turns at constant speed and accelerations along the track, as that generator draws them.
// When a mode ends is not drawn beforehand: at each step it is drawn whether that comes, given that it has not come
// yet, which is the same in distribution and lets two copies of one particle part. Places and velocities are complex,
// east + j north.
#pragma once

#include <complex>
#include <limits>

#include "truebearing/core/random.hpp"
#include "truebearing/simulation/planar_flight.hpp"

namespace truebearing {

struct FlightMode {
  enum class Kind { quiet, first_leg, leg, turn, acceleration };

  Kind kind = Kind::quiet;
  double age_s = 0.0;
  /// Age at which it ends; infinite while that is not drawn. A manoeuvre's is drawn as its roll-out begins.
  double end_s = std::numeric_limits<double>::infinity();
  double full = 0.0;  ///< rad/s or m/s^2, signed; of a first leg that has no distribution of its own, that leg in s
  double roll_in_s = 0.0;

  bool manoeuvres() const { return kind == Kind::turn || kind == Kind::acceleration; }
};

/// What a step does to a target whose velocity was v, its speed s:
///     v' = turn v (1 + gain / s),    p' = p + (glide + drift / s) v.
/// The derivatives of gain and drift by s are not zero where the speed has come to a limit.
struct FlightStep {
  std::complex<double> turn = 1.0;
  std::complex<double> glide = 0.0;  ///< s
  std::complex<double> drift = 0.0;  ///< m
  double gain = 0.0;                 ///< m/s
  double gain_slope = 0.0;
  std::complex<double> drift_slope = 0.0;  ///< s
  /// Probability of what was drawn over the probability with which it was drawn.
  double weight = 1.0;
};

class FlightModes {
 public:
  /// Legs end `eagerness` times as often as they do in truth; FlightStep::weight makes up for it.
  explicit FlightModes(PlanarFlight flight, double eagerness = 1.0)
      : flight_(std::move(flight)), eagerness_(eagerness) {}

  const PlanarFlight& flight() const { return flight_; }
  /// Of a flight that begins.
  FlightMode first(RandomStream& stream) const;
  /// What a target at that speed does over dt_s.
  FlightStep advance(double dt_s, double speed_mps, FlightMode& mode, RandomStream& stream) const;

 private:
  void begin_next(FlightMode& mode, RandomStream& stream) const;
  void draw_end(double within_s, FlightMode& mode, double& weight, RandomStream& stream) const;
  double share_ended(const FlightMode& mode, double age_s) const;
  double age_at_end(const FlightMode& mode, double share) const;
  void glide(double dt_s, const FlightMode& mode, double speed_mps, FlightStep& step) const;

  PlanarFlight flight_;
  double eagerness_;
};

}  // namespace truebearing
