// SPDX-License-Identifier: Apache-2.0
#include "truebearing/core/state_space.hpp"

#include <algorithm>
#include <array>
#include <deque>
#include <mutex>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/bounded.hpp"
#include "truebearing/core/error.hpp"

namespace truebearing {

int StateSpace::component_index(std::string_view component) const {
  const auto found = std::find(components.begin(), components.end(), component);
  return found == components.end() ? -1 : static_cast<int>(found - components.begin());
}

int StateSpace::quantity_index(std::string_view quantity) const {
  const auto found =
      std::find_if(quantities.begin(), quantities.end(), [&](const Quantity& q) { return q.name == quantity; });
  return found == quantities.end() ? -1 : static_cast<int>(found - quantities.begin());
}

const StateSpace& line_space() {
  static const StateSpace space{"line", {"position_m", "velocity_mps"}, {{"position_m", {0}}, {"velocity_mps", {1}}}};
  return space;
}

const StateSpace& plane_space() {
  static const StateSpace space{
      "plane", {"east_m", "north_m", "east_mps", "north_mps"}, {{"position_m", {0, 1}}, {"velocity_mps", {2, 3}}}};
  return space;
}

const StateSpace& space_space() {
  static const StateSpace space{"space",
                                {"east_m", "north_m", "up_m", "east_mps", "north_mps", "up_mps"},
                                {{"position_m", {0, 1, 2}}, {"velocity_mps", {3, 4, 5}}}};
  return space;
}

const StateSpace& plane_frequency_space() {
  static const StateSpace space{"plane_frequency",
                                {"east_m", "north_m", "east_mps", "north_mps", "frequency_hz"},
                                {{"position_m", {0, 1}}, {"velocity_mps", {2, 3}}, {"frequency_hz", {4}}}};
  return space;
}

const StateSpace& angle_space() {
  static const StateSpace space{
      "angle", {"angle_rad", "rate_radps"}, {{"angle_deg", {0}, degrees(1.0)}, {"rate_degps", {1}, degrees(1.0)}}};
  return space;
}

const StateSpace& lorenz_space() {
  static const StateSpace space{"lorenz", {"lorenz_x", "lorenz_y", "lorenz_z"}, {{"state", {0, 1, 2}}}};
  return space;
}

bool begins_in_plane(const StateSpace& space) {
  const std::vector<std::string>& plane = plane_space().components;
  return space.components.size() >= plane.size() && std::equal(plane.begin(), plane.end(), space.components.begin());
}

const StateSpace* find_state_space(std::string_view name) {
  for (const StateSpace* space :
       {&line_space(), &plane_space(), &space_space(), &plane_frequency_space(), &angle_space(), &lorenz_space()})
    if (space->name == name) return space;
  return nullptr;
}

const StateSpace& state_space_of_components(const std::vector<std::string>& components) {
  for (const StateSpace* space :
       {&line_space(), &plane_space(), &space_space(), &plane_frequency_space(), &angle_space(), &lorenz_space()})
    if (space->components == components) return *space;
  if (components.empty() || components.size() > kMaxDimension)
    throw InputError("state", "has " + std::to_string(components.size()) + " components",
                     "1 to " + std::to_string(kMaxDimension));

  static std::mutex mutex;
  static std::deque<StateSpace> others;  // a deque keeps the addresses that records hold
  const std::lock_guard lock(mutex);
  for (const StateSpace& space : others)
    if (space.components == components) return space;
  StateSpace space{"custom", components, {}};
  for (int i = 0; i < space.size(); ++i) space.quantities.push_back({components[static_cast<std::size_t>(i)], {i}});
  return others.emplace_back(std::move(space));
}

}  // namespace truebearing
