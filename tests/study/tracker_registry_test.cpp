// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/tracker_registry.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/error_message.hpp"
#include "tests/support/line_trackers.hpp"
#include "tests/support/radar_study.hpp"
#include "truebearing/study/study.hpp"

namespace truebearing::tracker_registry_test {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using testing::error_message;
using ::testing::HasSubstr;
using testing::kStudy;
using testing::replaced;
using testing::TemporaryFolder;
using testing::write_study;

std::unique_ptr<Tracker> make(const std::string& text, const std::string& kind) {
  const SharedTable table = parse_toml(text, "study.toml");
  TableReader reader(table, "study.toml", "trackers.mine");
  return make_tracker(kind, reader);
}

TEST(TrackerRegistry, OwnKindWorksInAStudy) {
  register_tracker("mine", [](TableReader& table) -> std::unique_ptr<Tracker> {
    testing::RadarFilter radar;
    radar.sigma_m = table.number("believed_m", kPositive);
    return radar.tracker();
  });
  EXPECT_THAT(tracker_kinds(), Contains("mine"));
  const TemporaryFolder folder;
  const std::string with = kStudy + "\n[trackers.own]\nkind = \"mine\"\nbelieved_m = 3000.0\n";
  const Study study = Study::load(write_study(folder, replaced(with, "reference = \"tuned\"", "reference = \"own\"")));
  const auto tracker = study.make_tracker("own");
  EXPECT_EQ(tracker->step(testing::position(1.0, 10.0)).size(), 1u);
  EXPECT_THAT(study.configuration_line("own"), HasSubstr("mine {believed_m = 3000}"));
  EXPECT_THAT(error_message([&] { make("believed = 1.0\nbelieved_m = 1.0", "mine"); }),
              HasSubstr("did you mean \"believed_m\""))
      << "keys that its maker does not ask for are errors";
}

TEST(TrackerRegistry, NameThatIsTakenIsRefused) {
  const auto maker = [](TableReader&) -> std::unique_ptr<Tracker> { return testing::RadarFilter{}.tracker(); };
  register_tracker("taken", maker);
  for (const char* name : {"taken", "kalman", "raw", "corrected", ""})
    EXPECT_THAT(error_message([&] { register_tracker(name, maker); }), AllOf(HasSubstr(name), HasSubstr("taken")));
}

TEST(TrackerRegistry, UnknownKindListsTheValidOnes) {
  EXPECT_THAT(error_message([] { make("", "kalmann"); }),
              AllOf(HasSubstr("trackers.mine"), HasSubstr("did you mean \"kalman\""), HasSubstr("bearings_batch")));
}

const std::string kLine = R"(
motion = { model = "constant_velocity", noise = "discrete", sigma_a_mps2 = 1.5 }
measurement = { model = "position", sigma_m = 150.0 }
start = { kind = "two_point" }
)";

const std::string kPlane = R"(
space = "plane"
motion = { model = "constant_velocity", noise = "discrete", sigma_a_mps2 = 5.0 }
measurement = { model = "position", sigma_m = 100.0 }
start = { kind = "two_point" }
)";
const std::string kPlaneMotion = "motion = { model = \"constant_velocity\", noise = \"discrete\", sigma_a_mps2 = 5.0 }";

// A few steps of a target that flies East at 100 m/s; how far off the last estimate is.
double last_error(Tracker& tracker, bool polar) {
  double error = 1e9;
  for (int k = 1; k <= 20; ++k) {
    const Eigen::Vector2d position(1000.0 + 100.0 * k, 5000.0);
    Measurement measurement;
    measurement.time_s = k;
    measurement.z = position;
    if (polar) measurement.z << position.norm(), std::atan2(position.x(), position.y());
    for (const StepRecord& record : tracker.step(measurement)) {
      EXPECT_EQ(record.x.size(), 4);
      EXPECT_EQ(record.P.rows(), 4);
      error = (record.x - Eigen::Vector4d(position.x(), position.y(), 100.0, 0.0)).norm();
    }
  }
  return error;
}

