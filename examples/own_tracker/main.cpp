// SPDX-License-Identifier: Apache-2.0
// The program `truebearing` with a tracker of one's own: registered once, it can be named in any study, beside the
// house's trackers and under a correction.
//     example_own_tracker compare examples/own_tracker/own_tracker.toml --retrain
#include "alpha_beta.hpp"
#include "app/command_line.hpp"
#include "truebearing/study/tracker_registry.hpp"

int main(int argc, char** argv) {
  truebearing::register_tracker("alpha_beta", example::make_alpha_beta);
  return truebearing::command_line(argc, argv);
}
