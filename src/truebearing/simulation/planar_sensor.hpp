// SPDX-License-Identifier: Apache-2.0
// A sensor at the origin of the East-North plane, with Gaussian noise and, where asked for, outliers and false plots. What it can measure
// is one table, planar_outputs(). The table [sensor] of scenarios in the plane.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "truebearing/core/random.hpp"
#include "truebearing/measurement/measured.hpp"
#include "truebearing/measurement/measurement.hpp"
#include "truebearing/simulation/distribution.hpp"

namespace truebearing {

/// One kind of measurement: a row of the table.
struct PlanarOutput {
  std::string name;  ///< of the scenario's key `output`
  Measured measured;
  BoundedVector (*h)(const Eigen::Vector4d& state);  ///< of a target at [east, north, v_east, v_north] from the sensor
  /// Keys of the standard deviations of z's last components; the others have sigma_m.
  std::vector<std::string> sigma_keys;
  int bearing = -1;  ///< place of a bearing in z, which wraps
};

/// Of that name. Throws std::out_of_range.
const PlanarOutput& planar_output(const std::string& name);
std::vector<std::string> planar_outputs();

struct PlanarSensor {
  const PlanarOutput* output = &planar_output("plane");
  Distribution sigma_m = 1.0;           ///< of the position per axis, or of the range; drawn once per run
  std::optional<Eigen::Matrix2d> R_m2;  ///< of the position, in place of sigma_m
  BoundedVector further_sigma;          ///< of the components behind those of sigma_m: rad, m/s
  double range_rate_correlation = 0.0;  ///< of the errors of range and range rate, z's first and last
  double outlier_share = 0.0;           ///< probability that a measurement's noise is
  double outlier_factor = 1.0;          ///< that many times as large
  double false_share = 0.0;             ///< probability that a measurement is of nothing: of a place drawn evenly
  double false_radius_m = 0.0;          ///< from the disc of that radius about the target
  bool reported = false;                ///< does a measurement carry its standard deviations?

  Measured measured() const { return output->measured; }
  bool is_range() const { return output->name == "range"; }
  /// The measurement of a target at `state` (4) from the sensor, with sigma_m as it was drawn.
  Measurement measure(double time_s, const Eigen::Vector4d& state, double drawn_sigma_m, RandomStream& stream) const;
};

/// Reads the table of a sensor whose scenario says `output`.
PlanarSensor read_planar_sensor(TableReader table, const std::string& output);

}  // namespace truebearing
