// SPDX-License-Identifier: Apache-2.0
#include "truebearing/measurement/longer_state.hpp"

#include <gtest/gtest.h>

#include <type_traits>

#include "truebearing/measurement/position.hpp"
#include "truebearing/measurement/range_bearing.hpp"

namespace truebearing::longer_state_test {
namespace {

static_assert(MeasurementModel<OnState<RangeBearing<>, 5>>);
static_assert(MeasurementModel<OnState<Position<2, float>, 6>>);
static_assert(std::is_same_v<OnState<Position<2>, 4>, Position<2>>);

TEST(OnLongerState, MeasuresTheFirstComponentsAndNothingElse) {
  const RangeBearing<> model{{100.0, -50.0}, 10.0, 0.02};
  const auto longer = on_state<5>(model);
  const Eigen::Matrix<double, 5, 1> x = (Eigen::Matrix<double, 5, 1>() << 400.0, 350.0, 3.0, 4.0, 0.1).finished();
  const Eigen::Vector4d head = x.head<4>();
  EXPECT_EQ(longer.h(x), model.h(head));
  EXPECT_EQ(longer.H(x).leftCols<4>(), model.H(head));
  EXPECT_EQ(longer.H(x).col(4), Eigen::Vector2d::Zero());
  EXPECT_EQ(longer.R(), model.R());
  EXPECT_EQ(longer.residual({1.0, 3.0}, {2.0, -3.0}), model.residual({1.0, 3.0}, {2.0, -3.0}));
}

TEST(OnLongerState, LeavesAModelOfItsOwnSizeAlone) {
  EXPECT_EQ(on_state<4>(Position<2>{{3.0, 4.0}}).sigma_m, Eigen::Vector2d(3.0, 4.0));
}

}  // namespace
}  // namespace truebearing::longer_state_test