// Sigma points spread in the turn rate fall short of a straight course, so not to the metre.
TEST(PlaneMakers, EveryMotionAndSensorTracks) {
  constexpr double kNearby = 10.0;
  const std::string longer = "start = { kind = \"two_point\", rest_sigma = 0.01 }";
  const std::vector<std::pair<std::string, std::string>> motions{
      {kPlaneMotion, "start = { kind = \"two_point\" }"},
      {"motion = { model = \"coordinated_turn\", turn_rate_degps = 0.0, noise = \"continuous\", q_m2ps3 = 5.0 }",
       "start = { kind = \"one_point\", velocity_sigma_mps = 300.0 }"},
      {"motion = { model = \"constant_acceleration\", noise = \"continuous\", q_m2ps5 = 1.0 }", longer},
      {"motion = { model = \"constant_acceleration\", noise = \"discrete\", sigma_mps2 = 1.0 }", longer},
      {"motion = { model = \"singer\", sigma_a_mps2 = 3.0, time_constant_s = 20.0 }", longer},
      {"motion = { model = \"turning_target\", turn_rate_noise_degps2 = 0.5, noise = \"discrete\", sigma_a_mps2 = 2.0 }",
       longer}};
  const std::string polar =
      "measurement = { model = \"converted_range_bearing\", range_sigma_m = 50.0, bearing_sigma_deg = 0.3 }";
  for (const auto& [motion, start] : motions)
    for (const char* kind : {"kalman", "unscented"}) {
      const std::string text =
          replaced(replaced(kPlane, kPlaneMotion, motion), "start = { kind = \"two_point\" }", start);
      EXPECT_LT(last_error(*make(text, kind), false), kNearby) << kind << text;
      const std::string by_radar = replaced(text, "measurement = { model = \"position\", sigma_m = 100.0 }", polar);
      EXPECT_LT(last_error(*make(by_radar, kind), true), kNearby) << kind << by_radar;
    }
  const std::string raw =
      replaced(replaced(kPlane, "measurement = { model = \"position\", sigma_m = 100.0 }",
                        "measurement = { model = \"range_bearing\", range_sigma_m = 50.0, "
                        "bearing_sigma_deg = 0.3 }"),
               "start = { kind = \"two_point\" }",
               "start = { kind = \"prior\", x = [1000.0, 5000.0, 90.0, 5.0], variance = [1e4, 1e4, 1e4, 1e4] }");
  for (const char* kind : {"kalman", "unscented"}) EXPECT_LT(last_error(*make(raw, kind), true), 10.0) << kind;
  const std::string two_point =
      replaced(raw, "kind = \"prior\", x = [1000.0, 5000.0, 90.0, 5.0], variance = [1e4, 1e4, 1e4, 1e4]",
               "kind = \"two_point\"");
  for (const char* kind : {"kalman", "unscented"}) EXPECT_LT(last_error(*make(two_point, kind), true), kNearby) << kind;
}

TEST(PlaneMakers, MultipleModelsOfOneAndOfUnequalStates) {
  const std::string head = R"(
space = "plane"
measurement = { model = "position", sigma_m = 100.0 }
transition = { leave_first = 0.05, leave_other = 0.1, to_first = 0.7, period_s = 1.0 }
)";
  const std::string two_point = "start = { kind = \"two_point\" }\n",
                    longer = "start = { kind = \"two_point\", rest_sigma = 0.01 }\n";
  const std::string quiet = "{ model = \"constant_velocity\", noise = \"discrete\", sigma_a_mps2 = 1.0 }";
  const std::string turns =
      "{ model = \"coordinated_turn\", turn_rates_degps = [-3.0, 3.0], noise = \"discrete\", sigma_a_mps2 = 2.0 }";
  const std::string lively = "{ model = \"constant_acceleration\", noise = \"continuous\", q_m2ps5 = 1.0 }";
  const std::string turning =
      "{ model = \"turning_target\", turn_rate_noise_degps2 = 0.5, noise = \"discrete\", sigma_a_mps2 = 2.0 }";
  const auto modes = [](const std::string& a, const std::string& b) { return "modes = [" + a + ", " + b + "]\n"; };
  EXPECT_LT(last_error(*make(head + two_point + modes(quiet, turns), "imm"), false), 5.0);
  const std::string two = replaced(head, "to_first = 0.7, ", "");
  EXPECT_LT(last_error(*make(two + longer + modes(quiet, lively), "imm"), false), 5.0);
  EXPECT_LT(last_error(*make(two + longer + modes(quiet, turning), "imm"), false), 5.0);
  EXPECT_TRUE(make(head + two_point + modes(quiet, turns), "imm")->blocks().mode_probabilities);
  EXPECT_THAT(error_message([&] { make(two + longer + modes(lively, turning), "imm"); }), HasSubstr("one of the two"));
  EXPECT_THAT(error_message([&] { make(head + two_point + "modes = [" + quiet + "]\n", "imm"); }),
              HasSubstr("2 to 10"));
  EXPECT_THAT(
      error_message([&] {
        make(replaced(head, "leave_first = 0.05, leave_other = 0.1, to_first = 0.7", "matrix = [0.9, 0.1, 0.3, 0.6]") +
                 two_point + modes(quiet, quiet),
             "imm");
      }),
      HasSubstr("row 2"));
}

