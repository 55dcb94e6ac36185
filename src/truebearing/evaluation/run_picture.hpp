// SPDX-License-Identifier: Apache-2.0
// One run as it can be drawn: truth, measurements, and what some trackers made of them with their covariances; and which
// runs of a comparison are worth drawing.
#pragma once

#include <string>
#include <vector>

#include "truebearing/core/constants.hpp"
#include "truebearing/evaluation/comparison.hpp"
#include "truebearing/evaluation/sensor_sites.hpp"

namespace truebearing {

/// In the plane x is East and y North, m; of anything else x is empty and y the first component, over time.
struct DrawnLine {
  int track = 0;
  std::vector<double> time_s, x, y;
};

struct DrawnTrack {
  std::string tracker;
  DrawnLine line;
  std::vector<double> xx, xy, yy;  ///< covariance of (x, y); of y alone yy
};

/// What a line array heard: the power of its beam at each angle over time.
struct DrawnBeam {
  std::vector<double> time_s, angle_deg;      ///< from broadside
  std::vector<std::vector<double>> below_dB;  ///< [time][angle]: below the strongest at that time; NaN of a gap
};

struct RunPicture {
  std::string which;      ///< "best", "median", "worst"
  std::string set;        ///< of which the run is, where there are several
  std::size_t run = 0;    ///< from 0
  std::string judged_by;  ///< the tracker whose error chose the run
  std::string quantity;   ///< and in which quantity
  double rmse = 0.0;      ///< its RMSE in this run
  bool in_plane = false;
  std::string component;  ///< of y where that is not the plane: "position_m", "angle_deg"
  std::vector<DrawnLine> truth;
  DrawnLine measured;               ///< positions, or values of the component; empty where neither was measured
  DrawnLine own_ship;               ///< where the sensor was; empty where it stands at the origin or is not told
  std::vector<double> bearing_deg;  ///< from own ship, at each of its times; empty where none was measured, NaN a miss
  std::vector<DrawnTrack> tracks;
  DrawnBeam beam;  ///< of a line array, else empty
  /// Where tracks belong to targets not by their numbers but by where they are: within so much, in the component's unit.
  double assigned_within = kNaN;
};

/// The trackers whose tracks are drawn, first the one that runs are judged by: of the first pair that is compared, else
/// the one with the least RMSE.
std::vector<std::string> drawn_trackers(const Comparison& comparison);

/// The best, the median and the worst run by that tracker's RMSE in its first quantity. Runs again what they are of.
/// Empty where the comparison has no details, or no run was scored.
std::vector<RunPicture> picture_runs(const TrackerSet& trackers, const std::vector<NamedScenario>& scenarios,
                                     const ComparisonOptions& options, const Comparison& comparison,
                                     const SensorSites& sites = {});

}  // namespace truebearing
