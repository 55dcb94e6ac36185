#include "truebearing/correction/frame.hpp"

#include "truebearing/core/error.hpp"

namespace truebearing {

const StateSpace& space_in(Frame frame, const StateSpace& space) {
  static const StateSpace track{
      "track", {"along_m", "cross_m", "along_mps", "cross_mps"}, {{"position_m", {0, 1}}, {"velocity_mps", {2, 3}}}};
  if (frame == Frame::state) return space;
  if (space != plane_space())
    throw InputError("frame", "is track, and the state is of the space " + space.name, "the space plane");
  return track;
}

std::string_view to_string(Frame frame) {
  return frame == Frame::track ? "track" : "state";
}

}  // namespace truebearing