// x + beta (z - x): the published estimate alone, with the covariance that belongs to it.
TEST(PlaneMakers, OutputPullMovesThePublishedPositionOnly) {
  const auto plain = make(kPlane, "kalman"), pulled = make(kPlane + "output_pull = 0.4\n", "kalman");
  RandomStream random({.seed = 11}, StreamId::test);
  for (int k = 1; k <= 30; ++k) {
    Measurement measurement;
    measurement.time_s = k;
    measurement.z = Eigen::Vector2d(100.0 * k + 100.0 * random.normal(), 100.0 * random.normal());
    const auto a = plain->step(measurement), b = pulled->step(measurement);
    if (k < 3) continue;
    const Eigen::Vector2d expected = a[0].x.head<2>() + 0.4 * (measurement.z - a[0].x.head<2>());
    EXPECT_LT((b[0].x.head<2>() - expected).norm(), 1e-9);
    EXPECT_EQ(b[0].x.tail<2>(), a[0].x.tail<2>());
    EXPECT_EQ(b[0].innovation->nu, a[0].innovation->nu) << "the filter goes on without it";
    // Joseph's form for the gain that was really used.
    const Eigen::Matrix<double, 2, 4> H = Eigen::Matrix<double, 2, 4>::Identity();
    Eigen::Matrix<double, 4, 2> K = *a[0].gain;
    K.topRows<2>() += 0.4 * (Eigen::Matrix2d::Identity() - H * K);
    const Eigen::Matrix4d A = Eigen::Matrix4d::Identity() - K * H, predicted = a[0].prediction->P;
    const Eigen::Matrix4d P = A * predicted * A.transpose() + 1e4 * K * K.transpose();
    EXPECT_LT((b[0].P - P).norm(), 1e-9 * P.norm());
  }
}

TEST(KalmanMaker, MakesEveryFormNoiseAndSpace) {
  for (const char* form : {"joseph", "square_root", "conventional"})
    for (const char* noise : {"noise = \"discrete\", sigma_a_mps2 = 1.5", "noise = \"continuous\", q_m2ps3 = 1.5",
                              "noise = \"fixed\", variance = [1.0, 2.0], period_s = 5.0"}) {
      const std::string text =
          replaced(kLine, "noise = \"discrete\", sigma_a_mps2 = 1.5", noise) + "form = \"" + form + "\"\n";
      const auto tracker = make(text, "kalman");
      EXPECT_EQ(&tracker->space(), &line_space());
      tracker->step(testing::position(1.0, 0.0));
      EXPECT_EQ(tracker->step(testing::position(2.0, 10.0))[0].x, Eigen::Vector2d(10.0, 10.0)) << text;
    }
  EXPECT_EQ(&make(kLine + "space = \"plane\"\n", "kalman")->space(), &plane_space());
}

TEST(KalmanMaker, RefusesWhatIsNoVariance) {
  const auto refusal = [](const std::string& from, const std::string& to) {
    return error_message([&] { make(replaced(kLine, from, to), "kalman"); });
  };
  for (const char* bad : {"0.0", "-150.0", "nan", "inf", "\"150\"", "true"}) {
    EXPECT_THAT(refusal("sigma_m = 150.0", std::string("sigma_m = ") + bad),
                HasSubstr("trackers.mine.measurement.sigma_m"))
        << bad;
    EXPECT_THAT(refusal("sigma_m = 150.0", std::string("variance_m2 = ") + bad), HasSubstr("variance_m2")) << bad;
    const std::string prior =
        std::string("start = { kind = \"prior\", x = [0.0, 0.0], variance = [1.0, ") + bad + "] }";
    EXPECT_THAT(refusal("start = { kind = \"two_point\" }", prior), HasSubstr("trackers.mine.start.variance")) << bad;
  }
  EXPECT_THAT(refusal("sigma_a_mps2 = 1.5", "sigma_a_mps2 = -1.5"), HasSubstr("motion.sigma_a_mps2"));
  EXPECT_THAT(refusal("sigma_m = 150.0", "sigma_m = 150.0, variance_m2 = 1.0"), HasSubstr("one of the two"));
  EXPECT_THAT(refusal("sigma_m = 150.0", "sigma_factor = 1.0"), HasSubstr("one of the two"));
}

