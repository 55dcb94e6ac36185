// A sensor at the origin of the East-North plane: it measures the position per axis, the range, or range and bearing,
// with Gaussian noise and, where asked for, outliers. The table [sensor] of scenarios in the plane.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "truebearing/core/random.hpp"
#include "truebearing/measurement/measured.hpp"
#include "truebearing/measurement/measurement.hpp"
#include "truebearing/simulation/distribution.hpp"

namespace truebearing {

struct PlanarSensor {
  enum class Output { position, range, range_bearing };

  Output output = Output::position;
  Distribution sigma_m = 1.0;           ///< of the position per axis, or of the range; drawn once per run
  std::optional<Eigen::Matrix2d> R_m2;  ///< of the position, in place of sigma_m
  double bearing_sigma_rad = 0.0;       ///< of range_bearing
  double outlier_share = 0.0;           ///< probability that a measurement's noise is
  double outlier_factor = 1.0;          ///< that many times as large
  bool reported = false;                ///< does a measurement carry its standard deviations?

  Measured measured() const;
  /// The measurement of a target at `position_m` from the sensor, with sigma_m as it was drawn.
  Measurement measure(double time_s, const Eigen::Vector2d& position_m, double drawn_sigma_m,
                      RandomStream& stream) const;
};

/// Reads the table; `output` says what the scenario measures.
PlanarSensor read_planar_sensor(TableReader table, PlanarSensor::Output output);

}  // namespace truebearing
