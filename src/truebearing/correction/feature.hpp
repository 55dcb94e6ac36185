// SPDX-License-Identifier: Apache-2.0
// A feature: one input of a correction network, computed from step records alone, so that truth cannot leak into it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "truebearing/core/state_space.hpp"
#include "truebearing/correction/feature_kinds.hpp"
#include "truebearing/correction/frame.hpp"

namespace truebearing {

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
  int sensor = 0;               ///< counted from 1, in the order of their names

  bool operator==(const FeatureSpec&) const = default;
};

std::string_view to_string(FeatureKind kind);
/// Names of all kinds, as studies and model files spell them.
const std::vector<std::string>& feature_kind_names();
/// The kind of that name; throws InputError that suggests the nearest.
FeatureKind feature_kind(const std::string& name);

FeatureNeeds needs_of(FeatureKind kind);

/// +1 where the feature is the same for a mirrored target, -1 where it changes sign. `component`: its place in the
/// state, 0 where the feature has none. (A mode's probability is taken to be the same: a network that is taught mirror
/// symmetry should see sums over modes that mirror each other.)
int mirror_parity(const FeatureSpec& feature, Frame frame, const StateSpace& space);

/// A short name for tables and sentences: "difference of wide in velocity_mps".
std::string describe(const FeatureSpec& feature);

}  // namespace truebearing
