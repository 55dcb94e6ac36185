// SPDX-License-Identifier: Apache-2.0
// What `truebearing tma` answers: the target's range, course and speed with their uncertainty, the tone of its source
// where that was measured, what the residuals say, and what the geometry leaves open. As text and as JSON.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "truebearing/measurement/measurement.hpp"
#include "truebearing/tma/frequency_changes.hpp"
#include "truebearing/tma/other_explanations.hpp"
#include "truebearing/tma/residual_checks.hpp"

namespace truebearing {

/// What was measured of the source's tone.
struct TmaSource {
  struct Level {
    double from_s, to_s;
    std::size_t count;  ///< of its frequencies
    double frequency_hz, sigma_hz;
  };
  bool used = false;        ///< false where the estimate is from the bearings alone
  bool looked_for = false;  ///< changes of it
  std::size_t frequencies = 0;
  int outliers = 0;
  std::vector<Level> levels;  ///< in order of time; a level may come back
  double sound_mps = kSoundInWater_mps;
  std::vector<FrequencyChange> changes;
};

/// A measurement that does not belong to the others.
struct TmaOutlier {
  double time_s;
  std::size_t line;                      ///< of the log
  double sigmas;                         ///< off what the others say of it; of a frequency NaN
  std::optional<std::size_t> or_line{};  ///< of another that may be the outlier in its stead
};

/// A stretch of the log by itself, before or after a manoeuvre, and what its bearings say.
struct TmaStretch {
  double from_s = 0.0, to_s = 0.0;
  bool range_is_known = false;  ///< and it keeps one course and speed, by its residuals
  BatchEstimate estimate{};
  SensorState own_ship{};  ///< at its last bearing
};

/// What the measurements look like besides a target on one course and speed.
struct TmaCause {
  std::string kind;   ///< own_ship, outliers, manoeuvre, two_contacts, back_bearings, bearing_bias, noise_larger, ...
  double likelihood;  ///< 2 ln of the likelihood ratio to one course and speed, less ln m for each unknown
  std::string says;
};

/// A bearing that was used, as it is drawn.
struct TmaBearing {
  double time_s, bearing_deg;
  Eigen::Vector2d own_ship_m;
  double residual_sigmas;  ///< measured minus that of the estimate, in standard deviations
};

struct TmaAnswer {
  std::string log;
  std::string method;
  std::size_t bearings = 0;
  int missing = 0;
  double from_s = 0.0;
  SensorState own_ship;  ///< at the last bearing
  BatchEstimate estimate;
  ResidualChecks residuals;
  std::optional<Observability> observability;  ///< nothing where no numbers came out
  bool has_prior = false;
  bool is_robust = false;  ///< outliers count for little
  int missing_frequencies = 0;
  std::optional<TmaSource> source;  ///< where frequencies were measured

  std::vector<TmaOutlier> outliers, frequency_outliers;
  std::vector<TmaStretch> stretches;  ///< before and after the manoeuvre, where there was one
  std::string own_ship_is_off;        ///< how its positions and its velocity disagree; empty where they do not
  std::optional<TwoContacts> two_contacts;
  std::optional<BatchEstimate> reversed;  ///< of all bearings turned by 180 degrees, where that fits better
  double bearing_sigma_rad = 0.0, frequency_sigma_hz = 0.0;  ///< root mean squares of what was claimed
  /// 1/2 the sum of squares that a method ended above the least squares.
  double above_least_squares = 0.0;
  std::vector<TmaCause> causes;  ///< of what is wrong, in order of likelihood; made by find_causes()

  std::vector<Ambiguity> ambiguities;
  std::vector<Eigen::Vector4d> hypotheses;  ///< where the range is open: the state at each of some ranges
  std::vector<TmaBearing> drawn;            ///< all of them, where a report is wanted
  std::optional<BoundedVector> truth;       ///< at the last bearing; its fifth component is the source's frequency

  /// Do the bearings determine the range?
  bool range_is_known() const { return observability && observability->observable() && estimate.P.allFinite(); }
  /// Is there anything to say of it? A prior answers where the bearings do not, and is said to.
  bool has_motion() const { return (range_is_known() || has_prior) && estimate.P.allFinite(); }
};

/// What is wrong with the answer, if anything.
void find_causes(TmaAnswer& answer);
/// In one line.
std::string verdict(const TmaAnswer& answer);

/// A state as seen from own ship.
struct Motion {
  double range_m, bearing_deg, course_deg, speed_mps;

  Motion(const Eigen::Vector4d& x, const SensorState& own_ship);
};

/// Standard deviations of the same.
struct MotionSigmas {
  double range_m, bearing_deg, course_deg, speed_mps;

  MotionSigmas(const Eigen::Vector4d& x, const Eigen::Matrix4d& P, const SensorState& own_ship);
};

/// The 95 % ellipse of the position.
struct Ellipse {
  double semi_major_m, semi_minor_m, orientation_deg;  ///< of the major axis, from North, in [0, 180)

  explicit Ellipse(const Eigen::Matrix4d& P);
};

/// Is the range known to a half of itself, with the change?
bool range_is_known(const VelocityChange& change, const SensorState& own_ship);
/// Of the source, where the log knows it.
std::optional<double> true_frequency(const TmaAnswer& answer);

/// With so many decimals, or where its standard deviation is smaller than they show with two figures of that.
std::string figure(double value, double sigma, int decimals);
/// Range, course and speed with their standard deviations, in words.
std::string motion_with_sigmas(const Eigen::Vector4d& x, const Eigen::Matrix4d& P, const SensorState& own_ship);

/// A time, whole where it is seconds of an epoch.
std::string seconds(double time_s);

std::string tma_text(const TmaAnswer& answer);
std::string tma_json(const TmaAnswer& answer);

}  // namespace truebearing
