// SPDX-License-Identifier: Apache-2.0
// What every tracker of positions promises, whatever filter and motion are behind it, over random runs: made by name,
// as a study makes them.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/line_trackers.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/core/covariance.hpp"
#include "truebearing/study/tracker_registry.hpp"

namespace truebearing::tracker_properties_test {
namespace {

constexpr double kExact = 1e-9;  // relative: the same algebra in another order, over fifty steps
constexpr int kRuns = 5, kSteps = 50;

struct Case {
  const char* name;
  const char* kind;
  int dimensions;
  const char* configuration;  // but for the measurement and the start
  bool splits = true;         // Q(a + b) is that of Q(a) and Q(b): noise continuous in time
};

void PrintTo(const Case& tested, std::ostream* out) {
  *out << tested.name;
}

class TrackerProperty : public ::testing::TestWithParam<Case> {
 protected:
  std::unique_ptr<Tracker> tracker() const {
    const std::string text = std::string(GetParam().configuration) +
                             "\nmeasurement = { model = \"position\", sigma_m = 100.0 }\nstart = { kind = "
                             "\"two_point\" }\n";
    const SharedTable table = parse_toml(text, "tracker.toml");
    TableReader reader(table, "tracker.toml");
    return make_tracker(GetParam().kind, reader);
  }

  // A target on a random course, measured at random times with a standard deviation of 100 m; some are missing.
  std::vector<Measurement> log(std::uint64_t run) const {
    RandomStream random({.seed = 12, .run = run}, StreamId::test);
    const auto draw = [&](double sigma) {
      return BoundedVector(BoundedVector::NullaryExpr(GetParam().dimensions, [&] { return sigma * random.normal(); }));
    };
    BoundedVector position = draw(1e4), velocity = draw(100.0);
    std::vector<Measurement> measurements;
    double time_s = 0.0;
    for (int k = 0; k < kSteps; ++k) {
      const double dt_s = random.uniform(0.5, 2.0);
      time_s += dt_s;
      position += dt_s * velocity;
      velocity += dt_s * draw(3.0);
      BoundedVector z = position + draw(100.0);
      if (k > 2 && random.uniform() < 0.2) z.setConstant(kNaN);
      measurements.push_back({.time_s = time_s, .z = z, .sigma = {}, .sensor = {}});
    }
    return measurements;
  }

  static void expect_same(const StepRecord& a, const StepRecord& b) {
    ASSERT_EQ(a.x.size(), b.x.size());
    EXPECT_LT((a.x - b.x).norm(), kExact * (1.0 + b.x.norm())) << b.time_s;
    EXPECT_LT((a.P - b.P).norm(), kExact * b.P.norm()) << b.time_s;
  }
};

TEST_P(TrackerProperty, CovarianceStaysSymmetricAndPositiveSemiDefinite) {
  for (std::uint64_t run = 0; run < kRuns; ++run) {
    const auto made = tracker();
    int records = 0;
    for (const Measurement& measurement : log(run))
      for (const StepRecord& record : made->step(measurement)) {
        EXPECT_TRUE(is_covariance(record.P)) << run << " at " << record.time_s;
        EXPECT_TRUE(record.x.allFinite()) << run << " at " << record.time_s;
        ++records;
      }
    EXPECT_GE(records, kSteps - 2) << "a track begins with its second position";
  }
}

// predict(a + b) = predict(b) after predict(a): a time at which nothing was measured changes nothing.
TEST_P(TrackerProperty, StepsWithoutAMeasurementInBetweenChangeNothing) {
  if (!GetParam().splits) GTEST_SKIP() << "its process noise is one draw per interval, however long";
  for (std::uint64_t run = 0; run < kRuns; ++run) {
    const auto whole = tracker(), split = tracker();
    double last_s = 0.0;
    for (const Measurement& measurement : log(run)) {
      Measurement nothing = measurement;
      nothing.z.setConstant(kNaN);
      nothing.time_s = 0.3 * last_s + 0.7 * measurement.time_s;
      if (last_s > 0.0) split->step(nothing);
      last_s = measurement.time_s;
      const auto a = split->step(measurement), b = whole->step(measurement);
      ASSERT_EQ(a.size(), b.size());
      for (std::size_t i = 0; i < a.size(); ++i) expect_same(a[i], b[i]);
    }
  }
}

// R -> infinity = missing. What is missing is no step of its own, which such a noise would tell apart.
TEST_P(TrackerProperty, MeasurementsThatSayNothingAreMissingOnes) {
  if (!GetParam().splits) GTEST_SKIP() << "its process noise is one draw per interval, however long";
  for (std::uint64_t run = 0; run < kRuns; ++run) {
    const auto made = tracker(), other = tracker();
    int step = 0;
    for (const Measurement& measurement : log(run)) {
      Measurement missing = measurement, vague = measurement;
      if (++step % 5 == 0 && !measurement.is_missing()) {
        missing.z.setConstant(kNaN);
        vague.sigma = BoundedVector::Constant(measurement.z.size(), 1e12);
      }
      const auto a = made->step(vague), b = other->step(missing);
      ASSERT_EQ(a.size(), b.size());
      for (std::size_t i = 0; i < a.size(); ++i) expect_same(a[i], b[i]);
    }
  }
}

// Where the clock began and where the axes meet is nobody's business.
TEST_P(TrackerProperty, EstimatesMoveWithTheFrameAndTheClock) {
  const double away_m = 5e4, later_s = 1024.0;
  const int d = GetParam().dimensions;
  for (std::uint64_t run = 0; run < kRuns; ++run) {
    const auto here = tracker(), there = tracker();
    for (Measurement measurement : log(run)) {
      const auto b = here->step(measurement);
      measurement.z.array() += away_m;
      measurement.time_s += later_s;
      const auto a = there->step(measurement);
      ASSERT_EQ(a.size(), b.size());
      for (std::size_t i = 0; i < a.size(); ++i) {
        StepRecord back = a[i];
        back.x.head(d).array() -= away_m;
        expect_same(back, b[i]);
      }
    }
  }
}

constexpr Case kCases[] = {
    {"LineKalman", "kalman", 1, "motion = { model = \"constant_velocity\", noise = \"continuous\", q_m2ps3 = 10.0 }"},
    {"PlaneKalman", "kalman", 2,
     "space = \"plane\"\nmotion = { model = \"constant_velocity\", noise = \"continuous\", q_m2ps3 = 10.0 }"},
    {"PlaneKalmanDiscrete", "kalman", 2,
     "space = \"plane\"\nmotion = { model = \"constant_velocity\", noise = \"discrete\", sigma_a_mps2 = 5.0 }", false},
    {"PlaneUnscented", "unscented", 2,
     "space = \"plane\"\nmotion = { model = \"constant_velocity\", noise = \"continuous\", q_m2ps3 = 10.0 }"},
    {"PlaneMultipleModels", "imm", 2,
     "space = \"plane\"\nmodes = [\n"
     "  { model = \"constant_velocity\", noise = \"discrete\", sigma_a_mps2 = 2.0 },\n"
     "  { model = \"coordinated_turn\", turn_rates_degps = [-5.0, 5.0], noise = \"discrete\", sigma_a_mps2 = 2.0 },\n"
     "]\ntransition = { leave_first = 0.05, leave_other = 0.1, to_first = 0.8, period_s = 1.0 }",
     false},
};

INSTANTIATE_TEST_SUITE_P(Positions, TrackerProperty, ::testing::ValuesIn(kCases),
                         [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace truebearing::tracker_properties_test
