#include "truebearing/tracker/bearings_batch_tracker.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/bearing_runs.hpp"
#include "truebearing/core/covariance.hpp"

namespace truebearing {
namespace {

using testing::data_scenario;

BearingsBatchOptions options() {
  BearingsBatchOptions o;
  o.sigma_rad = radians(1.0);
  return o;
}

Recording run(const std::string& scenario = "cho_s1") {
  return data_scenario(scenario)->simulate({1, Role::evaluation, 0});
}

Recording turning_target() {
  const toml::table table = parse_toml(testing::kTurningTarget, "turn.toml");
  return read_scenario(TableReader(table, "turn.toml"))->simulate({1, Role::evaluation, 0});
}

TEST(BearingsBatchTracker, SolvesAtItsTimesAndCoastsBetween) {
  BearingsBatchOptions o = options();
  o.solve_at_s = {480.0, 1000.0};
  BearingsBatchTracker tracker(o);
  Eigen::Vector4d solved = Eigen::Vector4d::Zero();
  for (const Measurement& m : run().measurements) {
    const auto records = tracker.step(m);
    EXPECT_EQ(records.empty(), m.time_s < 480.0) << m.time_s;
    if (records.empty()) continue;
    const StepRecord& record = records.front();
    EXPECT_EQ(record.batch.has_value(), m.time_s == 480.0 || m.time_s == 1000.0);
    if (record.batch) {
      EXPECT_TRUE(record.status == StepStatus::ok || (m.time_s == 480.0 && record.status == StepStatus::unobservable));
      EXPECT_EQ(record.batch->starts, 3);
      solved = record.x;
    } else {
      EXPECT_EQ(record.status, StepStatus::coasted);
      EXPECT_EQ(record.x.tail<2>(), solved.tail<2>());
    }
    EXPECT_TRUE(is_covariance(record.P)) << m.time_s;
  }
}

TEST(BearingsBatchTracker, EndsNearTheTruth) {
  BearingsBatchOptions o = options();
  o.solve_every_s = 100.0;
  BearingsBatchTracker tracker(o);
  const Recording recording = run();
  for (const Measurement& m : recording.measurements) tracker.step(m);
  const StepRecord& record = tracker.step(recording.measurements.back()).front();  // repeated: the same again
  EXPECT_EQ(record.status, StepStatus::rejected);
  EXPECT_LT((record.x.head<2>() - recording.truth[0].x.back().head<2>()).norm(), 500.0);
}

TEST(BearingsBatchTracker, SaysUnobservableBeforeOwnShipManoeuvres) {
  BearingsBatchTracker tracker(options());
  StepStatus at_200_s = StepStatus::ok, at_end = StepStatus::coasted;
  for (const Measurement& m : run().measurements) {
    const auto records = tracker.step(m);
    if (m.time_s == 200.0) at_200_s = records.front().status;
    if (m.time_s == 1500.0) at_end = records.front().status;
    if (m.time_s > 1500.0) break;
  }
  EXPECT_EQ(at_200_s, StepStatus::unobservable);
  EXPECT_EQ(at_end, StepStatus::ok);
}

TEST(BearingsBatchTracker, SlidingWindowForgetsWhatTheTargetDidBefore) {
  const Recording recording = turning_target();
  const auto error = [&](double window_s) {
    BearingsBatchOptions o = options();
    o.window_s = window_s;
    o.solve_every_s = 50.0;
    BearingsBatchTracker tracker(o);
    BoundedVector x;
    for (const Measurement& m : recording.measurements)
      if (const auto records = tracker.step(m); !records.empty()) x = records.front().x;
    return (x - recording.truth[0].x.back()).head<2>().norm();
  };
  EXPECT_LT(error(900.0), 0.5 * error(1e9));
}

TEST(BearingsBatchTracker, ForgetsWhatWasBeforeAManoeuvreThatItNotices) {
  const Recording recording = turning_target();
  const auto run_with = [&](bool cut) {
    BearingsBatchOptions o = options();
    o.solve_every_s = 50.0;
    o.cut_at_manoeuvres = cut;
    BearingsBatchTracker tracker(o);
    BoundedVector x;
    for (const Measurement& m : recording.measurements)
      if (const auto records = tracker.step(m); !records.empty()) x = records.front().x;
    return std::pair((x - recording.truth[0].x.back()).head<2>().norm(), tracker.manoeuvres_s());
  };
  const auto [averaged_m, none] = run_with(false);
  const auto [cut_m, noticed] = run_with(true);
  EXPECT_TRUE(none.empty());
  ASSERT_FALSE(noticed.empty());
  EXPECT_NEAR(noticed.front(), 1000.0, 200.0);
  EXPECT_LT(cut_m, 0.5 * averaged_m);
}

TEST(BearingsBatchTracker, MissingBearingsLeaveNoTrace) {
  const Recording recording = run();
  BearingsBatchOptions o = options();
  o.solve_at_s = {1000.0};
  BearingsBatchTracker with(o), without(o);
  BoundedVector a, b;
  for (const Measurement& m : recording.measurements) {
    if (m.time_s > 1000.0) break;
    if (const auto records = with.step(m); !records.empty()) a = records.front().x;
    if (m.is_missing()) continue;
    if (const auto records = without.step(m); !records.empty()) b = records.front().x;
  }
  EXPECT_EQ(a, b);
}

TEST(BearingsBatchTracker, PriorNeedsTheGuessThatItIsTold) {
  BearingsBatchOptions o = options();
  o.prior.emplace();
  o.prior->range_m = std::nan("");
  o.prior->range_sigma_m = std::nan("");
  o.prior->velocity_sigma_mps = 4.0;
  BearingsBatchTracker tracker(o);
  Recording recording = run("bearings_only_family");
  std::size_t records = 0;
  for (Measurement m : recording.measurements) {
    m.guess.reset();
    records += tracker.step(m).size();
  }
  EXPECT_EQ(records, 0u);
  tracker.reset();
  for (const Measurement& m : recording.measurements) records += tracker.step(m).size();
  EXPECT_GT(records, 0u);
}

TEST(BearingsBatchTracker, CloneAndResetStartAfresh) {
  BearingsBatchOptions o = options();
  o.solve_every_s = 60.0;
  o.warm_start = true;
  BearingsBatchTracker tracker(o);
  const Recording recording = run();
  const auto last = [&](Tracker& t) {
    BoundedVector x;
    for (const Measurement& m : recording.measurements)
      if (m.time_s < 800.0)
        if (const auto records = t.step(m); !records.empty()) x = records.front().x;
    return x;
  };
  const BoundedVector first = last(tracker);
  const auto clone = tracker.clone();
  tracker.reset();
  EXPECT_EQ(last(tracker), first);
  EXPECT_EQ(last(*clone), first);
}

}  // namespace
}  // namespace truebearing
