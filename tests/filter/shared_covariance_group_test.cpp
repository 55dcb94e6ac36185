// SPDX-License-Identifier: Apache-2.0
#include "truebearing/filter/shared_covariance_group.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "truebearing/core/constants.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/core/simd_width.hpp"
#include "truebearing/filter/filter_kinds.hpp"
#include "truebearing/measurement/cartesian_position.hpp"
#include "truebearing/measurement/range_bearing.hpp"
#include "truebearing/motion/constant_velocity.hpp"
#include "truebearing/motion/coordinated_turn.hpp"
#include "truebearing/motion/turning_target.hpp"

namespace truebearing::shared_covariance_group_test {
namespace {

constexpr double kExact = 1e-12;
using Noise = DiscreteWhiteNoise;
using Position = CartesianPosition<2>;

AnyMotions motions() {
  return {erased(ConstantVelocity<2, Noise>{{0.5}}), erased(CoordinatedTurn<Noise>{{2.0}, 0.05})};
}

// Under each motion and sensor so many members.
std::vector<FilterGroup::Member> members(std::size_t each) {
  std::vector<FilterGroup::Member> members;
  for (std::size_t sensor = 0; sensor < 2; ++sensor)
    for (std::size_t motion = 0; motion < 2; ++motion) members.insert(members.end(), each, {motion, sensor});
  return members;
}

// What two sensors make of one position.
struct Positions {
  ErasedMeasurement<Position> first, second;
  std::array<const AnyMeasurement*, 2> taken{&first, &second};

  explicit Positions(const Eigen::Vector2d& z_m)
      : first(Position{Eigen::Vector2d(1e4, 2e4).asDiagonal()}, z_m, true),
        second(Position{Eigen::Vector2d(9e4, 3e3).asDiagonal()}, z_m, true) {}
};

struct Both {
  std::unique_ptr<FilterGroup> shared, separate;

  explicit Both(std::size_t each)
      : shared(make_shared_covariance_group(motions(), members(each), 2)),
        separate(make_filter_group(FilterKind::kalman, motions(), members(each))) {}

  // Velocities fan out; every `odd_one`-th has another prior covariance.
  bool begin(std::size_t odd_one) {
    bool valid = true;
    for (std::size_t i = 0; i < shared->size(); ++i) {
      const double turn = 0.7 * static_cast<double>(i);
      const Eigen::Vector4d x(1000.0, -500.0, 200.0 * std::cos(turn), 200.0 * std::sin(turn));
      const double factor = odd_one > 0 && i % odd_one == 0 ? 2.0 : 1.0;
      const Eigen::Matrix4d P = factor * Eigen::Vector4d(1e4, 2e4, 900.0, 400.0).asDiagonal().toDenseMatrix();
      valid &= shared->begin(i, x.data(), P.data()) & separate->begin(i, x.data(), P.data());
    }
    return valid;
  }

  void step(double dt_s, const Eigen::Vector2d& z_m) {
    ASSERT_TRUE(shared->predict(dt_s));
    ASSERT_TRUE(separate->predict(dt_s));
    const Positions positions(z_m);
    std::vector<double> a(shared->size()), b(shared->size());
    shared->update(positions.taken, a);
    separate->update(positions.taken, b);
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], kExact * std::abs(b[i])) << "member " << i;
  }

  void expect_same() const {
    BoundedVector x_a, x_b;
    BoundedMatrix P_a, P_b;
    for (std::size_t i = 0; i < shared->size(); ++i) {
      shared->estimate(i, x_a, P_a);
      separate->estimate(i, x_b, P_b);
      EXPECT_LE((x_a - x_b).norm(), kExact * x_b.norm()) << "member " << i;
      EXPECT_LE((P_a - P_b).norm(), kExact * P_b.norm()) << "member " << i;
    }
    std::vector<double> weights(static_cast<std::size_t>(padded_to_widest(static_cast<int>(shared->size()))));
    double sum = 0.0;
    for (std::size_t i = 0; i < shared->size(); ++i) sum += weights[i] = static_cast<double>(i % 3);
    shared->mix(weights, sum, x_a, P_a);
    separate->mix(weights, sum, x_b, P_b);
    EXPECT_LE((x_a - x_b).norm(), kExact * x_b.norm());
    EXPECT_LE((P_a - P_b).norm(), kExact * P_b.norm());
  }
};

class SharedCovarianceGroupOf : public ::testing::TestWithParam<std::size_t> {};

TEST_P(SharedCovarianceGroupOf, IsWhatItsFiltersAreByThemselves) {
  Both both(7);
  for (int time = 0; time < 2; ++time) {  // the second time anew
    ASSERT_TRUE(both.begin(GetParam()));
    RandomStream random({}, StreamId::test);
    for (int step = 0; step < 30; ++step)
      both.step(step % 7 == 0 ? 2.5 : 1.0, Eigen::Vector2d(50.0 * random.normal(), 100.0 * step + random.normal()));
    both.expect_same();
  }
}
INSTANTIATE_TEST_SUITE_P(OneAndSeveralPriors, SharedCovarianceGroupOf, ::testing::Values(0, 1, 2, 3));

