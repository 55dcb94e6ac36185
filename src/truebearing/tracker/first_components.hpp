// SPDX-License-Identifier: Apache-2.0
// Sensors that can do without the last component of what is measured: a range rate behind a place (any_sensor.hpp).
#pragma once

#include "truebearing/measurement/measurement.hpp"

namespace truebearing {

/// Whether z has its first m components; one more behind them is left alone.
inline bool has_first(const Measurement& measurement, Eigen::Index m) {
  const Eigen::Index size = measurement.z.size();
  return (size == m || size == m + 1) && measurement.z.head(m).allFinite();
}

}  // namespace truebearing
