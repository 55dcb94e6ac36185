// SPDX-License-Identifier: Apache-2.0
// The one table from names of measurements in study files to sensors (tracker/any_sensor.hpp).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "truebearing/core/state_space.hpp"
#include "truebearing/io/table_reader.hpp"
#include "truebearing/tracker/any_sensor.hpp"
#include "truebearing/tracker/bearing_frequency_sensor.hpp"

namespace truebearing {

/// What a tracker measures, as its tables `measurement` and `space` say.
struct MeasurementChoice {
  std::string model;                  ///< "position"
  std::unique_ptr<AnySensor> sensor;  ///< in `space`
  const StateSpace* space;            ///< of the records
  bool has_frequency = false;         ///< the state has the frequency of the source behind the velocities
  bool second_order = false;          ///< the sensor adds the second order of a range rate
  std::vector<double> gate_nis_of{};  ///< of each of several sensors, where they have gates of their own; else empty

  bool is_lorenz() const { return *space == lorenz_space(); }
  int dimensions() const { return *space == line_space() ? 1 : *space == space_space() ? 3 : 2; }  ///< d, of positions
  /// Positions, velocities and what is measured with them: components that every state of these has.
  int leading() const { return 2 * dimensions() + (has_frequency ? 1 : 0); }
};

/// measurement = { model, bias, ... }, space = "line" | "plane" | "plane_frequency" | "space" | "lorenz". Standard
/// deviations are multiplied by `factor`, as hypotheses of a bank have it. model = "sensors" reads { use, sensors.NAME = { model, bias,
/// gate_probability, ... } }, of which a study fills in `sensors` from its own table of that name. Throws InputError.
MeasurementChoice read_measurement(TableReader& tracker, double factor = 1.0);

/// Does the tracker's `measurement` say this model?
bool measures(const TableReader& tracker, const std::string& model);

/// measurement = { model = "bearing_frequency", bearing_sigma_deg, frequency_sigma_hz, sigma_factor, sound_mps }.
BearingFrequencySensor read_bearing_frequency_sensor(TableReader& tracker);

}  // namespace truebearing
