// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/feature.hpp"

#include <algorithm>
#include <fmt/format.h>

#include "truebearing/core/error.hpp"
#include "truebearing/core/suggestion.hpp"

namespace truebearing {
namespace {

using detail::FeatureMirror;
using detail::FeatureRow;
using detail::kFeatureRows;

const FeatureRow& entry(FeatureKind kind) {
  return kFeatureRows[static_cast<std::size_t>(kind)];
}

}  // namespace

std::string_view to_string(FeatureKind kind) {
  return entry(kind).name;
}

const std::vector<std::string>& feature_kind_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const FeatureRow& kind : kFeatureRows) list.emplace_back(kind.name);
    return list;
  }();
  return names;
}

FeatureKind feature_kind(const std::string& name) {
  for (const FeatureRow& kind : kFeatureRows)
    if (name == kind.name) return kind.kind;
  throw InputError("feature", "\"" + name + "\" is not known", suggestion(name, feature_kind_names()));
}

FeatureNeeds needs_of(FeatureKind kind) {
  return entry(kind).needs;
}

int mirror_parity(const FeatureSpec& feature, Frame frame, const StateSpace& space) {
  switch (entry(feature.kind).mirror) {
    case FeatureMirror::even:
      return +1;
    case FeatureMirror::odd:
      return -1;
    case FeatureMirror::by_component:
      break;
  }
  return component_parity(frame, space, std::max(space_in(frame, space).component_index(feature.component), 0));
}

std::string describe(const FeatureSpec& feature) {
  return fmt::format(fmt::runtime(entry(feature.kind).words), fmt::arg("component", feature.component),
                     fmt::arg("alpha", feature.alpha), fmt::arg("mode", feature.mode),
                     fmt::arg("sensor", feature.sensor),
                     fmt::arg("of", feature.companion.empty() ? "" : " of " + feature.companion),
                     fmt::arg("in", feature.component.empty() ? "" : " in " + feature.component));
}

}  // namespace truebearing
