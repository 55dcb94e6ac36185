// SPDX-License-Identifier: Apache-2.0
// A StatePack through a rough day: states that come and go while others stay, intervals and measurements of every
// lane's own, some of them none. What the pack is certain of is what each state comes to by itself, to the last bit; of
// what was not kept nothing is left.
#include "truebearing/filter/state_pack.hpp"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/filter/bent_motion.hpp"
#include "tests/filter/same_in_pack.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/filter/filter_kinds.hpp"
#include "truebearing/filter/interacting_multiple_model.hpp"
#include "truebearing/measurement/bearing.hpp"
#include "truebearing/measurement/cartesian_position.hpp"
#include "truebearing/measurement/range_bearing.hpp"
#include "truebearing/measurement/range_bearing_rate.hpp"
#include "truebearing/motion/constant_velocity.hpp"
#include "truebearing/motion/coordinated_turn.hpp"

namespace truebearing::pack_turns_test {
namespace {

using truebearing::testing::Bent;
using truebearing::testing::expect_same_estimate;
using truebearing::testing::expect_same_update;
using Noise = DiscreteWhiteNoise;
using State = std::unique_ptr<TrackedState>;

State model_of(int modes, bool bent) {
  InteractingMultipleModel::Modes made;
  made.push_back(state_of<KalmanFilter<4>>(ConstantVelocity<2, Noise>{{0.5}}));
  for (int i = 1; i < modes; ++i)
    made.push_back(bent && i == 1 ? state_of<KalmanFilter<4>>(Bent{})
                                  : state_of<KalmanFilter<4>>(CoordinatedTurn<Noise>{{1.0 + i}, 0.03 * i}));
  return std::make_unique<InteractingMultipleModel>(std::move(made), star_chain(modes, 0.05, 0.1, 0.6, 1.0));
}

struct Kind {
  std::string name;
  State (*make)();
};
const Kind kKinds[] = {
    {"Filter", [] { return state_of<KalmanFilter<4>>(ConstantVelocity<2, Noise>{{0.5}}); }},
    {"ExtendedFilter", [] { return state_of<KalmanFilter<4>>(Bent{}); }},
    {"TwoModes", [] { return model_of(2, false); }},
    {"FiveModesOfWhichOneIsNonlinear", [] { return model_of(5, true); }},
};

// What is measured of a state, near where it is.
enum class Look { position, range_and_bearing, bearing, range_bearing_and_rate };
constexpr int kLooks = 4;

template <typename Model>
std::unique_ptr<AnyMeasurement> taken_by(const Model& model, const TrackedState& state, RandomStream& random,
                                         bool is_position) {
  typename Model::Vector z = model.h(state.x());
  for (int m = 0; m < Model::kMeasurements; ++m) z[m] += std::sqrt(model.R()(m, m)) * random.normal();
  return std::make_unique<ErasedMeasurement<Model>>(model, z, is_position);
}

std::unique_ptr<AnyMeasurement> taken(Look look, const TrackedState& state, RandomStream& random) {
  const Eigen::Vector2d site(-500.0, 800.0 + 100.0 * random.uniform());
  const double sigma_m = 20.0 + 30.0 * random.uniform(), sigma_rad = 0.01;
  switch (look) {
    case Look::range_and_bearing:
      return taken_by(RangeBearing<>{site, sigma_m, sigma_rad}, state, random, false);
    case Look::bearing:
      return taken_by(Bearing<>{site, Eigen::Vector2d::Zero(), sigma_rad}, state, random, false);
    case Look::range_bearing_and_rate:
      return taken_by(RangeBearingRate<>{site, {5.0, -3.0}, sigma_m, sigma_rad, 2.0, 0.3}, state, random, false);
    case Look::position:
      break;
  }
  const Eigen::Matrix2d R = (Eigen::Matrix2d() << sigma_m * sigma_m, 150.0, 150.0, 900.0).finished();
  return taken_by(CartesianPosition<2>{R}, state, random, true);
}

// A measurement that nothing can be made of.
std::unique_ptr<AnyMeasurement> spoilt(Look look, const TrackedState& state, RandomStream& random) {
  std::unique_ptr<AnyMeasurement> spoilt = taken(look, state, random);
  const bool without_R = random.uniform() < 0.5;
  with_length(*spoilt, [&]<int M>(const SizedMeasurement<M>& sized) {
    auto& own = const_cast<SizedMeasurement<M>&>(sized);  // made here
    if (without_R)
      own.R(M - 1, M - 1) = -1.0;
    else
      own.z[0] = kNaN;
  });
  return spoilt;
}

class PackTurns : public ::testing::TestWithParam<std::size_t> {
 protected:
  void SetUp() override {
    prototype_ = kKinds[GetParam()].make();
    pack_ = pack_of(*prototype_);
    if (!pack_) GTEST_SKIP() << "no pack on this processor";
    for (State& own : own_) own = prototype_->fresh();
    for (State& next : next_) next = prototype_->fresh();
  }

