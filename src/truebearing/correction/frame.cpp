// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/frame.hpp"

#include "truebearing/core/error.hpp"

namespace truebearing {

const StateSpace& space_in(Frame frame, const StateSpace& space) {
  static const auto turned = [](const char* name) {
    return StateSpace{
        name, {"along_m", "cross_m", "along_mps", "cross_mps"}, {{"position_m", {0, 1}}, {"velocity_mps", {2, 3}}}};
  };
  static const auto turned_in_space = [](const char* name) {
    return StateSpace{name,
                      {"along_m", "cross_m", "up_m", "along_mps", "cross_mps", "up_mps"},
                      {{"position_m", {0, 1, 2}}, {"velocity_mps", {3, 4, 5}}}};
  };
  static const StateSpace track = turned("track"), sight = turned("sight");
  static const StateSpace space_track = turned_in_space("track"), space_sight = turned_in_space("sight");
  if (frame == Frame::state) return space;
  if (space == space_space()) return frame == Frame::track ? space_track : space_sight;
  if (space != plane_space())
    throw InputError("frame", "is " + std::string(to_string(frame)) + ", and the state is of the space " + space.name,
                     "the space plane or space");
  return frame == Frame::track ? track : sight;
}

int component_parity(Frame frame, const StateSpace& space, int component) {
  if (frame == Frame::state) return -1;
  const std::string& name = space_in(frame, space).components[static_cast<std::size_t>(component)];
  return name.starts_with("cross") ? -1 : +1;
}

std::string_view to_string(Frame frame) {
  return frame_names()[static_cast<std::size_t>(frame)];
}

const std::vector<std::string>& frame_names() {
  static const std::vector<std::string> names{"state", "track", "sight"};
  return names;
}

Frame frame_of(std::string_view name) {
  for (const Frame frame : {Frame::track, Frame::sight})
    if (name == to_string(frame)) return frame;
  return Frame::state;
}

}  // namespace truebearing
