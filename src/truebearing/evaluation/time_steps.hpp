// SPDX-License-Identifier: Apache-2.0
// The step of a run that stands for a given time. The periods of a family's runs differ: it is the last one until then.
#pragma once

#include <vector>

#include "truebearing/recording/recording.hpp"

namespace truebearing {

/// The step of the recording, which has one target, for each time; -1 where it does not reach the time or its truth is
/// unknown then. A run reaches a time that comes within its longest period after the last step.
std::vector<int> steps_at(const Recording& recording, const std::vector<double>& times_s);

}  // namespace truebearing
