// SPDX-License-Identifier: Apache-2.0
// Whether a lane of a StatePack is, to the last bit, what a state has come to by itself.
#pragma once

#include <gtest/gtest.h>

#include "truebearing/filter/state_pack.hpp"

namespace truebearing::testing {

inline void expect_same_estimate(const StatePack& pack, int lane, const TrackedState& own) {
  BoundedVector x(own.size());
  BoundedMatrix P(own.size(), own.size());
  pack.estimate(lane, x.data(), P.data());
  EXPECT_EQ(x, own.x()) << "lane " << lane;
  EXPECT_EQ(P, own.P()) << "lane " << lane;
}

/// The estimate, and what the update left behind, which with the own state's was `update`.
inline void expect_same_update(const StatePack& pack, int lane, const TrackedState& own, const StateUpdate& update) {
  expect_same_estimate(pack, lane, own);
  StateUpdate packed;
  pack.update_of(lane, packed);
  EXPECT_EQ(packed.nu, update.nu) << "lane " << lane;
  EXPECT_EQ(packed.S, update.S) << "lane " << lane;
  EXPECT_EQ(packed.K, update.K) << "lane " << lane;
  EXPECT_EQ(packed.nis, update.nis) << "lane " << lane;
  if (const ModeVector* mu = own.mode_probabilities()) {
    ModeVector packed_mu;
    pack.mode_probabilities(lane, packed_mu);
    EXPECT_EQ(packed_mu, *mu) << "lane " << lane;
  }
}

}  // namespace truebearing::testing
