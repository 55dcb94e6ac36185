// SPDX-License-Identifier: Apache-2.0
#include "truebearing/core/state_space.hpp"

#include <gtest/gtest.h>

#include "truebearing/core/bounded.hpp"
#include "truebearing/core/error.hpp"

namespace truebearing::state_space_test {
namespace {

TEST(StateSpace, FindsComponentsAndQuantitiesByName) {
  EXPECT_EQ(line_space().component_index("velocity_mps"), 1);
  EXPECT_EQ(line_space().component_index("velocity"), -1);
  EXPECT_EQ(plane_space().component_index("north_mps"), 3);
  EXPECT_EQ(plane_space().quantity_index("velocity_mps"), 1);
  EXPECT_EQ(plane_space().quantity_index("north_mps"), -1);
  EXPECT_EQ(plane_space().quantities[1].indices, (std::vector<int>{2, 3}));
}

TEST(StateSpace, IsFoundByName) {
  EXPECT_EQ(find_state_space("plane"), &plane_space());
  EXPECT_EQ(find_state_space("volume"), nullptr);
}

TEST(StateSpace, OfKnownComponentsIsTheKnownOne) {
  EXPECT_EQ(&state_space_of_components({"position_m", "velocity_mps"}), &line_space());
}

TEST(StateSpace, OfOtherComponentsIsMadeOnceWithOneQuantityEach) {
  const StateSpace& space = state_space_of_components({"range_m", "bearing_rad"});
  EXPECT_EQ(&state_space_of_components({"range_m", "bearing_rad"}), &space);
  EXPECT_NE(&state_space_of_components({"bearing_rad", "range_m"}), &space);
  ASSERT_EQ(space.quantities.size(), 2u);
  EXPECT_EQ(space.quantities[1], (Quantity{"bearing_rad", {1}}));
}

TEST(StateSpace, RefusesNoComponentsAndTooMany) {
  EXPECT_THROW(state_space_of_components({}), InputError);
  EXPECT_THROW(state_space_of_components(std::vector<std::string>(kMaxDimension + 1, "x_m")), InputError);
}

}  // namespace
}  // namespace truebearing::state_space_test
