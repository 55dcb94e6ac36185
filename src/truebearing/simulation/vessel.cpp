// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/vessel.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "truebearing/core/angle.hpp"

namespace truebearing {
namespace {

Eigen::Vector2d velocity(double speed_mps, double course_rad) {
  return {speed_mps * std::sin(course_rad), speed_mps * std::cos(course_rad)};
}

// Where a leg that begins at the origin has come to after t seconds, on the chord of its arc.
Eigen::Vector2d sailed(double speed_mps, double course_rad, double turn_rate_radps, double t) {
  const double half = 0.5 * turn_rate_radps * t;
  const double chord = std::abs(half) > 1e-12 ? std::sin(half) / half : 1.0;
  return t * chord * velocity(speed_mps, course_rad + half);
}

Distribution read_rate(TableReader& table) {
  constexpr Range kRates{1e-6, 1e6};
  return read_distribution_or(table, "rate_degps", 3.0, kRates);
}

}  // namespace

VesselPath::VesselPath(const Eigen::Vector2d& start_m, double speed_mps, double course_rad,
                       const std::vector<CourseChange>& changes)
    : speed_mps_(speed_mps) {
  legs_.push_back({-std::numeric_limits<double>::infinity(), start_m, course_rad, 0.0});
  double last_s = 0.0;
  const auto begin = [&](double time_s, double course, double turn_rate) {
    const Leg& leg = legs_.back();
    legs_.push_back({time_s, leg.position_m + sailed(speed_mps_, leg.course_rad, leg.turn_rate_radps, time_s - last_s),
                     course, turn_rate});
    last_s = time_s;
  };
  for (const CourseChange& change : changes) {
    if (change.change_rad == 0.0) continue;
    const double course = legs_.back().course_rad, duration_s = std::abs(change.change_rad) / change.rate_radps;
    const double time_s = std::max(change.time_s, last_s);
    if (duration_s > 0.0) begin(time_s, course, std::copysign(change.rate_radps, change.change_rad));
    begin(time_s + duration_s, course + change.change_rad, 0.0);
    turns_.push_back({time_s, time_s + duration_s, change.change_rad});
  }
  legs_.front().begin_s = 0.0;
}

VesselPath::State VesselPath::at(double time_s) const {
  // A sample that rounding puts before the begin of a leg by this much still belongs to it.
  constexpr double kRounding_s = 1e-9;
  const auto after =
      std::find_if(legs_.begin() + 1, legs_.end(), [&](const Leg& leg) { return leg.begin_s > time_s + kRounding_s; });
  const Leg& leg = *(after - 1);
  const double t = time_s - leg.begin_s;
  return {{leg.position_m + sailed(speed_mps_, leg.course_rad, leg.turn_rate_radps, t),
           velocity(speed_mps_, leg.course_rad + leg.turn_rate_radps * t)},
          leg.turn_rate_radps != 0.0 && t > kRounding_s};
}

VesselPath VesselParameters::draw(const Eigen::Vector2d& start_m, RandomStream& stream) const {
  const double speed = speed_mps.draw(stream), start_course_rad = radians(course_deg.draw(stream));
  std::vector<CourseChange> changes;
  double course_rad = start_course_rad;
  const auto add = [&](double time_s, double change_rad, double rate_degps) {
    changes.push_back({time_s, change_rad, radians(rate_degps)});
    course_rad += change_rad;
  };
  for (const Turn& turn : turns) {
    const double time_s = turn.time_s.draw(stream), angle_rad = radians(turn.angle_deg.draw(stream));
    const double rate_degps = turn.rate_degps.draw(stream);
    const double side = turn.either_side && stream.uniform() < 0.5 ? -1.0 : 1.0;
    if (turn.share < 1.0 && stream.uniform() >= turn.share) continue;
    add(time_s, turn.is_course ? wrap_pi(angle_rad - course_rad) : side * angle_rad, rate_degps);
  }
  if (random_turns) {
    const double rate_degps = random_turns->rate_degps.draw(stream);
    const int count = static_cast<int>(random_turns->count.draw(stream));
    double time_s = random_turns->first_s.draw(stream);
    for (int i = 0; i < count; ++i) {
      const double angle_rad = radians(random_turns->angle_deg.draw(stream));
      add(time_s, stream.uniform() < 0.5 ? -angle_rad : angle_rad, rate_degps);
      time_s += random_turns->gap_s.draw(stream);
    }
  }
  return VesselPath(start_m, speed, start_course_rad, changes);
}

VesselParameters read_vessel(TableReader& table) {
  constexpr Range kTimes{0.0, 1e6};
  constexpr Range kAngles{-180.0, 180.0};
  VesselParameters vessel;
  vessel.speed_mps = read_distribution(table, "speed_mps", kNonNegative);
  vessel.course_deg = read_distribution(table, "course_deg");
  for (TableReader& read : table.tables("turns")) {
    VesselParameters::Turn turn;
    turn.is_course = read.one_of("to_deg", "by_deg") == "to_deg";
    turn.time_s = read_distribution(read, "time_s", kTimes);
    turn.angle_deg = turn.is_course ? read_distribution(read, "to_deg") : read_distribution(read, "by_deg", kAngles);
    turn.rate_degps = read_rate(read);
    turn.share = read.number_or("share", 1.0, {0.0, 1.0});
    turn.either_side = read.boolean_or("either_side", false);
    read.finish();
    vessel.turns.push_back(turn);
  }
  if (auto random = table.table_if_present("random_turns")) {
    if (!vessel.turns.empty()) throw table.error("random_turns", "stands beside turns", "one of them");
    VesselParameters::RandomTurns turns;
    turns.count = read_distribution_or(*random, "count", 1.0, {0.0, 100.0});
    turns.first_s = read_distribution(*random, "first_s", kTimes);
    turns.gap_s = read_distribution_or(*random, "gap_s", 0.0, kTimes);
    turns.angle_deg = read_distribution(*random, "angle_deg", {0.0, 180.0});
    turns.rate_degps = read_rate(*random);
    random->finish();
    vessel.random_turns = turns;
  }
  return vessel;
}

}  // namespace truebearing
