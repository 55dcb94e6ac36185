// SPDX-License-Identifier: Apache-2.0
// CorrectionDesign: what a study asks of a correction and a model was trained for: which trackers it looks at, through
// which features, and in which frame and units it answers. The two must be the same.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "truebearing/correction/feature.hpp"
#include "truebearing/correction/frame.hpp"

namespace truebearing {

/// Kinds of networks.
enum class NetworkKind {
  rules,     ///< the normalized fuzzy neural network (rule_base.hpp)
  recurrent  ///< a gated recurrent network (gated_recurrent.hpp)
};
/// Their names, as studies and model files spell them: "nfnn", "gru".
std::string_view to_string(NetworkKind kind);
const std::vector<std::string>& network_names();
NetworkKind network_kind(const std::string& name);

struct CorrectionDesign {
  NetworkKind network = NetworkKind::rules;
  std::string base;            ///< the tracker whose output is corrected
  std::string reference;       ///< the tracker that is trusted: the base itself, or a tuned one
  std::string covariance_of;   ///< the tracker whose covariance the correction's own is made from
  Frame frame = Frame::state;  ///< that features and corrections are in
  /// The network's outputs are in standard deviations of the base, component by component in the frame, and not in the
  /// units of the state.
  bool output_in_sigma = false;
  bool covariance_moments = false;  ///< covariance head: residual moments, not one inflation
  std::vector<FeatureSpec> features;

  bool operator==(const CorrectionDesign&) const = default;

  /// Names of all trackers that it looks at, each once: base, reference, covariance source, companions.
  std::vector<std::string> members() const;
};

/// The keys in which two designs differ, as a study spells them: "reference, features". Empty where they are equal.
std::string differences(const CorrectionDesign& a, const CorrectionDesign& b);

}  // namespace truebearing
