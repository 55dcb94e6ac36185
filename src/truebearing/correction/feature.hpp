// A feature: one input of a correction network, computed from step records alone, so that truth cannot leak into it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "truebearing/core/state_space.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

enum class FeatureKind {
  log_step,  ///< ln k, k the number of steps of this track in which the base used its measurement, 1 before the first
  gain,      ///< K[component, 0]
  residual,  ///< z - x[component], after the update
  prediction_difference,  ///< x_pred[component] - x[component]
  innovation,             ///< e = nu_0 / sqrt(S_00), the normalised innovation
  innovation_average,     ///< a <- (1 - alpha) a + alpha e, divided by sqrt(alpha / (2 - alpha)), its deviation if e is
                          ///< white
  log_nis_average,        ///< ln(offset + a), a <- (1 - alpha) a + alpha NIS
  log_mean_nis,           ///< ln(offset + mean of the NIS of this track so far)
  estimate,               ///< x[component] / scale
  companion_difference    ///< (x_companion[component] - x[component]) / scale
};

/// Which feature, and its constants. What a kind does not use stays at its default.
struct FeatureSpec {
  FeatureKind kind = FeatureKind::log_step;
  std::string component;  ///< of the state, where the kind has one
  /// The tracker that the base is compared with; for other features, whose record they are of: empty for the base's.
  std::string companion;
  double alpha = 0.0;   ///< weight of the newest value in an average, (0, 1]
  double offset = 0.0;  ///< inside a logarithm, > 0
  double scale = 1.0;   ///< divisor, in the units of the component, > 0

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

  bool component = false;
  Companion companion = Companion::none;
  bool alpha = false;
  bool offset = false;
  bool scale = false;
  RecordBlocks blocks;  ///< of the companion's records where one is named, else of the base's
};
FeatureNeeds needs_of(FeatureKind kind);

/// +1 where the feature is the same for a mirrored target (every component of the state with its sign changed), -1
/// where it changes sign.
int mirror_parity(FeatureKind kind);

/// A short name for tables and sentences: "difference of wide in velocity_mps".
std::string describe(const FeatureSpec& feature);

}  // namespace truebearing
