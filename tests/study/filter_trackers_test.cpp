// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/filter_trackers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fmt/format.h>

#include "tests/support/bearings.hpp"
#include "tests/support/error_message.hpp"
#include "truebearing/simulation/line_scenario.hpp"
#include "truebearing/study/tracker_registry.hpp"

namespace truebearing::filter_trackers_test {
namespace {

using ::testing::AllOf;
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

// A climb that is known better than the flight; in the plane there is none.
TEST(FilterTrackers, BeginWithAClimbOfTheirOwn) {
  const std::string start = "start = { kind = \"one_point\", velocity_sigma_mps = 100.0, climb_sigma_mps = 5.0 }\n";
  const auto of_model = [&](const std::string& model, const std::string& space) {
    return make("space = \"" + space +
                    "\"\nmotion = { model = \"constant_velocity\", noise = \"continuous\", "
                    "q_m2ps3 = 1.0 }\nmeasurement = { model = \"" +
                    model + "\", sigma_m = 10.0 }\n" + start,
                "kalman");
  };
  Measurement first{.time_s = 0.0, .z = Eigen::Vector3d(1.0, 2.0, 3.0), .sigma = {}, .sensor = {}};
  const StepRecord record = of_model("position", "space")->step(first)[0];
  EXPECT_EQ(record.P(4, 4), 1e4);
  EXPECT_EQ(record.P(5, 5), 25.0);
  EXPECT_THAT(error_message([&] { of_model("position", "plane"); }),
              AllOf(HasSubstr("climb_sigma_mps: has no meaning but in space"), HasSubstr("velocity_sigma_mps alone")));
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

TEST(PositionTrackers, NeedNotBelieveWhatMeasurementsReport) {
  const std::string text =
      "motion = { model = \"constant_velocity\", noise = \"continuous\", q_m2ps3 = 1.0 }\n"
      "start = { kind = \"prior\", x = [0.0, 0.0], variance = [4.0, 1.0] }\n"
      "measurement = { model = \"position\", sigma_m = 2.0";
  Measurement seen{
      .time_s = 0.0, .z = BoundedVector::Constant(1, 1.0), .sigma = BoundedVector::Constant(1, 1.0), .sensor = {}};
  EXPECT_NEAR(make(text + " }\n", "kalman")->step(seen)[0].x[0], 0.8, 1e-12);
  EXPECT_NEAR(make(text + ", reported = true }\n", "kalman")->step(seen)[0].x[0], 0.8, 1e-12);
  EXPECT_NEAR(make(text + ", reported = false }\n", "kalman")->step(seen)[0].x[0], 0.5, 1e-12);
}

// A multiple model whose modes differ in their noise alone, each entered with its share.
std::string noise_modes(double loud, double quiet) {
  return fmt::format(
      "modes = [ {{ {0}, sigma_factor = {1} }}, {{ {0}, sigma_factor = {2} }} ]\n"
      "transition = {{ matrix = [0.6, 0.4, 0.6, 0.4], period_s = 1.0 }}\ninitial = [0.6, 0.4]\n",
      "model = \"constant_velocity\", noise = \"fixed\", variance = [0.0, 1e-4], period_s = 1.0", loud, quiet);
}

const std::string kPrior = "start = { kind = \"prior\", x = [0.0, 1.0], variance = [1.0, 0.01] }\n";

TEST(NoiseModes, OfOneFactorAreAFilterOfThatNoise) {
  const auto modes =
      make(noise_modes(2.0, 2.0) + kPrior + "measurement = { model = \"position\", sigma_m = 1.5 }\n", "imm");
  const auto filter =
      make("motion = { model = \"constant_velocity\", noise = \"fixed\", variance = [0.0, 1e-4], period_s = 1.0 }\n" +
               kPrior + "measurement = { model = \"position\", sigma_m = 3.0 }\n",
           "kalman");
  for (int k = 1; k <= 20; ++k) {
    const Measurement seen{
        .time_s = double(k), .z = BoundedVector::Constant(1, k + std::sin(3.0 * k)), .sigma = {}, .sensor = {}};
    const StepRecord a = modes->step(seen)[0], b = filter->step(seen)[0];
    EXPECT_TRUE(a.x.isApprox(b.x, 1e-12)) << k;
    EXPECT_TRUE(a.P.isApprox(b.P, 1e-12)) << k;
  }
}

TEST(NoiseModes, FollowATargetThroughAMixture) {
  LineParameters parameters;
  parameters.steps = 4000;
  parameters.process_noise_variance << 0.0, 1e-4;
  parameters.velocity_mps = 1.0;
  parameters.mixture = NoiseMixture{{0.6, 0.4}, {1.5625, 0.15625}};
  const Recording recording = LineScenario(parameters).simulate({});
  const std::string sensor = "measurement = { model = \"position\", sigma_m = 1.0 }\n";
  const auto mse = [&](const std::string& modes) {
    const auto tracker = make(modes + kPrior + sensor, "imm");
    double sum = 0.0;
    for (std::size_t k = 0; k < recording.measurements.size(); ++k)
      sum += std::pow(tracker->step(recording.measurements[k])[0].x[0] - recording.truth[0].x[k][0], 2);
    return sum / static_cast<double>(recording.measurements.size());
  };
  EXPECT_LT(mse(noise_modes(1.25, 0.3953)), 0.85 * mse(noise_modes(1.0, 1.0)))
      << "against the filter of the average variance";
}

}  // namespace
}  // namespace truebearing::filter_trackers_test
