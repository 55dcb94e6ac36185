// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/turn_limit.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "tests/support/statistics.hpp"
#include "truebearing/core/angle.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/motion/coordinated_turn.hpp"
#include "truebearing/motion/with_frequency.hpp"

namespace truebearing::turn_limit_test {
namespace {

using State = Eigen::Vector<double, 5>;
using Turn = VesselParameters::Turn;

constexpr double kPeriod_s = 7.0, kSource_hz = 120.0;
constexpr int kSteps = 120;
const BearingFrequencySensor kSensor{radians(1.0), 0.02};
// What a batch leaves: the position to 150 m, the velocity to .2 m/s.
const State kVariances(22500.0, 22500.0, 0.04, 0.04, 1e-4);

Turn family() {
  using D = Distribution;
  return {.time_s = {D::Kind::uniform, {50.0, 300.0}},
          .angle_deg = {D::Kind::uniform, {20.0, 90.0}},
          .rate_degps = {D::Kind::log_uniform, {0.2, 1.0}},
          .share = 0.85,
          .either_side = true};
}

struct Watch {
  std::vector<Measurement> measurements;
  std::vector<State> truth;
  State begun;  // what is believed at time 0
};

/// A target that turns as said, heard from an own ship that turns twice.
Watch watch_of(const Turn& turn, std::uint64_t number) {
  RandomStream stream({.seed = 5, .role = Role::evaluation, .run = number}, StreamId::test);
  const double time_s = turn.time_s.draw(stream), angle_rad = radians(turn.angle_deg.draw(stream)),
               rate_radps = radians(turn.rate_degps.draw(stream));
  const double side = turn.either_side && stream.uniform() < 0.5 ? -1.0 : 1.0;
  std::vector<CourseChange> changes;
  if (stream.uniform() < turn.share) changes.push_back({time_s, side * angle_rad, rate_radps});
  const VesselPath own({0.0, 0.0}, 5.0, radians(60.0),
                       {{200.0, radians(-90.0), radians(1.0)}, {500.0, radians(90.0), radians(1.0)}});
  const VesselPath target({2000.0, 6000.0}, 4.0, stream.uniform(0.0, 2.0 * std::numbers::pi), changes);
  Watch run;
  for (int k = 0; k <= kSteps; ++k) {
    const double now_s = kPeriod_s * k;
    const SensorState from = own.at(now_s).state, at = target.at(now_s).state;
    State x;
    x << at.position_m, at.velocity_mps, kSource_hz;
    if (k == 0) {
      for (int i = 0; i < 5; ++i) run.begun[i] = x[i] + std::sqrt(kVariances[i]) * stream.normal();
      continue;
    }
    const BearingFrequency<> model{from.position_m, from.velocity_mps, kSensor.sigma_rad, kSensor.sigma_hz};
    Measurement m;
    m.time_s = now_s;
    m.sensor = from;
    m.z = model.h(x) + Eigen::Vector2d(model.sigma_rad * stream.normal(), model.sigma_hz * stream.normal());
    run.measurements.push_back(m);
    run.truth.push_back(x);
  }
  return run;
}

TurnLimit limit_of(const Turn& turn, const Watch& run, int hypotheses = 500) {
  TurnLimit limit({.turn = turn, .sensor = kSensor, .hypotheses = hypotheses, .seed = 1});
  limit.take_over(0.0, run.begun, BoundedMatrix(kVariances.asDiagonal()));
  return limit;
}

/// What knows the turn by heart: rate over [begin_s, end_s], without noise.
struct KnownTurn {
  double begin_s, end_s, rate_radps;

