// SPDX-License-Identifier: Apache-2.0
// Scores without truth, by measurements that trackers have not seen: of each sensor of a log n rows are shown and n hidden
// in turn, and what a tracker foretells of the last hidden one, n of its steps ahead, is held against it. Then the other
// half is hidden. The measurements' own noise is in every error alike, so that the differences are the trackers'. Who looks
// back is scored as the filter that it is without knowing what comes. Where a sensor stands is what its measurements say,
// else its site; biases that a tracker takes off are not taken off here.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "truebearing/evaluation/sensor_sites.hpp"
#include "truebearing/evaluation/statistics.hpp"
#include "truebearing/evaluation/tracker_set.hpp"
#include "truebearing/recording/recording.hpp"

namespace truebearing {

struct Foretelling {
  int steps = 1;
  std::string
      quantity;  ///< "position_m" of measured places, as they are or by range and bearing; else "bearing_deg", ...
  std::size_t foretold = 0;  ///< measurements that all trackers had an estimate for

  struct Tracker {
    std::string name;
    Estimate rmse;  ///< of the foretold measurement; standard error by leaving out one of twelve stretches of the log
    /// Mean squared error less that of the best, its standard error likewise; 0 of the best itself.
    Estimate above_best;
    double mean_gate;  ///< of a correction, over the foretold measurements; NaN of what is none
  };
  std::vector<Tracker> trackers;
  std::size_t best = 0;               ///< of the trackers
  std::vector<std::string> left_out;  ///< that have no estimate where measurements are hidden
};

/// How far a record is from a measurement of those components: in m of a place on the line, in the plane or in space, of
/// a range or by range, bearing and elevation from where the sensor was, else in degrees of bearing and elevation; nothing
/// of others. `quantity` becomes its name.
std::optional<double> miss(const std::vector<std::string>& components, const Measurement& measurement,
                           const SensorSites& sites, const StepRecord& record, std::string& quantity);

/// Throws InputError where nothing is foretold that could be compared: of several targets, of arrays, of short logs.
Foretelling foretell(const TrackerSet& trackers, const Recording& recording, int steps, const SensorSites& sites = {});

/// Who foretells best, or that no difference can be told; empty of one tracker alone.
std::string foretelling_verdict(const Foretelling& foretelling);
/// As a table, and who foretells best in a sentence.
std::string foretelling_text(const Foretelling& foretelling);

}  // namespace truebearing
