// SPDX-License-Identifier: Apache-2.0
// What became of one step of a tracker.
#pragma once

#include <string_view>

namespace truebearing {

enum class StepStatus : unsigned char {
  ok,            ///< the measurement was used
  rejected,      ///< a measurement came and was not used: gated, out of order, or a repetition
  coasted,       ///< no usable measurement: prediction only
  unobservable,  ///< the data do not determine the state; x and P say no more than the prior does
  failed         ///< the arithmetic could not be carried out; x and P are the last valid ones
};

constexpr std::string_view to_string(StepStatus status) {
  switch (status) {
    case StepStatus::ok:
      return "ok";
    case StepStatus::rejected:
      return "rejected";
    case StepStatus::coasted:
      return "coasted";
    case StepStatus::unobservable:
      return "unobservable";
    case StepStatus::failed:
      return "failed";
  }
  return "unknown";
}

}  // namespace truebearing
