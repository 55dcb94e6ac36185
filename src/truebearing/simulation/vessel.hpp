// SPDX-License-Identifier: Apache-2.0
// A vessel at constant speed that changes course: straight legs and circular turns between them. Own ships and targets
// alike. Courses clockwise from North.
#pragma once

#include <optional>
#include <vector>

#include "truebearing/core/random.hpp"
#include "truebearing/io/table_reader.hpp"
#include "truebearing/measurement/measurement.hpp"
#include "truebearing/simulation/distribution.hpp"

namespace truebearing {

struct CourseChange {
  double time_s = 0.0;      ///< of its begin; one that begins before the last has ended waits for that
  double change_rad = 0.0;  ///< positive to starboard
  double rate_radps = 0.0;  ///< > 0; infinite for a turn on the spot
};

/// The path of one vessel.
class VesselPath {
 public:
  /// `changes` in the order of their times.
  VesselPath(const Eigen::Vector2d& start_m, double speed_mps, double course_rad,
             const std::vector<CourseChange>& changes);

  struct State {
    SensorState state;     ///< position and velocity
    bool turning = false;  ///< inside a turn, not at its very begin or end
  };
  /// At `time_s` >= 0.
  State at(double time_s) const;

  struct Turn {
    double begin_s;
    double end_s;
    double change_rad;  ///< positive to starboard
  };
  /// In the order of their times.
  const std::vector<Turn>& turns() const { return turns_; }
  /// The first one that begins before `end_s`, or nothing.
  std::optional<Turn> first_turn(double end_s) const {
    return turns_.empty() || turns_.front().begin_s >= end_s ? std::nullopt : std::optional(turns_.front());
  }

 private:
  struct Leg {
    double begin_s;
    Eigen::Vector2d position_m;
    double course_rad;
    double turn_rate_radps;  // 0 on a straight leg
  };
  double speed_mps_;
  std::vector<Leg> legs_;
  std::vector<Turn> turns_;
};

/// A vessel of a scenario; each run draws one.
struct VesselParameters {
  Distribution speed_mps = 0.0;
  Distribution course_deg = 0.0;
  /// Turns that are written down. The change is to a course, the short way, or by an angle.
  struct Turn {
    Distribution time_s = 0.0;
    Distribution angle_deg = 0.0;
    bool is_course = false;
    Distribution rate_degps = 3.0;
    double share = 1.0;        ///< probability that it happens at all
    bool either_side = false;  ///< port or starboard, with equal probability
  };
  std::vector<Turn> turns;
  /// Or turns at random: `count` of them, the first at first_s, others gap_s after the begin of the one before, by
  /// angle_deg to either side, all at one rate.
  struct RandomTurns {
    Distribution count = 1.0;
    Distribution first_s = 0.0;
    Distribution gap_s = 0.0;
    Distribution angle_deg = 0.0;
    Distribution rate_degps = 3.0;
  };
  std::optional<RandomTurns> random_turns;

  VesselPath draw(const Eigen::Vector2d& start_m, RandomStream& stream) const;
};

/// The keys speed_mps, course_deg, turns, random_turns of a vessel's table.
VesselParameters read_vessel(TableReader& table);

}  // namespace truebearing