  void predict(double from_s, double to_s, KalmanFilter<5>& filter) const {
    const auto over = [&](double low_s, double high_s, double rate) {
      const WithFrequency<CoordinatedTurn<ContinuousWhiteNoise>> motion{{{0.0}, rate}};
      EXPECT_EQ(filter.predict(motion, std::max(high_s - low_s, 0.0)), StepStatus::ok);
    };
    over(from_s, std::min(begin_s, to_s), 0.0);
    over(std::max(begin_s, from_s), std::min(end_s, to_s), rate_radps);
    over(std::max(end_s, from_s), to_s, 0.0);
  }
};

void expect_as_if_known(const Turn& turn, const KnownTurn& known) {
  const Watch run = watch_of(turn, 1);
  TurnLimit limit = limit_of(turn, run);
  KalmanFilter<5> filter(run.begun, kVariances.asDiagonal());
  double last_s = 0.0;
  for (const Measurement& m : run.measurements) {
    known.predict(last_s, m.time_s, filter);
    filter.update(kSensor.model(m), Eigen::Vector2d(m.z));
    last_s = m.time_s;
    const auto records = limit.step(m);
    ASSERT_EQ(records.size(), 1u);
    const Eigen::Matrix4d P = filter.P().topLeftCorner<4, 4>();
    EXPECT_LT((records[0].x - filter.x().head<4>()).norm(), 1e-6) << m.time_s;
    EXPECT_LT((records[0].P - P).norm(), 1e-6 * P.norm()) << m.time_s;
    const bool turning = m.time_s > known.begin_s && m.time_s < known.end_s;
    EXPECT_NEAR((*records[0].mode_probabilities)[1], turning ? 1.0 : 0.0, 1e-9) << m.time_s;
  }
}

TEST(TurnLimit, WithoutATurnIsTheKalmanFilter) {
  Turn never = family();
  never.share = 0.0;
  expect_as_if_known(never, {1e9, 1e9, 0.0});
}

TEST(TurnLimit, OfATurnThatIsKnownIsTheKalmanFilterThatKnowsIt) {
  const double end_s = 100.0 + 60.0 / 0.5;
  expect_as_if_known({.time_s = 100.0, .angle_deg = 60.0, .rate_degps = 0.5}, {100.0, end_s, radians(0.5)});
}

/// The sum over runs of the NEES of position and velocity at the last step.
double nees_of(const Turn& believed, int runs) {
  double sum = 0.0;
  for (int number = 0; number < runs; ++number) {
    const Watch run = watch_of(family(), static_cast<std::uint64_t>(number));
    TurnLimit limit = limit_of(believed, run);
    StepRecord record;
    for (const Measurement& m : run.measurements) record = limit.step(m).front();
    const BoundedVector error = run.truth.back().head<4>() - record.x;
    sum += error.dot(record.P.ldlt().solve(error));
  }
  return sum;
}

TEST(TurnLimit, KnowsHowWellItKnows) {
  const double sum = nees_of(family(), 60);
  EXPECT_FALSE(testing::is_too_small(sum, 240.0)) << sum;
  EXPECT_FALSE(testing::is_too_large(sum, 240.0)) << sum;
}

TEST(TurnLimit, ATurnThatIsNotOfItsFamilyIsCaught) {
  Turn slower = family();
  slower.rate_degps = 0.05;
  EXPECT_TRUE(testing::is_too_large(nees_of(slower, 10), 40.0));
}

TEST(TurnLimit, TheSameRecordingGivesTheSameBits) {
  const Watch run = watch_of(family(), 3);
  TurnLimit one = limit_of(family(), run, 100), again = limit_of(family(), run, 100);
  for (const Measurement& m : run.measurements) {
    const auto records = one.step(m), same = again.step(m);
    ASSERT_EQ(records.size(), 1u);
    ASSERT_EQ(records[0].x, same[0].x);
    ASSERT_EQ(records[0].P, same[0].P);
  }
  EXPECT_TRUE(one.fresh()->step(run.measurements[0]).empty()) << "nobody has begun it";
}

TEST(TurnLimit, TellsMissingRepeatedAndLateMeasurementsApart) {
  const Watch run = watch_of(family(), 4);
  TurnLimit limit = limit_of(family(), run, 100);
  limit.step(run.measurements[0]);
  EXPECT_EQ(limit.step(run.measurements[0])[0].status, StepStatus::rejected);
  Measurement late = run.measurements[1];
  late.time_s = 1.0;
  EXPECT_EQ(limit.step(late)[0].status, StepStatus::rejected);
  Measurement deaf = run.measurements[1];
  deaf.z.setConstant(kNaN);
  EXPECT_EQ(limit.step(deaf)[0].status, StepStatus::coasted);
  Measurement bearing = run.measurements[2];
  bearing.z[1] = kNaN;
  EXPECT_EQ(limit.step(bearing)[0].status, StepStatus::ok);
  EXPECT_EQ(limit.counts().missing, 1);
  EXPECT_EQ(limit.counts().repeated, 1);
  EXPECT_EQ(limit.counts().out_of_order, 1);
  EXPECT_FALSE(limit.is_lost());
}

TEST(TurnLimit, IsLostWhereNothingCouldHaveLedToAMeasurement) {
  const Watch run = watch_of(family(), 4);
  TurnLimit limit = limit_of(family(), run, 100);
  Measurement impossible = run.measurements[0];
  impossible.z[1] = 1e200;
  EXPECT_TRUE(limit.step(impossible).empty());
  EXPECT_TRUE(limit.is_lost());
  EXPECT_EQ(limit.counts().failed, 1);
  limit.take_over(0.0, run.begun, BoundedMatrix(kVariances.asDiagonal()));
  EXPECT_EQ(limit.step(run.measurements[1]).size(), 1u);
  limit.take_over(0.0, run.begun.head<4>(), BoundedMatrix(kVariances.head<4>().asDiagonal()));
  EXPECT_TRUE(limit.is_lost()) << "without a frequency there is nothing to begin with";
}

TEST(TurnLimit, RefusesWhatItDoesNotKnow) {
  EXPECT_THROW(TurnLimit({.turn = {.is_course = true}}), std::invalid_argument);
  EXPECT_THROW(TurnLimit({.turn = family(), .hypotheses = 9}), std::invalid_argument);
}

}  // namespace
}  // namespace truebearing::turn_limit_test
