// SPDX-License-Identifier: Apache-2.0
// How a recorded log fits a study: where the study's times fall in it, and why a tracker could not begin on it.
#pragma once

#include <cstddef>
#include <string>

#include "truebearing/study/study.hpp"

namespace truebearing {

/// The time of a log in s at which the study's clock is 0. A log that begins after all times of which the study speaks
/// (when batches are solved or handed over, else when figures are taken, else the scenario to its end where trackers
/// begin with a prior) has another clock, such as the time of day: the study's then begins so that the first row is
/// where the scenario has its first measurement. 0 for any other log.
double study_epoch_s(const Study& study, double first_time_s);

/// What was found in a log.
struct LogContents {
  std::size_t measurements = 0;
  std::size_t missing = 0;  ///< of them
  bool guess = false;       ///< does any bring one of its target?
  double last_time_s = 0.0;
  double epoch_s = 0.0;  ///< study_epoch_s()
};

/// Why a tracker of the study has begun no track on a log of these contents, in words.
std::string why_no_track(const Study& study, const std::string& tracker, const LogContents& log);

}  // namespace truebearing
