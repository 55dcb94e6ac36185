// SPDX-License-Identifier: Apache-2.0
// Kalman filters that measure positions under linear motions. What their covariances become does not depend on what is
// measured: those that believe in one motion, one sensor and one prior covariance are a family that has P, S and K
// together, and only their means are their own. In a bank of 16 velocities under ten suppositions on Q and R that is
// ten recursions of covariances in place of 160.
#pragma once

#include <memory>
#include <vector>

#include "truebearing/filter/filter_group.hpp"
#include "truebearing/motion/any_motion.hpp"

namespace truebearing {

/// Members that stand one after another and are of one kind become a family, so whoever lists them lets what differs in
/// x alone vary fastest. Nothing where a motion is not linear, or where it is not compiled for positions of m
/// components (1 on the line, 2 in the plane) on a state of that length.
std::unique_ptr<FilterGroup> make_shared_covariance_group(const std::vector<std::shared_ptr<const AnyMotion>>& motions,
                                                          const std::vector<FilterGroup::Member>& members, int m);

}  // namespace truebearing
