// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/planar_flight.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/constants.hpp"

namespace truebearing {
namespace {

struct Rates {
  double turn_radps = 0.0;
  double acceleration_mps2 = 0.0;
};

/// Turn rate and acceleration as functions of the time flown: legs and manoeuvres, drawn as the time reaches them.
class Programme {
 public:
  Programme(const PlanarFlight& flight, RandomStream& stream)
      : flight_(flight), stream_(stream), roll_in_s_(flight.roll_in_s.draw(stream)) {
    end_s_ = flight.first_leg_s ? flight.first_leg_s->draw(stream_) : flight_.leg_s.draw(stream_) * stream_.uniform();
    if (flight.quiet_share > 0.0 && stream_.uniform() < flight.quiet_share) end_s_ = kInfinity;
  }

  /// Times must not decrease from call to call.
  Rates rates(double time_s) {
    while (time_s >= end_s_) begin_next();
    if (!manoeuvring_) return {};
    manoeuvre_end_s_ = end_s_;
    const double from_end_s = std::min(time_s - begin_s_, end_s_ - time_s);
    const double share = roll_in_s_ > 0.0 ? std::min(1.0, from_end_s / roll_in_s_) : 1.0;
    return {share * full_.turn_radps, share * full_.acceleration_mps2};
  }

  /// Whether the rates are zero from the time of the last call to that one.
  bool is_straight_to(double time_s) const { return !manoeuvring_ && time_s < end_s_; }

  double since_manoeuvre_s(double time_s) const { return std::max(time_s - manoeuvre_end_s_, 0.0); }

 private:
  void begin_next() {
    manoeuvring_ = !manoeuvring_;
    begin_s_ = end_s_;
    if (!manoeuvring_) {
      end_s_ += flight_.leg_s.draw(stream_);
      return;
    }
    full_ = {};
    const bool acceleration = flight_.acceleration_share > 0.0 && stream_.uniform() < flight_.acceleration_share;
    end_s_ += (acceleration ? flight_.acceleration_s : flight_.turn_s).draw(stream_);
    const double side = stream_.uniform() < 0.5 ? -1.0 : 1.0;
    if (acceleration)
      full_.acceleration_mps2 = side * flight_.acceleration_mps2.draw(stream_);
    else
      full_.turn_radps = side * radians(flight_.turn_rate_degps.draw(stream_));
  }

  const PlanarFlight& flight_;
  RandomStream& stream_;
  double roll_in_s_;
  bool manoeuvring_ = false;
  double begin_s_ = 0.0;
  double end_s_ = 0.0;
  double manoeuvre_end_s_ = -kInfinity;  // of the last one that was entered
  Rates full_;
};

Eigen::Vector2d direction(double course_rad) {
  return {std::sin(course_rad), std::cos(course_rad)};
}

/// f of the argument that it had before is not computed again: most of a flight is flown at one rate, much of it on one
/// course.
template <typename Function>
class Remembered {
 public:
  explicit Remembered(Function f) : f_(f), value_(f(0.0)) {}

  const auto& operator()(double argument) {
    if (argument != argument_) value_ = f_(argument_ = argument);
    return value_;
  }

