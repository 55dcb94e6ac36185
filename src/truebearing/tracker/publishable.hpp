// SPDX-License-Identifier: Apache-2.0
// What a tracker may publish as an estimate: anything else is `failed`, whatever a hostile log made of its arithmetic.
#pragma once

#include "truebearing/core/farthest.hpp"
#include "truebearing/tracker/step_record.hpp"

namespace truebearing {

/// Gives a record its status: `failed` where x or P is not finite or a variance is below zero.
inline void set_status(StepStatus status, StepRecord& record) {
  const bool publishable = record.x.allFinite() && record.P.allFinite() && (record.P.diagonal().array() >= 0.0).all();
  record.status = publishable ? status : StepStatus::failed;
}

}  // namespace truebearing
