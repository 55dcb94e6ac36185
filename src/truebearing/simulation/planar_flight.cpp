#include "truebearing/simulation/planar_flight.hpp"

#include <algorithm>
#include <cmath>

#include "truebearing/core/angle.hpp"

namespace truebearing {
namespace {

/// Turn rate as a function of the time flown: legs and turns, drawn as the time reaches them.
class TurnProgramme {
 public:
  TurnProgramme(const PlanarFlight& flight, RandomStream& stream)
      : flight_(flight), stream_(stream), roll_in_s_(flight.roll_in_s.draw(stream)) {
    end_s_ = flight_.leg_s.draw(stream_) * stream_.uniform();
  }

  /// Times must not decrease from call to call.
  double rate_radps(double time_s) {
    while (time_s >= end_s_) begin_next();
    if (!turning_) return 0.0;
    const double from_end_s = std::min(time_s - begin_s_, end_s_ - time_s);
    return roll_in_s_ > 0.0 ? rate_radps_ * std::min(1.0, from_end_s / roll_in_s_) : rate_radps_;
  }

 private:
  void begin_next() {
    turning_ = !turning_;
    begin_s_ = end_s_;
    if (!turning_) {
      end_s_ += flight_.leg_s.draw(stream_);
      return;
    }
    end_s_ += flight_.turn_s.draw(stream_);
    const double side = stream_.uniform() < 0.5 ? -1.0 : 1.0;
    rate_radps_ = side * radians(flight_.turn_rate_degps.draw(stream_));
  }

  const PlanarFlight& flight_;
  RandomStream& stream_;
  double roll_in_s_;
  bool turning_ = false;
  double begin_s_ = 0.0;
  double end_s_ = 0.0;
  double rate_radps_ = 0.0;
};

Eigen::Vector2d direction(double course_rad) {
  return {std::sin(course_rad), std::cos(course_rad)};
}

}  // namespace

Eigen::Matrix4Xd PlanarFlight::fly(double period_s, int samples, RandomStream& stream) const {
  constexpr double kMaxSubStep_s = 0.1;
  const double speed = speed_mps.draw(stream);
  double course_rad = stream.uniform(-kPi, kPi);
  TurnProgramme programme(*this, stream);

  const int sub_steps = static_cast<int>(std::ceil(period_s / kMaxSubStep_s));
  const double h = period_s / sub_steps;
  Eigen::Matrix4Xd track(4, samples);
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  for (int k = 0; k < samples; ++k) {
    track.col(k) << position_m, speed * direction(course_rad);
    for (int i = 0; i < sub_steps; ++i) {
      const double half_turn_rad = 0.5 * h * programme.rate_radps(k * period_s + (i + 0.5) * h);
      // The chord of an arc points along its middle.
      const double chord = std::abs(half_turn_rad) < 1e-8 ? 1.0 : std::sin(half_turn_rad) / half_turn_rad;
      position_m += speed * h * chord * direction(course_rad + half_turn_rad);
      course_rad += 2.0 * half_turn_rad;
    }
  }
  return track;
}

}  // namespace truebearing
