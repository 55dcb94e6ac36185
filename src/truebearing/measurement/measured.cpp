// SPDX-License-Identifier: Apache-2.0
#include "truebearing/measurement/measured.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

namespace truebearing {
namespace {

constexpr const char* kValues = "values";  // of a log whose columns are of no known kind: they say all there is

// Of a place in range and angles, with a range rate behind it.
bool is_with_range_rate(const Measured& given, const Measured& taken) {
  if (taken.components.front() != "range_m" || taken.components.size() < 2) return false;
  std::vector<std::string> components = taken.components;
  components.emplace_back("range_rate_mps");
  return given.components == components;
}

}  // namespace

Measured Measured::position(int dimensions) {
  if (dimensions == 1) return {"position", {"position_m"}};
  if (dimensions == 3) return {"position", {"east_m", "north_m", "up_m"}};
  return {"position", {"east_m", "north_m"}};
}

Measured Measured::position_velocity() {
  return {"position_velocity", {"position_m", "velocity_mps"}};
}

Measured Measured::range_bearing() {
  return {"range_bearing", {"range_m", "bearing_deg"}};
}

Measured Measured::bearing() {
  return {"bearing", {"bearing_deg"}};
}

Measured Measured::bearing_frequency() {
  return {"bearing_frequency", {"bearing_deg", "frequency_hz"}};
}

Measured Measured::lorenz() {
  return {"lorenz", lorenz_space().components};
}

Measured Measured::snapshots(int sensors) {
  return {"snapshots", {"snapshots"}, sensors};
}

Measured Measured::several(std::vector<Source> sources) {
  Measured measured{"sensors", {}, 0, std::move(sources)};
  for (const Source& source : measured.sources)
    for (const std::string& component : source.components)
      if (std::find(measured.components.begin(), measured.components.end(), component) == measured.components.end())
        measured.components.push_back(component);
  return measured;
}

Measured Measured::step_log(const StateSpace& space) {
  return {"step_log", space.components};
}

Measured Measured::of(std::vector<std::string> components) {
  for (Measured known : {position(1), position(2), position(3), position_velocity(), range_bearing(), bearing(),
                         bearing_frequency(), lorenz(), snapshots()})
    if (known.components == components) return known;
  return {kValues, std::move(components)};
}

std::string describe(const Measured& measured) {
  if (!measured.sources.empty()) {
    std::vector<std::string> texts;
    for (const Source& source : measured.sources)
      texts.push_back(fmt::format("{}: {}", source.name, fmt::join(source.components, ", ")));
    return fmt::format("{} ({})", measured.kind, fmt::join(texts, "; "));
  }
  return fmt::format("{} ({})", measured.kind, fmt::join(measured.components, ", "));
}

std::optional<std::string> mismatch(const Measured& taken, const Measured& given, const std::string& giver) {
  if (taken.sensors > given.sensors && given.sensors > 0)
    return fmt::format("follows {} targets, which takes an array of {} sensors; {} has {}", taken.sensors - 1,
                       taken.sensors, giver, given.sensors);
  if (taken == given) return std::nullopt;
  if (given.kind == kValues && taken.components == given.components) return std::nullopt;
  if (taken == Measured::bearing() && given == Measured::bearing_frequency()) return std::nullopt;
  if (is_with_range_rate(given, taken)) return std::nullopt;
  if (given.is_step_log() && !taken.is_step_log()) return std::nullopt;
  return fmt::format("measures {}, {} gives {}", describe(taken), giver, describe(given));
}

}  // namespace truebearing