TEST(SharedCovarianceGroup, CopiesAnother) {
  Both both(5);
  ASSERT_TRUE(both.begin(2));
  std::unique_ptr<FilterGroup> copy = both.shared->fresh();
  both.step(1.0, {10.0, 20.0});
  copy->assign(*both.shared);
  both.shared.swap(copy);
  both.expect_same();
  both.step(1.0, {30.0, 40.0});  // over the time that the copy has never crossed
  both.expect_same();
  ASSERT_TRUE(both.begin(0));  // fewer families than the other has
  copy->assign(*both.shared);
  both.shared.swap(copy);
  both.step(1.0, {5.0, 6.0});
  both.expect_same();
}

// Velocities that are known exactly, and a measurement before anything was crossed.
TEST(SharedCovarianceGroup, PriorsMayBeSingular) {
  Both both(4);
  const Eigen::Matrix4d P = Eigen::Vector4d(1e4, 2e4, 0.0, 0.0).asDiagonal();
  for (std::size_t i = 0; i < both.shared->size(); ++i) {
    const Eigen::Vector4d x(0.0, 0.0, 10.0 * static_cast<double>(i), 50.0);
    EXPECT_TRUE(both.shared->begin(i, x.data(), P.data()) & both.separate->begin(i, x.data(), P.data()));
  }
  const Positions positions({10.0, 20.0});
  std::vector<double> a(both.shared->size()), b(a.size());
  both.shared->update(positions.taken, a);
  both.separate->update(positions.taken, b);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], kExact * std::abs(b[i])) << "member " << i;
  both.expect_same();
  both.step(1.0, {30.0, 40.0});
  both.expect_same();
}

// A sensor that says nonsense of its errors is not believed; the members of the other go on.
TEST(SharedCovarianceGroup, FamiliesOfASensorWithoutCovarianceStay) {
  Both both(3);
  ASSERT_TRUE(both.begin(0));
  Positions positions({10.0, 20.0});
  positions.second.set(Position{Eigen::Vector2d(100.0, -1.0).asDiagonal()}, {10.0, 20.0});
  std::vector<double> gained(both.shared->size());
  BoundedVector x;
  BoundedMatrix before, after;
  for (const std::size_t i : {0u, 7u}) {
    ASSERT_TRUE(both.begin(0));
    both.shared->estimate(i, x, before);
    both.shared->update(positions.taken, gained);
    both.shared->estimate(i, x, after);
    EXPECT_EQ(std::isfinite(gained[i]), i == 0u);
    EXPECT_EQ(after == before, i == 7u);
  }
}

TEST(SharedCovarianceGroup, MemberThatCannotExplainAMeasurementHasLostAlone) {
  Both both(3);
  ASSERT_TRUE(both.begin(0));
  const Eigen::Vector4d far(1e200, 0.0, 0.0, 0.0);
  const Eigen::Matrix4d P = Eigen::Vector4d(1e4, 2e4, 900.0, 400.0).asDiagonal();
  ASSERT_TRUE(both.shared->begin(1, far.data(), P.data()));
  const Positions positions({0.0, 0.0});
  std::vector<double> gained(both.shared->size());
  both.shared->update(positions.taken, gained);
  for (std::size_t i = 0; i < gained.size(); ++i) EXPECT_EQ(std::isfinite(gained[i]), i != 1) << "member " << i;
  BoundedVector x;
  BoundedMatrix P_of;
  both.shared->estimate(1, x, P_of);
  EXPECT_EQ(x, far);
}

TEST(SharedCovarianceGroup, RefusesPriorsThatAreNone) {
  Both both(1);
  const Eigen::Matrix4d P = Eigen::Vector4d(1.0, 1.0, -1.0, 1.0).asDiagonal();
  EXPECT_FALSE(both.shared->begin(0, Eigen::Vector4d(0, 0, 0, 0).eval().data(), P.data()));
  const Eigen::Matrix4d good = Eigen::Matrix4d::Identity();
  EXPECT_FALSE(both.shared->begin(0, Eigen::Vector4d(kNaN, 0, 0, 0).eval().data(), good.data()));
  EXPECT_FALSE(both.shared->predict(1.0));
}

TEST(SharedCovarianceGroup, MeasurementsThatAreNoPositionsAreNotTaken) {
  Both both(2);
  ASSERT_TRUE(both.begin(0));
  const ErasedMeasurement<RangeBearing<>> polar(RangeBearing<>{{0.0, 0.0}, 1.0, 0.01}, {1000.0, 0.5});
  const std::array<const AnyMeasurement*, 2> taken{&polar, &polar};
  std::vector<double> gained(both.shared->size());
  both.shared->update(taken, gained);
  for (const double value : gained) EXPECT_EQ(value, -kInfinity);
}

TEST(SharedCovarianceGroup, IsOfLinearMotionsAndMeasuredPositionsAlone) {
  EXPECT_FALSE(make_shared_covariance_group(motions(), members(1), 1));
  EXPECT_TRUE(make_shared_covariance_group(motions(), members(1), 2));
  AnyMotions with_rate = {erased(TurningTarget<Noise>{{0.5}, 0.01})};
  EXPECT_FALSE(make_shared_covariance_group(with_rate, members(1), 2));
}

}  // namespace
}  // namespace truebearing::shared_covariance_group_test
