// SPDX-License-Identifier: Apache-2.0
// A sensor at the origin of East, North and up, with Gaussian noise. What it can measure is one table, space_outputs().
// The table [sensor] of scenarios in space.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "truebearing/core/random.hpp"
#include "truebearing/io/table_reader.hpp"
#include "truebearing/measurement/measured.hpp"
#include "truebearing/measurement/measurement.hpp"

namespace truebearing {

/// One kind of measurement: a row of the table.
struct SpaceOutput {
  using State = Eigen::Matrix<double, 6, 1>;

  std::string name;  ///< of the scenario's key `output`
  Measured measured;
  BoundedVector (*h)(const State& state);  ///< of a target at [east, north, up, v_east, v_north, v_up]
  std::vector<std::string> sigma_keys;     ///< of the standard deviations of z; one for all of a position
  int bearing = -1;                        ///< place of a bearing in z, which wraps
  bool has_range_rate = false;             ///< z begins with a range and ends with its rate
};

/// Of that name. Throws std::out_of_range.
const SpaceOutput& space_output(const std::string& name);
std::vector<std::string> space_outputs();

struct SpaceSensor {
  const SpaceOutput* output = &space_output("space");
  BoundedVector sigma;                  ///< of z: m, rad, m/s
  double range_rate_correlation = 0.0;  ///< of the errors of range and range rate
  bool reported = false;                ///< does a measurement carry its standard deviations?

  Measurement measure(double time_s, const SpaceOutput::State& state, RandomStream& stream) const;
};

/// Reads the table of a sensor whose scenario says `output`.
SpaceSensor read_space_sensor(TableReader table, const std::string& output);

}  // namespace truebearing
