// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/flight_modes.hpp"

#include <algorithm>
#include <cmath>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/constants.hpp"

namespace truebearing {
namespace {

using Complex = std::complex<double>;
using Kind = FlightMode::Kind;

/// A manoeuvre that lasts so long begins to roll out at max(duration - roll-in, duration / 2); and the other way round.
double duration_of_roll_out(double age_s, double roll_in_s) {
  return std::min(age_s + roll_in_s, 2.0 * age_s);
}

/// Over dt_s: exp(j angle) at the end, and its integral; angle(t) = rate t + slope t^2 / 2.
struct Arc {
  Complex turned, along;
};

Arc arc(double dt_s, double rate_radps, double slope_radps2) {
  if (slope_radps2 == 0.0) {  // a chord points along the middle of its arc
    const double half_rad = 0.5 * rate_radps * dt_s, sine = std::sin(half_rad), cosine = std::cos(half_rad);
    const double chord_s = std::abs(half_rad) < 1e-8 ? dt_s : dt_s * sine / half_rad;
    return {{1.0 - 2.0 * sine * sine, 2.0 * sine * cosine}, {chord_s * cosine, chord_s * sine}};
  }
  constexpr double kPanel_rad = 0.5;  // of Simpson's rule
  const double largest_radps = std::max(std::abs(rate_radps), std::abs(rate_radps + slope_radps2 * dt_s));
  const int panels = std::clamp(static_cast<int>(std::ceil(largest_radps * dt_s / kPanel_rad)), 1, 1000);
  const double h = dt_s / (2 * panels);
  Arc arc{1.0, 1.0};
  for (int i = 1; i <= 2 * panels; ++i) {
    const double t = i * h, angle_rad = (rate_radps + 0.5 * slope_radps2 * t) * t;
    arc.turned = {std::cos(angle_rad), std::sin(angle_rad)};
    arc.along += (i == 2 * panels ? 1.0 : i % 2 == 1 ? 4.0 : 2.0) * arc.turned;
  }
  arc.along *= h / 3.0;
  return arc;
}

}  // namespace

FlightMode FlightModes::first(RandomStream& stream) const {
  FlightMode mode{Kind::first_leg};
  mode.roll_in_s = flight_.roll_in_s.draw(stream);
  if (!flight_.first_leg_s) mode.full = flight_.leg_s.draw(stream);
  if (flight_.quiet_share > 0.0 && stream.uniform() < flight_.quiet_share) mode.kind = Kind::quiet;
  return mode;
}

void FlightModes::begin_next(FlightMode& mode, RandomStream& stream) const {
  const bool was_manoeuvre = mode.manoeuvres();
  mode.age_s = 0.0;
  mode.end_s = kInfinity;
  mode.full = 0.0;
  if (was_manoeuvre) {
    mode.kind = Kind::leg;
    return;
  }
  const bool acceleration = flight_.acceleration_share > 0.0 && stream.uniform() < flight_.acceleration_share;
  mode.kind = acceleration ? Kind::acceleration : Kind::turn;
  const double side = stream.uniform() < 0.5 ? -1.0 : 1.0;
  mode.full =
      side * (acceleration ? flight_.acceleration_mps2.draw(stream) : radians(flight_.turn_rate_degps.draw(stream)));
}

// Probability that what ends the mode's open part has come by that age.
double FlightModes::share_ended(const FlightMode& mode, double age_s) const {
  switch (mode.kind) {
    case Kind::quiet:
      return 0.0;
    case Kind::first_leg:
      if (flight_.first_leg_s) return flight_.first_leg_s->share_below(age_s);
      return mode.full > 0.0 ? std::min(age_s / mode.full, 1.0) : 1.0;
    case Kind::leg:
      return flight_.leg_s.share_below(age_s);
    case Kind::turn:
      return flight_.turn_s.share_below(duration_of_roll_out(age_s, mode.roll_in_s));
    case Kind::acceleration:
      return flight_.acceleration_s.share_below(duration_of_roll_out(age_s, mode.roll_in_s));
  }
  return 0.0;
}

double FlightModes::age_at_end(const FlightMode& mode, double share) const {
  switch (mode.kind) {
    case Kind::quiet:
      return kInfinity;
    case Kind::first_leg:
      return flight_.first_leg_s ? flight_.first_leg_s->quantile(share) : share * mode.full;
    case Kind::leg:
      return flight_.leg_s.quantile(share);
    case Kind::turn:
      return flight_.turn_s.quantile(share);
    case Kind::acceleration:
      return flight_.acceleration_s.quantile(share);
  }
  return kInfinity;
}

// Draws whether the mode's open part ends within so long, and if so when the mode does.
void FlightModes::draw_end(double within_s, FlightMode& mode, double& weight, RandomStream& stream) const {
  const double before = share_ended(mode, mode.age_s), after = share_ended(mode, mode.age_s + within_s);
  if (after <= before && before < 1.0) return;  // cannot end here
  const double p = before < 1.0 ? (after - before) / (1.0 - before) : 1.0;
  const double q = mode.manoeuvres() || p >= 0.5 ? p : std::min(eagerness_ * p, 0.5);
  const double u = stream.uniform();
  if (u >= q) {
    weight *= (1.0 - p) / (1.0 - q);
    return;
  }
  weight *= p / q;
  const double end_s = age_at_end(mode, std::min(before + (after - before) * (u / q), 1.0));
  mode.end_s = std::max(end_s, mode.age_s);
}

// Over dt_s in which its rate changes linearly.
void FlightModes::glide(double dt_s, const FlightMode& mode, double speed_mps, FlightStep& step) const {
  double share = 1.0, slope = 0.0;  // of the full rate, per s
  if (mode.roll_in_s > 0.0 && mode.manoeuvres()) {
    const auto share_at = [&](double age_s) {
      return std::clamp(std::min(age_s, mode.end_s - age_s) / mode.roll_in_s, 0.0, 1.0);
    };
    share = share_at(mode.age_s);
    slope = (share_at(mode.age_s + dt_s) - share) / dt_s;
  }
  if (mode.kind == Kind::acceleration) {
    const double acceleration_mps2 = mode.full * (share + 0.5 * slope * dt_s);
    const double now_mps = speed_mps + step.gain;
    const double limit_mps = acceleration_mps2 < 0.0 ? std::min(now_mps, flight_.lowest_speed_mps)
                                                     : std::max(now_mps, flight_.highest_speed_mps);
    const double free_s = acceleration_mps2 == 0.0 ? dt_s : std::min((limit_mps - now_mps) / acceleration_mps2, dt_s);
    const double held_s = dt_s - free_s;  // at the limit
    const double gained_mps = acceleration_mps2 * free_s;
    step.glide += step.turn * dt_s;
    step.drift += step.turn * (step.gain * dt_s + gained_mps * (0.5 * free_s + held_s));
    step.gain += gained_mps;
    if (held_s > 0.0) {
      step.drift_slope += step.turn * (step.gain_slope * free_s - held_s);
      step.gain_slope = -1.0;
    } else {
      step.drift_slope += step.turn * (step.gain_slope * dt_s);
    }
    return;
  }
  const Arc flown = mode.kind == Kind::turn ? arc(dt_s, mode.full * share, mode.full * slope) : Arc{1.0, dt_s};
  const Complex along = flown.along * step.turn;
  step.glide += along;
  step.drift += step.gain * along;
  step.drift_slope += step.gain_slope * along;
  step.turn *= flown.turned;
}

FlightStep FlightModes::advance(double dt_s, double speed_mps, FlightMode& mode, RandomStream& stream) const {
  FlightStep step;
  double left_s = dt_s;
  while (left_s > 0.0) {
    if (mode.end_s == kInfinity) draw_end(left_s, mode, step.weight, stream);
    double part_s = std::min(left_s, mode.end_s - mode.age_s);
    // A manoeuvre's rate is linear between these ages only.
    if (mode.roll_in_s > 0.0 && mode.manoeuvres()) {
      const double roll_out_s = std::max(mode.end_s - mode.roll_in_s, 0.5 * mode.end_s);
      for (const double corner_s : {std::min(mode.roll_in_s, roll_out_s), roll_out_s})
        if (mode.age_s < corner_s) part_s = std::min(part_s, corner_s - mode.age_s);
    }
    if (part_s > 0.0) glide(part_s, mode, speed_mps, step);
    left_s -= part_s;
    mode.age_s += part_s;
    if (mode.age_s >= mode.end_s)
      begin_next(mode, stream);
    else if (part_s <= 0.0)
      break;  // of rounding
  }
  return step;
}

}  // namespace truebearing
