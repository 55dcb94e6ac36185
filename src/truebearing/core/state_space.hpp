// SPDX-License-Identifier: Apache-2.0
// What the components of a state mean: their names with units, and the quantities that errors are reported in.
// A quantity is one or more components whose error is taken as a 2-norm (the position in a plane, say).
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace truebearing {

struct Quantity {
  std::string name;          ///< with its unit: "position_m"
  std::vector<int> indices;  ///< components of the state that make it up
  double scale = 1.0;        ///< from the unit of the components to that of the quantity
  bool operator==(const Quantity&) const = default;
};

struct StateSpace {
  std::string name;                     ///< "line"
  std::vector<std::string> components;  ///< with units: "position_m", "velocity_mps"
  std::vector<Quantity> quantities;

  int size() const { return static_cast<int>(components.size()); }
  /// Index of a component or of a quantity; -1 where there is none of that name.
  int component_index(std::string_view component) const;
  int quantity_index(std::string_view quantity) const;
  bool operator==(const StateSpace&) const = default;
};

/// [position_m, velocity_mps]: a target on a line, or a range and its rate.
const StateSpace& line_space();
/// [east_m, north_m, east_mps, north_mps]: a target in the local East-North plane.
const StateSpace& plane_space();
/// [east_m, north_m, east_mps, north_mps, frequency_hz]: the same, and the frequency that the target radiates.
const StateSpace& plane_frequency_space();
/// [east_m, north_m, up_m, east_mps, north_mps, up_mps]: a target above the plane.
const StateSpace& space_space();
/// [angle_rad, rate_radps]: the direction to a target, and its rate; reported in degrees.
const StateSpace& angle_space();
/// [lorenz_x, lorenz_y, lorenz_z]: the Lorenz attractor, without units; reported as one quantity, "state".
const StateSpace& lorenz_space();
/// True where a state begins with the components of plane_space().
bool begins_in_plane(const StateSpace& space);

/// The space of that name, or nullptr. Spaces live as long as the program.
const StateSpace* find_state_space(std::string_view name);
/// The space with exactly these components: a known one, else a new one with one quantity per component.
const StateSpace& state_space_of_components(const std::vector<std::string>& components);

}  // namespace truebearing