 private:
  Function f_;
  double argument_ = 0.0;
  decltype(std::declval<Function>()(0.0)) value_;
};

/// The chord of an arc of twice that angle, as a share of its length.
double chord_share(double half_turn_rad) {
  return std::abs(half_turn_rad) < 1e-8 ? 1.0 : std::sin(half_turn_rad) / half_turn_rad;
}

}  // namespace

FlownTrack PlanarFlight::fly(std::span<const double> times_s, RandomStream& stream) const {
  constexpr double kMaxSubStep_s = 0.1;
  constexpr double kRounding = 1e-9;  // of times, in sub-steps
  double speed = speed_mps.draw(stream);
  double course_rad = stream.uniform(-kPi, kPi);
  const auto samples = static_cast<Eigen::Index>(times_s.size());
  if (intervals) {
    FlownTrack track{{}, Eigen::VectorXd::Zero(samples)};
    track.states = intervals->fly(times_s, speed * direction(course_rad), stream, track.end_s);
    return track;
  }
  Programme programme(*this, stream);
  FlownTrack track{Eigen::Matrix4Xd(4, samples), Eigen::VectorXd(samples)};
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  Remembered chord(chord_share);
  Remembered heading(direction), course(direction);  // of a sub-step, and where a sample is taken
  for (Eigen::Index k = 0; k < samples; ++k) {
    const double begin_s = times_s[static_cast<std::size_t>(k)];
    track.states.col(k) << position_m, speed * course(course_rad);
    track.since_manoeuvre_s[k] = programme.since_manoeuvre_s(begin_s);
    if (k + 1 == samples) break;
    const double dt_s = times_s[static_cast<std::size_t>(k) + 1] - begin_s;
    const int sub_steps = std::max(1, static_cast<int>(std::ceil(dt_s / kMaxSubStep_s - kRounding)));
    const double h = dt_s / sub_steps;
    const auto middle_s = [&](int i) { return begin_s + (i + 0.5) * h; };
    for (int i = 0; i < sub_steps; ++i) {
      const Rates rates = programme.rates(middle_s(i));
      if (programme.is_straight_to(middle_s(sub_steps - 1))) {  // the rest of the way
        const Eigen::Vector2d way_m = speed * h * heading(course_rad);
        for (; i < sub_steps; ++i) position_m += way_m;
        break;
      }
      const double half_turn_rad = 0.5 * h * rates.turn_radps;
      const double next_speed = rates.acceleration_mps2 == 0.0
                                    ? speed
                                    : std::clamp(speed + h * rates.acceleration_mps2, std::min(speed, lowest_speed_mps),
                                                 std::max(speed, highest_speed_mps));
      // The chord of an arc points along its middle.
      position_m += 0.5 * (speed + next_speed) * h * chord(half_turn_rad) * heading(course_rad + half_turn_rad);
      course_rad += 2.0 * half_turn_rad;
      speed = next_speed;
    }
  }
  return track;
}

PlanarFlight read_planar_flight(TableReader flight) {
  // Shorter than this, a leg or a turn is none, and the programme of a flight would not end.
  constexpr Range kDuration{0.1, 1e6};

  PlanarFlight parameters;
  parameters.speed_mps = read_distribution(flight, "speed_mps", kPositive);
  if (flight.has("intervals")) {
    FlightIntervals& intervals = parameters.intervals.emplace();
    intervals.count = read_distribution(flight, "intervals", {1.0, 1e4});
    intervals.interval_s = read_distribution(flight, "interval_s", kDuration);
    intervals.along_mps2 = read_distribution(flight, "along_mps2");
    intervals.across_mps2 = read_distribution(flight, "across_mps2");
    intervals.hold_s = flight.number_or("hold_s", 1.0, kDuration);
    flight.finish();
    return parameters;
  }
  if (flight.has("first_leg_s")) parameters.first_leg_s = read_distribution(flight, "first_leg_s", kNonNegative);
  parameters.leg_s = read_distribution(flight, "leg_s", kDuration);
  parameters.turn_s = read_distribution(flight, "turn_s", kDuration);
  parameters.turn_rate_degps = read_distribution(flight, "turn_rate_degps", kNonNegative);
  parameters.roll_in_s = read_distribution(flight, "roll_in_s", kNonNegative);
  parameters.acceleration_share = flight.number_or("acceleration_share", 0.0, {0.0, 1.0});
  if (parameters.acceleration_share > 0.0) {
    parameters.acceleration_s = read_distribution(flight, "acceleration_s", kDuration);
    parameters.acceleration_mps2 = read_distribution(flight, "acceleration_mps2", kNonNegative);
    parameters.lowest_speed_mps = flight.number_or("lowest_speed_mps", 0.0, kNonNegative);
    parameters.highest_speed_mps = flight.number_or("highest_speed_mps", 1e9, kPositive);
  }
  parameters.quiet_share = flight.number_or("quiet_share", 0.0, {0.0, 1.0});
  flight.finish();
  return parameters;
}

}  // namespace truebearing
