// SPDX-License-Identifier: Apache-2.0
// What trackers made of a log without truth, step by step: their tracks as they can be drawn, how large their innovations
// were for what they claimed, and which measurements they did not use and why.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "truebearing/core/constants.hpp"
#include "truebearing/evaluation/run_canvas.hpp"
#include "truebearing/evaluation/run_picture.hpp"

namespace truebearing {

struct TrackerOnLog {
  std::string name;

  /// [innovation], of used and of gated measurements.
  struct Innovations {
    std::vector<double> time_s;
    std::vector<double> sigmas;   ///< of the first component, nu / sqrt(S); NaN where that was not measured
    std::vector<double> nis;      ///< nu' S^-1 nu
    std::vector<double> freedom;  ///< of it: components that were measured
    std::vector<bool> used;
  } innovations;

  struct NotUsed {
    double time_s;
    std::string why;    ///< "missing", "repeated", "late", "gated", "failed"
    double nis = kNaN;  ///< of a gated one, where it is known
  };
  std::vector<NotUsed> not_used;
};

struct LogAccount {
  RunPicture picture;  ///< without a truth: whose run it is, and by whom it is judged, is empty
  std::vector<TrackerOnLog> trackers;
};

/// Runs trackers over logs and keeps account of it.
class LogFollower {
 public:
  explicit LogFollower(const TrackerSet& trackers, SensorSites sites = {});

  /// Follows a log afresh; of several, tracks are told apart by adding `number`. epoch_s: the log's time at which the
  /// trackers' clock is 0.
  void follow(const Recording& recording, int number, double epoch_s);
  LogAccount take() { return std::move(account_); }

 private:
  void take_step(std::size_t tracker, const TrackerCounts& before, double time_s);

  TrackerSet trackers_;
  SensorSites sites_;
  RunCanvas canvas_;
  LogAccount account_;
};

}  // namespace truebearing
