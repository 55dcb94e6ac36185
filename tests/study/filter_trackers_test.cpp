// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/filter_trackers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/bearings.hpp"
#include "tests/support/error_message.hpp"
#include "truebearing/study/tracker_registry.hpp"

namespace truebearing::filter_trackers_test {
namespace {

using testing::bearings_run;
using testing::error_message;
using ::testing::HasSubstr;

const std::string kBearings = R"(
space = "plane"
motion = { model = "constant_velocity", noise = "continuous", q_m2ps3 = 1e-6 }
measurement = { model = "bearing", bearing_sigma_deg = 1.0 }
)";
const std::string kGuessed = "start = { kind = \"range\", guess = true, velocity_sigma_mps = 3.0 }\n";
const std::string kMatched =
    "start = { kind = \"range\", guess = true, between_m = [5e3, 10e3], velocity_sigma_mps = 3.0 }\n";

std::unique_ptr<Tracker> make(const std::string& text, const std::string& kind) {
  const SharedTable table = parse_toml(text, "study.toml");
  TableReader reader(table, "study.toml", "trackers.mine");
  return make_tracker(kind, reader);
}

double last_error_m(Tracker& tracker) {
  const Recording recording = bearings_run(2);
  double error = 0.0;
  for (std::size_t k = 0; k < recording.measurements.size(); ++k) {
    const auto records = tracker.step(recording.measurements[k]);
    EXPECT_EQ(records.size(), 1u);
    error = (records[0].x - recording.truth[0].x[k]).head<2>().norm();
  }
  return error;
}

TEST(BearingTrackers, EveryKindFollowsATargetThatIsSeenInBearings) {
  for (const char* kind : {"kalman", "unscented", "modified_gain", "log_polar"})
    for (const std::string& start : {kGuessed, kMatched}) {
      const auto tracker = make(kBearings + start, kind);
      EXPECT_EQ(&tracker->space(), &plane_space());
      EXPECT_LT(last_error_m(*tracker), 2500.0) << kind;
    }
  for (const char* filter : {"kalman", "unscented", "modified_gain", "log_polar"})
    for (const char* size : {"ranges = 6\n", "ranges = 4\nvelocity_cells = 8\n"}) {
      const auto bank = make(kBearings + kMatched + size + "filter = \"" + filter + "\"\n", "range_bank");
      EXPECT_LT(last_error_m(*bank), 2500.0) << filter;
    }
}

TEST(BearingTrackers, MayBeginFromAPriorToo) {
  const auto tracker = make(
      kBearings + "start = { kind = \"prior\", x = [1, 2, 3, 4], variance = [1, 1, 1, 1], time_s = 0.0 }\n", "kalman");
  Measurement nothing;
  nothing.time_s = 10.0;
  EXPECT_EQ(tracker->step(nothing)[0].x, Eigen::Vector4d(31.0, 42.0, 3.0, 4.0));
}

TEST(BearingTrackers, OfATurningTargetAreOfTheSameType) {
  const std::string turn =
      "motion = { model = \"coordinated_turn\", turn_rate_degps = 0.0, noise = \"continuous\", q_m2ps3 = 1e-6 }\n"
      "measurement = { model = \"bearing\", bearing_sigma_deg = 1.0 }\n";
  EXPECT_EQ(last_error_m(*make(turn + kGuessed, "log_polar")), last_error_m(*make(kBearings + kGuessed, "log_polar")));
}

TEST(BearingTrackers, RefuseWhatBearingsCannotGive) {
  const auto refusal = [](const std::string& text, const std::string& kind = "kalman") {
    return error_message([&] { make(text, kind); });
  };
  EXPECT_THAT(refusal(kBearings + "start = { kind = \"two_point\" }\n"), HasSubstr("start.kind"));
  EXPECT_THAT(refusal(kBearings + kGuessed + "output_pull = 0.5\n"), HasSubstr("output_pull"));
  EXPECT_THAT(refusal(kBearings + kGuessed + "form = \"round\"\n"), HasSubstr("form"));
  EXPECT_THAT(refusal(kBearings + kGuessed + "ranges = 6\n"), HasSubstr("ranges"));
  EXPECT_THAT(refusal("measurement = { model = \"bearing\", bearing_sigma_deg = 1.0 }\nmodes = []\n", "imm"),
              HasSubstr("modes"));
}

TEST(RangeBankMaker, RefusesWhatMakesNoBank) {
  const std::string bank = kBearings + "filter = \"kalman\"\n";
  const auto refusal = [](const std::string& text) { return error_message([&] { make(text, "range_bank"); }); };
  EXPECT_THAT(refusal(bank + kGuessed), HasSubstr("ranges"));
  EXPECT_THAT(refusal(bank + kGuessed + "ranges = 0\n"), HasSubstr("ranges"));
  EXPECT_THAT(refusal(bank + kGuessed + "ranges = 6\nvelocity_cells = 2\n"), HasSubstr("velocity_cells"));
  EXPECT_THAT(refusal(bank + kGuessed + "ranges = 6\nspeed_between_mps = [2, 8]\n"), HasSubstr("one velocity cell"));
  EXPECT_THAT(refusal(bank + kGuessed + "ranges = 6\nvelocity_cells = 8\nspeed_between_mps = [8, 2]\n"),
              HasSubstr("low < high"));
  EXPECT_THAT(refusal(bank + kGuessed + "ranges = 600\nvelocity_cells = 64\n"), HasSubstr("38400"));
  EXPECT_THAT(refusal(kBearings + kGuessed + "ranges = 6\nfilter = \"particle\"\n"), HasSubstr("filter"));
  const std::string course =
      "start = { kind = \"range\", guess = true, course = { from_bearing_deg = 180, sigma_deg = 50 } }\n";
  EXPECT_THAT(refusal(bank + course + "ranges = 6\nvelocity_cells = 8\n"), HasSubstr("beside a course"));
}

}  // namespace
}  // namespace truebearing::filter_trackers_test
