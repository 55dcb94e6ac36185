// SPDX-License-Identifier: Apache-2.0
// Makers of trackers of several targets' angles at a line array.
//
// kind = "subspace_angles" (tracker/subspace_angle_tracker.hpp):
//   targets                     a number, or "mdl" or "aic": as many as the first interval seems to hold
//   subspace                    "past" (beta, per snapshot), "orthogonal_iteration" or "eigenvectors"
//   innovation                  "implicit", "projection" or "ryu": three ways to the same number
//   q_deg2ps3, sigma_deg        process noise; deviation of the angle that the subspace tells
//   lag_intervals               how old that angle is at the end of an interval
//   sigma_from_subspace, inflate_within_deg
//
// kind = "joint_angles" (tracker/joint_angle_tracker.hpp):
//   targets
//   motion = { q_deg2ps3, q_low_deg2ps3, q_high_deg2ps3, innovation_alpha,
//              close_deg, close_q_low_deg2ps3, close_q_high_deg2ps3, log_power_variance_per_s }
//   rate_sigma_degps, iterations, beam, moving_blocks, noise_power (estimated where it is not given)
//   lifetimes = { begin_presence, begin_hits, end_presence, end_misses, close_misses }    where targets appear and
//   vanish
#pragma once

#include <memory>

#include "truebearing/io/table_reader.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

std::unique_ptr<Tracker> make_subspace_angles(TableReader& table);
std::unique_ptr<Tracker> make_joint_angles(TableReader& table);

}  // namespace truebearing