TEST(KalmanMaker, RefusesGatesAndLimitsOutOfRange) {
  for (const char* bad :
       {"gate_probability = 1.0", "gate_probability = 0.1", "gate_probability = -1", "lost_after_s = 0.0",
        "lost_after_s = -5.0", "form = \"josef\"", "space = \"volume\"", "gate = 9.0"})
    EXPECT_THAT(error_message([&] { make(kLine + bad + "\n", "kalman"); }), HasSubstr("study.toml")) << bad;
}

// Points of an unscented filter have it already, and of a bank there is no one estimate.
TEST(KalmanMaker, SecondOrderOfARangeRateIsOfOneLinearisedEstimate) {
  const std::string radar = R"(
motion = { model = "constant_velocity", noise = "discrete", sigma_a_mps2 = 1.5 }
space = "plane"
measurement = { model = "range_bearing_rate", range_sigma_m = 10.0, bearing_sigma_deg = 0.3, range_rate_sigma_mps = 1.0, second_order = true }
start = { kind = "one_point", velocity_sigma_mps = 100.0 }
)";
  EXPECT_NE(make(radar, "kalman"), nullptr);
  EXPECT_THAT(error_message([&] { make(radar, "unscented"); }), HasSubstr("second_order"));
  EXPECT_NE(make(replaced(radar, "second_order = true", "second_order = false"), "unscented"), nullptr);
}

TEST(KalmanBankMaker, RefusesEmptyAndAbsurdSizes) {
  const std::string bank = R"(
motion = { model = "constant_velocity", noise = "discrete", sigma_a_mps2 = 1.5 }
measurement = { model = "position", sigma_m = 150.0 }
start = { x = [0.0, 0.0], variance = [1e6, 484.0] }
prior_velocities_mps = [-10, 10]
measurement_variance_factors = [0.5, 2.0]
process_noise_factors = [1.0]
)";
  EXPECT_NE(make(bank, "kalman_bank"), nullptr);
  EXPECT_THAT(error_message([&] { make(replaced(bank, "[-10, 10]", "[]"), "kalman_bank"); }), HasSubstr("1 to 100000"));
  EXPECT_THAT(error_message([&] { make(replaced(bank, "[0.5, 2.0]", "[0.5, -2.0]"), "kalman_bank"); }),
              HasSubstr("measurement_variance_factors"));
}

TEST(RawMaker, RefusesWhatDoesNotFit) {
  EXPECT_NE(make("components = [\"position_m\"]\nsigma = [150.0]\n", "raw"), nullptr);
  EXPECT_THAT(error_message([] { make("components = [\"position_m\"]\nsigma = [150.0, 1.0]\n", "raw"); }),
              HasSubstr("sigma"));
  EXPECT_THAT(error_message([] { make("components = []\nsigma = []\n", "raw"); }), HasSubstr("components"));
}

TEST(RecordedMaker, ReadsItsFileBesideTheStudy) {
  const TemporaryFolder folder;
  folder.write("logs/steps.csv", "time_s,track,x_position_m,x_velocity_mps,P_1_1,P_1_2,P_2_2\n1,0,10,2,4,1,9\n");
  const SharedTable table = parse_toml("file = \"logs/steps.csv\"", (folder.path() / "s.toml").string());
  TableReader reader(table, (folder.path() / "s.toml").string(), "trackers.other");
  EXPECT_EQ(make_tracker("recorded", reader)->step(testing::position(1.0, 0.0))[0].x[0], 10.0);
  EXPECT_THAT(error_message([] { make("file = \"nowhere.csv\"", "recorded"); }), HasSubstr("nowhere.csv"));
}

}  // namespace
}  // namespace truebearing::tracker_registry_test
