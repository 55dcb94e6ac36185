// SPDX-License-Identifier: Apache-2.0
// Where a study says that its sensors stand.
#pragma once

#include "truebearing/evaluation/sensor_sites.hpp"
#include "truebearing/study/study.hpp"

namespace truebearing {

/// site_m of [sensors.NAME], in the order of their names; else of the first tracker whose `measurement` has one. The
/// origin where nothing is said.
SensorSites sensor_sites(const Study& study);

}  // namespace truebearing