  TrackedState& own(int lane) { return *own_[static_cast<std::size_t>(lane)]; }
  TrackedState& next(int lane) { return *next_[static_cast<std::size_t>(lane)]; }

  void enter(int lane) {
    const Eigen::Vector4d x =
        Eigen::Vector4d(3000.0, 3000.0, 80.0, 80.0)
            .cwiseProduct(Eigen::Vector4d(1.0 + 0.1 * random_.normal(), 1.0 + 0.1 * random_.normal(), random_.normal(),
                                          random_.normal()));
    const Eigen::Matrix4d P = Eigen::Vector4d(400.0, 500.0, 100.0, 90.0 + lane).asDiagonal();
    own(lane).begin(x.data(), P.data());
    // Not always one that has just begun: the modes then differ.
    if (random_.uniform() < 0.5) own(lane).predict(1.5);
    pack_->enter(lane, own(lane));
    inside_ |= lane_bit(lane);
  }

  void leave(int lane) {
    const State left = prototype_->fresh();
    pack_->leave(lane, *left);
    inside_ = without(inside_, lane_bit(lane));
    EXPECT_EQ(left->x(), own(lane).x()) << "lane " << lane;
    EXPECT_EQ(left->P(), own(lane).P()) << "lane " << lane;
    if (left->mode_probabilities()) {
      EXPECT_EQ(*left->mode_probabilities(), *own(lane).mode_probabilities()) << "lane " << lane;
      for (std::size_t j = 0; j < left->modes().size(); ++j) {
        EXPECT_EQ(left->modes()[j]->x(), own(lane).modes()[j]->x()) << "lane " << lane << " mode " << j;
        EXPECT_EQ(left->modes()[j]->P(), own(lane).modes()[j]->P()) << "lane " << lane << " mode " << j;
      }
    }
  }

  LaneMask some(double share) {
    LaneMask lanes = 0;
    for (int lane = 0; lane < kPackLanes; ++lane)
      if (random_.uniform() < share) lanes |= lane_bit(lane);
    return lanes;
  }

  // Those lanes over an interval each.
  void predict(LaneMask lanes) {
    for_each_lane(lanes, [&](int lane) {
      const double drawn = random_.uniform();
      dt_s_[static_cast<std::size_t>(lane)] = drawn < 0.6 ? 1.0 : drawn < 0.8 ? 2.5 : 1.0 + random_.uniform();
    });
    ASSERT_EQ(pack_->predict(lanes, dt_s_.data()), lanes);
    for_each_lane(lanes, [&](int lane) {
      next(lane).assign(own(lane));
      EXPECT_EQ(next(lane).predict(dt_s_[static_cast<std::size_t>(lane)]), StepStatus::ok);
      expect_same_estimate(*pack_, lane, next(lane));
    });
  }

