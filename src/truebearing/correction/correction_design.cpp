// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/correction_design.hpp"

#include <algorithm>

#include "truebearing/core/error.hpp"
#include "truebearing/core/suggestion.hpp"

namespace truebearing {

std::string_view to_string(NetworkKind kind) {
  return kind == NetworkKind::rules ? "nfnn" : "gru";
}

const std::vector<std::string>& network_names() {
  static const std::vector<std::string> names{"nfnn", "gru"};
  return names;
}

NetworkKind network_kind(const std::string& name) {
  for (const NetworkKind kind : {NetworkKind::rules, NetworkKind::recurrent})
    if (to_string(kind) == name) return kind;
  throw InputError("network", "is \"" + name + "\"", suggestion(name, network_names()));
}

std::vector<std::string> CorrectionDesign::members() const {
  std::vector<std::string> names;
  const auto add = [&](const std::string& name) {
    if (!name.empty() && std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  add(base);
  add(reference);
  add(covariance_of);
  for (const FeatureSpec& feature : features) add(feature.companion);
  return names;
}

std::string differences(const CorrectionDesign& a, const CorrectionDesign& b) {
  std::string keys;
  const auto compare = [&](const char* key, const auto& of_a, const auto& of_b) {
    if (of_a != of_b) keys += (keys.empty() ? "" : ", ") + std::string(key);
  };
  compare("network", a.network, b.network);
  compare("base", a.base, b.base);
  compare("reference", a.reference, b.reference);
  compare("covariance_of", a.covariance_of, b.covariance_of);
  compare("frame", a.frame, b.frame);
  compare("output_in", a.output_in_sigma, b.output_in_sigma);
  compare("covariance", a.covariance_moments, b.covariance_moments);
  compare("features", a.features, b.features);
  return keys;
}

}  // namespace truebearing
