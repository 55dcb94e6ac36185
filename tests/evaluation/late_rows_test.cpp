// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/late_rows.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <vector>

#include "tests/support/error_message.hpp"
#include "tests/support/fakes.hpp"
#include "truebearing/core/chi_square.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/filter/erased_motion.hpp"
#include "truebearing/filter/filter_kinds.hpp"
#include "truebearing/filter/interacting_multiple_model.hpp"
#include "truebearing/motion/constant_velocity.hpp"
#include "truebearing/tracker/filter_tracker.hpp"
#include "truebearing/tracker/position_sensor.hpp"

namespace truebearing::late_rows_test {
namespace {

using testing::error_message;
using ::testing::HasSubstr;

std::unique_ptr<TrackedState> under(FilterKind kind, double sigma_a_mps2) {
  return make_filter_state(kind, erased(ConstantVelocity<2, DiscreteWhiteNoise>{{sigma_a_mps2}}));
}

std::unique_ptr<Tracker> tracker(std::unique_ptr<TrackedState> state) {
  FilterTrackerOptions options;
  options.gate_nis = chi_square_quantile(0.999, 2.0);
  return std::make_unique<FilterTracker>(plane_space(), std::move(state), sensor_of(PositionSensor<2>{{50.0, 50.0}}),
                                         TwoPointStart{}, options);
}

TrackerSet trackers() {
  InteractingMultipleModel::Modes modes;
  modes.push_back(under(FilterKind::kalman, 1.0));
  modes.push_back(under(FilterKind::kalman, 20.0));
  Ensemble ensemble;
  ensemble.add("kf", tracker(under(FilterKind::kalman, 5.0)));
  ensemble.add("ukf", tracker(under(FilterKind::unscented, 5.0)));
  ensemble.add(
      "imm", tracker(std::make_unique<InteractingMultipleModel>(std::move(modes), star_chain(2, 0.05, 0.1, 1.0, 1.0))));
  TrackerSet set(std::move(ensemble));
  for (const char* name : {"kf", "ukf", "imm"}) set.show_member(name);
  return set;
}

struct Row {
  double arrives_s;
  Measurement measurement;
};

// A target on a straight line with a measurement each second, some of which are wild or missing; a share of the rows
// comes up to `late_s` later.
std::vector<Row> rows(double late_share, double late_s) {
  RandomStream random({9, Role::evaluation, 0}, StreamId::test);
  std::vector<Row> all;
  for (int k = 0; k < 400; ++k) {
    Eigen::Vector2d z(100.0 * k + 50.0 * random.normal(), 50.0 * random.normal());
    if (random.uniform() < 0.05) z[0] += 5000.0;
    if (random.uniform() < 0.05) z.setConstant(std::nan(""));
    const double delay_s = random.uniform() < late_share ? late_s * random.uniform() : 0.0;
    all.push_back({k + delay_s, {.time_s = double(k), .z = z, .sigma = {}, .sensor = {}}});
  }
  std::stable_sort(all.begin(), all.end(), [](const Row& a, const Row& b) { return a.arrives_s < b.arrives_s; });
  return all;
}

std::vector<StepRecord> last_of(const TrackerSet& set) {
  std::vector<StepRecord> last;
  for (int i = 0; i < set.size(); ++i) last.push_back(set.records(i)[0]);
  return last;
}

TEST(LateRows, AreWorthWhatTheyWouldHaveBeenInTime) {
  TrackerSet late = trackers(), sorted = trackers();
  LateRows buffer(late, 5.0);
  std::map<double, BoundedVector> published;  // by time, the last of each
  std::size_t revised_rows = 0;
  for (const Row& row : rows(0.1, 5.0))
    buffer.step(late, row.measurement, [&](const Measurement& taken, bool revised) {
      revised_rows += revised;
      if (!late.records(2).empty()) published[taken.time_s] = late.records(2)[0].x;
    });
  std::vector<Row> in_time = rows(0.1, 5.0);
  std::sort(in_time.begin(), in_time.end(),
            [](const Row& a, const Row& b) { return a.measurement.time_s < b.measurement.time_s; });
  for (const Row& row : in_time) {
    sorted.step(row.measurement);
    if (!sorted.records(2).empty()) {
      EXPECT_EQ(published[row.measurement.time_s], sorted.records(2)[0].x) << row.measurement.time_s;
    }
  }
  const std::vector<StepRecord> given = last_of(late), wanted = last_of(sorted);
  for (std::size_t i = 0; i < given.size(); ++i) {
    EXPECT_EQ(given[i].x, wanted[i].x);
    EXPECT_EQ(given[i].P, wanted[i].P);
    EXPECT_EQ(given[i].track, wanted[i].track);
    EXPECT_EQ(late.counts(static_cast<int>(i)).gated, sorted.counts(static_cast<int>(i)).gated);
    EXPECT_EQ(late.counts(static_cast<int>(i)).missing, sorted.counts(static_cast<int>(i)).missing);
    EXPECT_EQ(late.counts(static_cast<int>(i)).out_of_order, 0);
  }
  EXPECT_GT(buffer.taken(), 20u);
  EXPECT_EQ(buffer.too_late(), 0u);
  EXPECT_GT(revised_rows, buffer.taken());
  EXPECT_LT(buffer.again(), 6u * buffer.taken());
}

// The partner: without the buffer they are lost.
TEST(LateRows, AreLostWithoutIt) {
  TrackerSet plain = trackers();
  for (const Row& row : rows(0.1, 5.0)) plain.step(row.measurement);
  EXPECT_GT(plain.counts(0).out_of_order, 20);
}

TEST(LateRows, OlderOnesAreCounted) {
  TrackerSet late = trackers();
  LateRows buffer(late, 2.0);
  const auto ignore = [](const Measurement&, bool) {};
  for (const Row& row : rows(0.1, 5.0)) buffer.step(late, row.measurement, ignore);
  EXPECT_GT(buffer.too_late(), 5u);
  EXPECT_GT(buffer.taken(), 5u);
  EXPECT_EQ(late.counts(0).out_of_order, 0);
}

TEST(LateRows, OfOneTimeAreTakenInTheOrderInWhichTheyCome) {
  TrackerSet late = trackers(), sorted = trackers();
  LateRows buffer(late, 5.0);
  const auto ignore = [](const Measurement&, bool) {};
  const auto at = [](double time_s, double east_m) {
    return Measurement{.time_s = time_s, .z = Eigen::Vector2d(east_m, 0.0), .sigma = {}, .sensor = {}};
  };
  for (const Measurement& one : {at(0, 0), at(1, 100), at(2, 230), at(1, 120), at(3, 300)})
    buffer.step(late, one, ignore);
  for (const Measurement& one : {at(0, 0), at(1, 100), at(1, 120), at(2, 230), at(3, 300)}) sorted.step(one);
  EXPECT_EQ(late.records(0)[0].x, sorted.records(0)[0].x);
}

TEST(LateRows, OneMayComeBeforeTheFirst) {
  TrackerSet late = trackers(), sorted = trackers();
  LateRows buffer(late, 5.0);
  const auto ignore = [](const Measurement&, bool) {};
  const auto at = [](double time_s, double east_m) {
    return Measurement{.time_s = time_s, .z = Eigen::Vector2d(east_m, 0.0), .sigma = {}, .sensor = {}};
  };
  for (const Measurement& one : {at(10, 0), at(9, -110), at(11, 100), at(12, 230)})
    EXPECT_TRUE(buffer.step(late, one, ignore));
  for (const Measurement& one : {at(9, -110), at(10, 0), at(11, 100), at(12, 230)}) sorted.step(one);
  EXPECT_EQ(late.records(0)[0].x, sorted.records(0)[0].x);
  EXPECT_FALSE(buffer.step(late, at(6, 0), ignore));
}

// A window of a thousand rows, one in ten of which comes ten rows late: few more are run again than come after it.
TEST(LateRows, OfAQuickSensorRunFewAgain) {
  TrackerSet late = trackers(), sorted = trackers();
  LateRows buffer(late, 1.0);
  const auto ignore = [](const Measurement&, bool) {};
  const auto at = [](int k) {
    const double time_s = 0.001 * k;
    return Measurement{
        .time_s = time_s, .z = Eigen::Vector2d(100.0 * time_s, 30.0 * (k % 3)), .sigma = {}, .sensor = {}};
  };
  for (int k = 0; k < 4000; ++k) {
    if (k % 10 != 0) buffer.step(late, at(k), ignore);
    if (k >= 10 && k % 10 == 0) buffer.step(late, at(k - 10), ignore);
  }
  for (int k = 0; k < 3990; ++k) sorted.step(at(k));
  for (int k = 3991; k < 4000; ++k) sorted.step(at(k));
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(late.records(i)[0].x, sorted.records(i)[0].x);
    EXPECT_EQ(late.records(i)[0].P, sorted.records(i)[0].P);
  }
  EXPECT_EQ(buffer.taken(), 399u);
  EXPECT_LT(buffer.again(), buffer.taken() * (10u + 1000u / 32u));
}

TEST(LateRows, TrackersThatCannotBeRunAgainAreRefused) {
  Ensemble ensemble;
  ensemble.add("fake", std::make_unique<testing::ScriptedTracker>());
  TrackerSet set(std::move(ensemble));
  EXPECT_THAT(error_message([&] { LateRows(set, 1.0); }), HasSubstr("\"fake\""));
  const TrackerSet good = trackers();
  EXPECT_THAT(error_message([&] { LateRows(good, 0.0); }), HasSubstr("seconds > 0"));
}

}  // namespace
}  // namespace truebearing::late_rows_test
