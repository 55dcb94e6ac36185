#include "truebearing/motion/one_of.hpp"

#include <gtest/gtest.h>

#include "tests/motion/linear_motion.hpp"
#include "truebearing/motion/constant_velocity.hpp"
#include "truebearing/motion/coordinated_turn.hpp"

namespace truebearing {
namespace {

using Straight = ConstantVelocity<2, ContinuousWhiteNoise>;
using Turn = CoordinatedTurn<DiscreteWhiteNoise>;
using Either = OneOf<Straight, Turn>;
static_assert(LinearMotionModel<Either>);

TEST(OneOf, IsTheModelThatWasChosen) {
  const Straight straight{{0.5}};
  const Turn turn{{2.0}, 0.1};
  for (const double dt_s : {0.5, 3.0}) {
    EXPECT_EQ(Either{straight}.F(dt_s), straight.F(dt_s));
    EXPECT_EQ(Either{straight}.Q(dt_s), straight.Q(dt_s));
    EXPECT_EQ(Either{turn}.F(dt_s), turn.F(dt_s));
    EXPECT_EQ(Either{turn}.Q(dt_s), turn.Q(dt_s));
  }
}

TEST(OneOf, IsALinearMotion) {
  testing::expect_linear_motion(Either{Straight{{0.5}}});
  testing::expect_linear_motion(Either{Turn{{2.0}, 0.1}});
}

}  // namespace
}  // namespace truebearing
