// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/bearings_batch_tracker.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/bearing_frequency_runs.hpp"
#include "tests/support/bearing_runs.hpp"
#include "truebearing/core/covariance.hpp"

namespace truebearing::bearings_batch_tracker_test {
namespace {

using testing::data_scenario;
using testing::jump;
using testing::KimSong;

BearingsBatchOptions options() {
  BearingsBatchOptions o;
  o.sigma_rad = radians(1.0);
  return o;
}

Recording run(const std::string& scenario = "cho_s1") {
  return data_scenario(scenario)->simulate({1, Role::evaluation, 0});
}

Recording turning_target() {
  const SharedTable table = parse_toml(testing::kTurningTarget, "turn.toml");
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
    std::vector<double> noticed_s;
    for (const TrackEvent& event : tracker.events())
      if (event.kind == TrackEvent::Kind::turn_began) noticed_s.push_back(event.time_s);
    return std::pair((x - recording.truth[0].x.back()).head<2>().norm(), noticed_s);
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

TEST(BearingsBatchTracker, BeliefInTheVelocityNeedsNoGuess) {
  BearingsBatchOptions o = options();
  o.prior = VelocityPrior{4.0};
  BearingsBatchTracker believing(o), plain(options());
  const auto last_x = [](BearingsBatchTracker& tracker, bool guessed) {
    BoundedVector x;
    for (Measurement m : run("bearings_only_family").measurements) {
      if (!guessed) m.guess.reset();
      if (const auto records = tracker.step(m); !records.empty()) x = records.front().x;
    }
    tracker.reset();
    return x;
  };
  EXPECT_EQ(last_x(believing, true), last_x(believing, false));
  EXPECT_NE(last_x(believing, true), last_x(plain, true));
}

TEST(BearingsBatchTracker, PriorNeedsTheGuessThatItIsTold) {
  BearingsBatchOptions o = options();
  RangePrior of_the_guess;
  of_the_guess.velocity_sigma_mps = 4.0;
  o.prior = of_the_guess;
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

TEST(BearingsBatchTracker, FreshAndResetStartAnew) {
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
  const auto another = tracker.fresh();
  tracker.reset();
  EXPECT_EQ(last(tracker), first);
  EXPECT_EQ(last(*another), first);
}

// z = [bearing, frequency] of Kim and Song's scenario.
std::vector<Measurement> heard(std::uint64_t run, const std::function<double(double)>& f0_hz) {
  RandomStream stream({1, Role::evaluation, run}, StreamId::test);
  std::vector<Measurement> measurements;
  for (double t = 0.0; t <= KimSong::kEnd_s; t += KimSong::kPeriod_s)
    measurements.push_back(
        {.time_s = t, .z = KimSong::measured(t, f0_hz(t), 1.0, stream), .sigma = {}, .sensor = KimSong::own_ship(t)});
  return measurements;
}

BearingsBatchOptions with_frequencies(double solve_every_s = 1050.0) {
  BearingsBatchOptions o = options();
  o.frequency.emplace();
  o.frequency->sigma_hz = KimSong::kSigma_hz;
  o.solve_every_s = solve_every_s;
  if (solve_every_s >= KimSong::kEnd_s) o.solve_at_s = {KimSong::kEnd_s};
  return o;
}

std::vector<TrackEvent> events_of(const Tracker& tracker, TrackEvent::Kind kind) {
  std::vector<TrackEvent> events;
  for (const TrackEvent& event : tracker.events())
    if (event.kind == kind) events.push_back(event);
  return events;
}

TEST(BearingsBatchTracker, WithFrequenciesTheStateHasTheSource) {
  BearingsBatchTracker tracker(with_frequencies());
  EXPECT_EQ(&tracker.space(), &plane_frequency_space());
  testing::BearingFrequencyWindows windows = KimSong::windows(0);
  StepRecord last;
  for (const Measurement& m : heard(0, jump(0.0)))
    if (const auto records = tracker.step(m); !records.empty()) last = records.front();
  ASSERT_EQ(last.x.size(), 5);
  EXPECT_EQ(last.space, &plane_frequency_space());
  EXPECT_EQ(last.status, StepStatus::ok);
  EXPECT_TRUE(is_covariance(last.P));
  TargetMotionBatch batch;
  const BatchEstimate expected = batch.solve(windows.bearings, std::nullopt, nullptr, &windows.frequencies);
  EXPECT_EQ(last.x.head<4>(), expected.x);
  EXPECT_EQ(tracker.estimate().x, expected.x);
  EXPECT_NEAR(last.x[4], 100.0, 5.0 * std::sqrt(last.P(4, 4)));
  EXPECT_NEAR(std::sqrt(last.P(4, 4)), 0.0072, 0.0015);
}

TEST(BearingsBatchTracker, CarriesTheSourceOnWithItsCovariance) {
  BearingsBatchOptions o = with_frequencies();
  BearingsBatchTracker tracker(o);
  for (const Measurement& m : heard(0, jump(0.0))) tracker.step(m);
  Measurement none{.time_s = 1050.0, .z = Eigen::Vector2d(NAN, NAN), .sigma = {}, .sensor = std::nullopt};
  const StepRecord now = tracker.step(none).front();
  none.time_s = 1150.0;
  const StepRecord later = tracker.step(none).front();
  EXPECT_EQ(later.status, StepStatus::coasted);
  Eigen::MatrixXd F = Eigen::MatrixXd::Identity(5, 5);
  F(0, 2) = F(1, 3) = 100.0;
  EXPECT_LT((later.x - F * now.x).norm(), 1e-9 * now.x.norm());
  EXPECT_LT((later.P - F * now.P * F.transpose()).norm(), 1e-9 * later.P.norm());
  EXPECT_EQ(tracker.counts().missing, 2);
}

TEST(BearingsBatchTracker, SaysOnceWhenTheSourceChangedAndWhenTheRangeWasKnown) {
  BearingsBatchTracker tracker(with_frequencies(35.0));
  double known_s = 0.0;
  for (const Measurement& m : heard(1, jump(30.0, 600.0, 800.0))) {
    const auto records = tracker.step(m);
    if (known_s == 0.0 && !records.empty() && records.front().status == StepStatus::ok) known_s = m.time_s;
  }
  const auto changes = events_of(tracker, TrackEvent::Kind::source_changed);
  ASSERT_EQ(changes.size(), 2u);
  EXPECT_EQ(changes[0].time_s, 602.0);
  EXPECT_NEAR(changes[0].value, 130.0, 0.2);
  EXPECT_EQ(changes[1].time_s, 805.0);
  EXPECT_NEAR(changes[1].value, 100.0, 0.2);
  const auto known = events_of(tracker, TrackEvent::Kind::range_known);
  ASSERT_EQ(known.size(), 1u);
  EXPECT_EQ(known[0].time_s, known_s);
  tracker.reset();
  EXPECT_TRUE(tracker.events().empty());
}

TEST(BearingsBatchTracker, EachHandlingOfAChangeDoesWhatItSays) {
  using Handling = FrequencyChangeOptions::Handling;
  const auto square = [&](Handling handling) {
    double sum = 0.0;
    for (std::uint64_t run = 0; run < 20; ++run) {
      BearingsBatchOptions o = with_frequencies();
      o.frequency->changes.handling = handling;
      BearingsBatchTracker tracker(o);
      BoundedVector x;
      for (const Measurement& m : heard(run, jump(30.0, 600.0, 800.0)))
        if (const auto records = tracker.step(m); !records.empty()) x = records.front().x;
      EXPECT_TRUE(handling == Handling::ignored || std::abs(x[4] - 100.0) < 0.1) << x[4];
      sum += (x.head<2>() - KimSong::target(KimSong::kEnd_s).head<2>()).squaredNorm() / 20.0;
    }
    return std::sqrt(sum);
  };
  const double levels = square(Handling::levels), switched = square(Handling::bearings_only);
  EXPECT_LT(levels, 155.0 * 1.5);
  EXPECT_GT(switched, 1.5 * levels);
  EXPECT_LT(square(Handling::segments), switched);
  EXPECT_GT(square(Handling::ignored), 5000.0);
}

TEST(BearingsBatchTracker, EitherOfBearingAndFrequencyMayBeMissing) {
  std::vector<Measurement> measurements = heard(0, jump(0.0));
  for (std::size_t k = 0; k < measurements.size(); ++k) {
    if (k % 3 == 1) measurements[k].z[0] = std::nan("");
    if (k % 3 == 2) measurements[k].z[1] = std::nan("");
  }
  BearingsBatchTracker tracker(with_frequencies());
  BoundedVector x;
  for (const Measurement& m : measurements)
    if (const auto records = tracker.step(m); !records.empty()) x = records.front().x;
  ASSERT_EQ(x.size(), 5);
  EXPECT_EQ(tracker.counts().missing, 0);
  EXPECT_LT((x.head<2>() - KimSong::target(KimSong::kEnd_s).head<2>()).norm(), 4.5 * std::sqrt(1.5) * 155.0);
}

TEST(BearingsBatchTracker, BeforeAFrequencyIsHeardItsSourceIsOpen) {
  BearingsBatchTracker tracker(with_frequencies());
  BearingsBatchTracker of_bearings([] {
    BearingsBatchOptions o = with_frequencies();
    o.frequency.reset();
    return o;
  }());
  StepRecord last, expected;
  for (Measurement m : heard(0, jump(0.0))) {
    if (const auto records = of_bearings.step(m); !records.empty()) expected = records.front();
    m.z[1] = std::nan("");
    if (const auto records = tracker.step(m); !records.empty()) last = records.front();
  }
  ASSERT_EQ(last.x.size(), 5);
  ASSERT_EQ(expected.x.size(), 4);
  EXPECT_EQ(last.x.head<4>(), expected.x);
  EXPECT_GE(last.P(4, 4), 1e6);
  EXPECT_TRUE(is_covariance(last.P));
}

}  // namespace
}  // namespace truebearing::bearings_batch_tracker_test
