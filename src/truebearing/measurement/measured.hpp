// SPDX-License-Identifier: Apache-2.0
// What is measured: the kind, and the components of z with their units as logs name them. A sensor says what it takes,
// a scenario what it gives, and a study compares the two when it is read (study/measured_check.hpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "truebearing/core/state_space.hpp"

namespace truebearing {

inline constexpr int kMostSensors = 64;  ///< that one tracker reads

/// One of several sensors: its name, and the components of its z.
struct Source {
  std::string name;
  std::vector<std::string> components;
  bool operator==(const Source&) const = default;
};

struct Measured {
  std::string kind;                     ///< "position"; a sensor of another kind has a word of its own
  std::vector<std::string> components;  ///< of z, as Recording::measured: "east_m", "bearing_deg"; of several sensors
                                        ///< those of all, each once
  int sensors = 0;                      ///< of an array: that it has, or that are needed; 0 where nothing is said
  std::vector<Source> sources{};        ///< of several sensors: Measurement::source is a place among them

  bool operator==(const Measured& other) const {
    return kind == other.kind && components == other.components && sources == other.sources;
  }
  /// Its components are states then; what was measured beside them stands in the log alone.
  bool is_step_log() const { return kind == "step_log"; }

  /// On a line (1 dimension) "position_m", in the plane (2) "east_m" and "north_m", in space (3) "up_m" with them.
  static Measured position(int dimensions);
  /// On a line.
  static Measured position_velocity();
  static Measured range_bearing();
  static Measured bearing();
  static Measured bearing_frequency();
  /// The three components of the Lorenz attractor.
  static Measured lorenz();
  /// The blocks of a line array, which have no z.
  static Measured snapshots(int sensors = 0);
  /// Sensors that take turns.
  static Measured several(std::vector<Source> sources);
  /// What a tracker that ran elsewhere made of its measurements: states of that space.
  static Measured step_log(const StateSpace& space);
  /// The kind above that has these components; "values" where none has.
  static Measured of(std::vector<std::string> components);
};

/// "range_bearing (range_m, bearing_deg)".
std::string describe(const Measured& measured);

/// Why a tracker that takes `taken` cannot use what `giver` ("the scenario") gives, in words that follow the tracker's
/// name; nothing where it can. A bearing may come with a frequency, and a range with its
/// angles with a range rate, which are left alone. What a step log measured
/// is taken for what is wanted.
std::optional<std::string> mismatch(const Measured& taken, const Measured& given, const std::string& giver);

}  // namespace truebearing