  // Each with a measurement of its own. Those that the pack can be certain of: of the kind of the first, and good.
  LaneMask update(LaneMask lanes) {
    std::array<std::unique_ptr<AnyMeasurement>, kPackLanes> all;
    std::array<const AnyMeasurement*, kPackLanes> measurements{};
    LaneMask expected = 0;
    const Look usual = draw();
    const double share_of_others = random_.uniform() < 0.5 ? 0.0 : 0.3;
    std::array<Look, kPackLanes> looks;
    for_each_lane(lanes, [&](int lane) {
      const auto i = static_cast<std::size_t>(lane);
      looks[i] = random_.uniform() < share_of_others ? draw() : usual;
      const bool is_good = random_.uniform() < 0.9;
      all[i] = (is_good ? taken : spoilt)(looks[i], next(lane), random_);
      measurements[i] = all[i].get();
      if (is_good && looks[i] == looks[static_cast<std::size_t>(first_lane(lanes))]) expected |= lane_bit(lane);
    });
    // Range and bearing are as long as a position, and nonetheless another kind.
    const LaneMask certain = pack_->update(lanes, measurements.data());
    EXPECT_EQ(certain, expected);
    for_each_lane(certain & expected, [&](int lane) {
      StateUpdate mine;
      EXPECT_EQ(next(lane).update(*measurements[static_cast<std::size_t>(lane)], mine), StepStatus::ok);
      expect_same_update(*pack_, lane, next(lane), mine);
    });
    updated_ += std::popcount(certain);
    return certain & expected;
  }

  void keep(LaneMask lanes) {
    pack_->keep(lanes);
    for_each_lane(lanes, [&](int lane) { own(lane).assign(next(lane)); });
  }

  Look draw() { return static_cast<Look>(static_cast<int>(kLooks * random_.uniform())); }

  State prototype_;
  std::unique_ptr<StatePack> pack_;
  std::array<State, kPackLanes> own_, next_;
  std::array<double, kPackLanes> dt_s_{};
  RandomStream random_{{3, Role::evaluation, 0}, StreamId::test};
  LaneMask inside_ = 0;
  int updated_ = 0;
};

TEST_P(PackTurns, AreThoseOfEachStateByItself) {
  for (int step = 0; step < 300; ++step) {
    for_each_lane(some(0.15), [&](int lane) {
      if (!has_lane(inside_, lane)) return enter(lane);
      if (random_.uniform() < 0.7) return leave(lane);
      pack_->drop(lane);
      inside_ = without(inside_, lane_bit(lane));
    });
    EXPECT_EQ(pack_->free_lane(), inside_ == kAllLanes ? -1 : first_lane(without(kAllLanes, inside_)));
    const LaneMask lanes = inside_ & some(0.85);
    predict(lanes);
    ASSERT_FALSE(HasFailure()) << "step " << step;
    // Not everyone measures, and not everyone who does is kept; now and then no one is.
    const LaneMask certain = update(lanes & some(0.9));
    keep(random_.uniform() < 0.1 ? LaneMask{0} : certain & some(0.9));
    ASSERT_FALSE(HasFailure()) << "step " << step;
  }
  for_each_lane(inside_, [&](int lane) { leave(lane); });
  EXPECT_GT(updated_, 500);
}

// What was predicted may be kept without a measurement, and predicted anew without being kept.
TEST_P(PackTurns, PredictionsMayBeKeptOrForgotten) {
  for (int lane = 0; lane < kPackLanes; ++lane) enter(lane);
  for (int step = 0; step < 40; ++step) {
    predict(some(0.8));
    if (step % 3 == 0) continue;  // forgotten
    const LaneMask lanes = some(0.7);
    predict(lanes);
    keep(lanes & some(0.7));
    ASSERT_FALSE(HasFailure()) << "step " << step;
  }
  for_each_lane(kAllLanes, [&](int lane) { leave(lane); });
}

INSTANTIATE_TEST_SUITE_P(Kinds, PackTurns, ::testing::Range(std::size_t{0}, std::size(kKinds)),
                         [](const auto& kind) { return kKinds[kind.param].name; });

}  // namespace
}  // namespace truebearing::pack_turns_test
