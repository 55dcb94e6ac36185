// A feature: one input of a correction network, computed from step records alone, so that truth cannot leak into it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "truebearing/core/state_space.hpp"
#include "truebearing/correction/frame.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

enum class FeatureKind {
  log_step,  ///< ln k, k the number of steps of this track in which the base used its measurement, 1 before the first
  gain,      ///< the gain of a component on the measured component that it belongs to: K[component, 0] on a line
  residual,  ///< z - x[component], after the update
  prediction_difference,  ///< x_pred[component] - x[component]
  innovation,             ///< e_i = nu_i / sqrt(S_ii), the normalised innovation
  innovation_average,     ///< a <- (1 - alpha) a + alpha e, divided by sqrt(alpha / (2 - alpha)), its deviation if e is
                          ///< white
  log_nis_average,        ///< ln(offset + a), a <- (1 - alpha) a + alpha NIS
  log_mean_nis,           ///< ln(offset + mean of the NIS of this track so far)
  estimate,               ///< x[component] / scale
  companion_difference,   ///< (x_companion[component] - x[component]) / scale
  log_sigma,              ///< ln sqrt(P[component, component])
  log_speed,              ///< ln of the speed, at least 1e-3 m/s; plane space
  aspect_cosine,          ///< of the angle from the line of sight to the velocity; plane space
  aspect_sine,            ///< positive where the target crosses to starboard of the line of sight
  mode_probability,       ///< mu[mode] of a multiple-model tracker
  log_range,              ///< ln of the distance from the sensor, at least 1 m; plane space
  log_first_range,  ///< ln of the distance with which the track began, at least 1 m: what was believed; plane space
  log_time,         ///< ln of the time since the track began, at least 1 s
  bearing_rate,     ///< d bearing/dt of the estimate as the sensor sees it from its own course, rad/s; plane space
  own_velocity,     ///< the sensor's velocity[component] / scale; plane space
  speed_change,  ///< ln(speed / m), m <- m + alpha mu[mode] (speed - m): against the speed before the target left that
                 ///< mode; plane space
  velocity_change,  ///< (v - m)[component] / scale, m <- m + alpha mu[mode] (v - m): against the velocity before; plane
                    ///< space
  neighbour_closeness,  ///< how near the nearest other target is, in (0, 1]; 0 where the tracker follows no other
  neighbour_difference  ///< closeness (x_neighbour[component] - x[component]) / scale; 0 where there is no other
};

/// Which feature, and its constants. What a kind does not use stays at its default. Components are those of the frame
/// that the correction works in; vectors are averaged in the state's own frame and turned afterwards, so that an
/// average does not depend on how the target has turned meanwhile.
struct FeatureSpec {
  FeatureKind kind = FeatureKind::log_step;
  std::string component{};  ///< of the state, where the kind has one; a position for innovations (empty: the first)
  /// The tracker that the base is compared with; for other features, whose record they are of: empty for the base's.
  std::string companion{};
  double alpha = 0.0;           ///< weight of the newest value in an average, (0, 1]
  double offset = 0.0;          ///< inside a logarithm, > 0
  double scale = 1.0;           ///< divisor, in the units of the component, > 0
  bool scale_is_sigma = false;  ///< divide by the base's standard deviation of the component instead
  int mode = 0;                 ///< counted from 1

  bool operator==(const FeatureSpec&) const = default;
};

std::string_view to_string(FeatureKind kind);
/// Names of all kinds, as studies and model files spell them.
const std::vector<std::string>& feature_kind_names();
/// The kind of that name; throws InputError that suggests the nearest.
FeatureKind feature_kind(const std::string& name);

/// What a feature of this kind reads beside the state.
struct FeatureNeeds {
  enum class Companion { none, optional, required };

  enum class Component { none, optional, required };

  Component component = Component::none;
  Companion companion = Companion::none;
  bool velocity = false;  ///< the component is one of a velocity
  bool alpha = false;
  bool offset = false;
  bool scale = false;
  bool mode = false;
  bool plane = false;   ///< has a meaning in the plane space only
  RecordBlocks blocks;  ///< of the companion's records where one is named, else of the base's
};
FeatureNeeds needs_of(FeatureKind kind);

/// +1 where the feature is the same for a mirrored target, -1 where it changes sign. `component`: its place in the
/// state, 0 where the feature has none. (A mode's probability is taken to be the same: a network that is taught mirror
/// symmetry should see sums over modes that mirror each other.)
int mirror_parity(const FeatureSpec& feature, Frame frame, const StateSpace& space);

/// A short name for tables and sentences: "difference of wide in velocity_mps".
std::string describe(const FeatureSpec& feature);

}  // namespace truebearing
