// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/feature_check.hpp"

#include <cmath>
#include <fmt/format.h>

#include "truebearing/core/error.hpp"
#include "truebearing/core/suggestion.hpp"

namespace truebearing {

void check_feature(const FeatureSpec& feature, const StateSpace& space, const StateSpace& components,
                   const FeatureExtractor::BlocksOf& blocks_of) {
  const FeatureNeeds needs = needs_of(feature.kind);
  const std::string where = fmt::format("feature {}", to_string(feature.kind));
  const bool named = needs.component == FeatureNeeds::Component::required ||
                     (needs.component == FeatureNeeds::Component::optional && !feature.component.empty());
  const int component = components.component_index(feature.component);
  if (named && component < 0)
    throw InputError(where, fmt::format("component \"{}\" is not in the state", feature.component),
                     suggestion(feature.component, components.components));
  const bool measured = needs.component == FeatureNeeds::Component::optional || feature.kind == FeatureKind::residual;
  const int positions = space == lorenz_space() ? space.size() : components.size() / 2;
  if (measured && component >= positions && component > 0)
    throw InputError(where, fmt::format("component \"{}\" is not measured", feature.component), "a position");
  if (needs.velocity && component < components.size() / 2)
    throw InputError(where, fmt::format("component \"{}\" is no velocity", feature.component),
                     suggestion(feature.component,
                                {components.components.begin() + components.size() / 2, components.components.end()}));
  if (needs.plane && space != plane_space() && space != space_space())
    throw InputError(where, "has no meaning in the space " + space.name, "the space plane or space");
  if (needs.plane && named && feature.component == "up_mps")
    throw InputError(where, "is of the level velocity, and its component is \"up_mps\"", "along or across");
  if (needs.mode && (feature.mode < 1 || feature.mode > kMaxModes))
    throw InputError(where, fmt::format("mode is {}", feature.mode), fmt::format("1 to {}", kMaxModes));
  if (needs.sensor && feature.sensor < 1)
    throw InputError(where, fmt::format("sensor is {}", feature.sensor), "its place among the sensors' names, from 1");
  if (needs.companion == FeatureNeeds::Companion::required && feature.companion.empty())
    throw InputError(where, "names no companion");
  if (needs.alpha && !(feature.alpha > 0.0 && feature.alpha <= 1.0))
    throw InputError(where, fmt::format("alpha is {}", feature.alpha), "a number in (0, 1]");
  if (needs.offset && !(feature.offset > 0.0 && std::isfinite(feature.offset)))
    throw InputError(where, fmt::format("offset is {}", feature.offset), "a number > 0");
  if (needs.scale && !(feature.scale > 0.0 && std::isfinite(feature.scale)))
    throw InputError(where, fmt::format("scale is {}", feature.scale), "a number > 0");
  const auto missing = [&](const char* block) {
    const std::string tracker = feature.companion.empty() ? "the base tracker" : feature.companion;
    return InputError(where, fmt::format("needs the {} in the records of {}, which carry none", block, tracker));
  };
  const RecordBlocks blocks = blocks_of(feature.companion);
  if (needs.blocks.prediction && !blocks.prediction) throw missing("prediction");
  if (needs.blocks.innovation && !blocks.innovation) throw missing("innovation");
  if (needs.blocks.gain && !blocks.gain) throw missing("gain");
  if (measured && &space != &components && !blocks.measures_position)
    throw InputError(where, "has no direction: what is measured is not a position", "a tracker of positions");
  if (needs.blocks.mode_probabilities && !blocks.mode_probabilities) throw missing("mode probabilities");
  if (needs.blocks.neighbour && !blocks.neighbour) throw missing("neighbour");
}

}  // namespace truebearing
