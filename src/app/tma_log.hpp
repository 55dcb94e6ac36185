// SPDX-License-Identifier: Apache-2.0
// What `truebearing tma` is asked, and the windows of bearings and frequencies that it makes of a log.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "app/log_options.hpp"
#include "app/report_output.hpp"
#include "app/tma_answer.hpp"
#include "truebearing/recording/recording_csv.hpp"
#include "truebearing/tma/bearing_window.hpp"
#include "truebearing/tma/doppler_window.hpp"

namespace truebearing {

struct TmaArguments {
  std::string log;
  std::string method = "ml";
  std::string json;
  LogArguments reading;
  ReportArguments report;
  double sigma_deg = 0.0;
  double from_s = -std::numeric_limits<double>::infinity();
  double to_s = std::numeric_limits<double>::infinity();
  double huber_sigmas = std::numeric_limits<double>::infinity();
  double velocity_sigma_mps = 5.0;
  double range_m = 0.0;
  double range_sigma_m = 0.0;
  double frequency_sigma_hz = 0.0;
  double sound_mps = kSoundInWater_mps;
  std::string frequency_changes = "levels";
  bool bearings_only = false;

  bool is_cho() const { return method != "ml" && method != "map"; }
};

struct TmaWindows {
  BearingWindow bearings;
  DopplerWindow frequencies;
  std::vector<SensorState> own_ship;              // at each bearing
  std::vector<std::size_t> line, frequency_line;  // of the log
};

/// Throws InputError where the log is none of bearings.
Recording read_tma_log(const TmaArguments& options);

/// The measurements between options.from_s and to_s. The answer gets what is missing, own ship and the truth at the
/// last of them. Throws InputError where they are too few, or something of them is not said.
TmaWindows tma_windows(const Recording& recording, const TmaArguments& options, TmaAnswer& answer);

}  // namespace truebearing
