// SPDX-License-Identifier: Apache-2.0
// Results as a report needs them: read from the JSON that `compare --json` writes, of this version or an older one. What
// is not known is NaN; what a file does not have is empty.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "truebearing/core/constants.hpp"
#include "truebearing/report/foretelling_results.hpp"

namespace truebearing {

struct ResultMetric {
  std::string name, unit;
  std::optional<double> time_s;
  double value = kNaN, se = kNaN;
};

struct ResultQuantity {
  std::string name;  ///< "position_m"
  double rmse = kNaN, rmse_se = kNaN, median = kNaN, ratio_to_plain = kNaN;
  std::vector<double> series, series_se;  ///< RMSE of each step, and its standard error
  std::vector<double> run_rmse;           ///< [run]
};

/// What a correction did: who held it back, which rules fired, what its features were.
struct ResultCorrection {
  std::string network, size, base, reference, bounds;  ///< empty where only its steps are told
  double kappa = kNaN, steps = kNaN, asked = kNaN, outside_intervals = kNaN, outside_disagreement = kNaN;
  /// [step], shares and lengths in standard deviations of what is trusted, means over runs.
  std::vector<double> gate, box, referee, limited, handed_over, wanted_sigmas, moved_sigmas;

  struct Feature {
    std::string name;
    double mean = kNaN, scale = kNaN, clip = kNaN, low = kNaN, high = kNaN;  ///< as the network was taught
    double seen_mean = kNaN, seen_deviation = kNaN, least = kNaN, greatest = kNaN, outside = kNaN;
    std::vector<double> counted;  ///< [bin] over mean -+ clip scale
  };
  std::vector<Feature> features;

  struct Rule {
    std::string conditions, adds, taught;
    double usage = kNaN, fired = kNaN, strongest = kNaN;
    std::vector<double> centre, width;  ///< [feature], in its units
  };
  std::vector<Rule> rules;  ///< the most used in training first
};

struct ResultTracker {
  std::string name;
  bool is_bound = false;
  bool corrected = false;
  std::vector<ResultQuantity> quantities;
  double nees = kNaN, nees_expected = kNaN, coverage95 = kNaN, loss_rate = kNaN, ns_per_step = kNaN, mean_gate = kNaN;
  std::vector<double> time_s;                        ///< of the series
  std::vector<double> nees_of, nees_low, nees_high;  ///< [step]: mean, and where 95 % of such means lie
  std::vector<ResultMetric> metrics;
  std::optional<ResultCorrection> correction;

  const ResultQuantity* quantity(std::string_view quantity_name) const;
};

/// Of `paired`: a - b, the mean over runs and its standard error.
struct ResultPair {
  std::string a, b, quantity;
  double mean = kNaN, se = kNaN;
};

/// What others printed of the same problem: nothing of it was run here.
struct ResultPublished {
  std::string name, source;
  std::vector<std::pair<std::string, double>> figures;  ///< "position_m" or the name of a metric
};

/// The figures of all runs, or of one set of them.
struct ResultFigures {
  std::vector<ResultTracker> trackers;  ///< in the study's order
  std::vector<ResultTracker> bounds;    ///< those that are no trackers: cramer_rao, posterior
  std::vector<ResultPair> pairs;
  std::vector<ResultPublished> published;

  const ResultTracker* tracker(std::string_view name) const;
};

struct ResultLine {
  int track = 0;
  std::vector<double> time_s, x, y;  ///< x is empty where y is drawn over time
};

struct ResultTrack {
  std::string tracker;
  ResultLine line;
  std::vector<double> xx, xy, yy;  ///< covariance
};

struct ResultPicture {
  std::string which, set, judged_by, quantity, component;
  double run = kNaN, rmse = kNaN, every = 1.0;
  bool in_plane = false;
  double clock_zero_s = 0.0;  ///< what was taken off its times (on_clock()), and the label of their axis
  std::string clock_label = "time (s)";
  std::vector<ResultLine> truth;
  ResultLine measured, own_ship;
  std::vector<double> bearing_deg;
  std::vector<ResultTrack> tracks;
  /// What a line array heard: decibels below the strongest at each time, [time][angle].
  std::vector<double> beam_time_s, beam_angle_deg;
  std::vector<std::vector<double>> below_dB;
  double assigned_within = kNaN;  ///< tracks belong to targets not by their numbers but within so much of them
};

struct LogResults;

struct Results {
  std::string file;  ///< what it is called
  std::string study, version;
  double seed = kNaN, runs = kNaN;
  ResultFigures all;
  struct Set {
    std::string name;
    ResultFigures figures;
  };
  std::vector<Set> sets;
  std::vector<ResultPicture> pictures;
  std::vector<ForetellingResults> foretelling;  ///< of a log that `track --foretell` scored
  std::shared_ptr<const LogResults> on_log;     ///< what the log says without its truth; none of what is no log
};

class ResultReader;
ResultPicture read_picture(const ResultReader& json);

/// Throws InputError that names the file, and the key where one is missing or of the wrong type. file: what messages and
/// the page call it.
Results parse_results(std::string_view json, const std::string& file);
Results read_results(const std::filesystem::path& file);

}  // namespace truebearing
