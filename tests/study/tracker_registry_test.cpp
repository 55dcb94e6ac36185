#include "truebearing/study/tracker_registry.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/error_message.hpp"
#include "tests/support/line_trackers.hpp"
#include "tests/support/radar_study.hpp"
#include "truebearing/study/study.hpp"

namespace truebearing {
namespace {

using testing::error_message;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using testing::kStudy;
using testing::replaced;
using testing::TemporaryFolder;
using testing::write_study;

std::unique_ptr<Tracker> make(const std::string& text, const std::string& kind) {
  const toml::table table = parse_toml(text, "study.toml");
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
  EXPECT_THAT(error_message([&] { make("believed = 1.0\nbelieved_m = 1.0", "mine"); }), HasSubstr("did you mean \"believed_m\""))
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
              AllOf(HasSubstr("trackers.mine"), HasSubstr("did you mean \"kalman\""), HasSubstr("raw"), HasSubstr("recorded"),
                    HasSubstr("corrected")));
}

const std::string kLine = R"(
motion = { model = "constant_velocity", noise = "discrete", sigma_a_mps2 = 1.5 }
measurement = { model = "position", sigma_m = 150.0 }
start = { kind = "two_point" }
)";

TEST(KalmanMaker, MakesEveryFormNoiseAndSpace) {
  for (const char* form : {"joseph", "square_root", "conventional"})
    for (const char* noise : {"noise = \"discrete\", sigma_a_mps2 = 1.5", "noise = \"continuous\", q_m2ps3 = 1.5",
                              "noise = \"fixed\", variance = [1.0, 2.0], period_s = 5.0"}) {
      const std::string text = replaced(kLine, "noise = \"discrete\", sigma_a_mps2 = 1.5", noise) + "form = \"" + form + "\"\n";
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
    EXPECT_THAT(refusal("sigma_m = 150.0", std::string("sigma_m = ") + bad), HasSubstr("trackers.mine.measurement.sigma_m")) << bad;
    EXPECT_THAT(refusal("sigma_m = 150.0", std::string("variance_m2 = ") + bad), HasSubstr("variance_m2")) << bad;
    const std::string prior = std::string("start = { kind = \"prior\", x = [0.0, 0.0], variance = [1.0, ") + bad + "] }";
    EXPECT_THAT(refusal("start = { kind = \"two_point\" }", prior), HasSubstr("trackers.mine.start.variance")) << bad;
  }
  EXPECT_THAT(refusal("sigma_a_mps2 = 1.5", "sigma_a_mps2 = -1.5"), HasSubstr("motion.sigma_a_mps2"));
  EXPECT_THAT(refusal("sigma_m = 150.0", "sigma_m = 150.0, variance_m2 = 1.0"), HasSubstr("one of the two"));
  EXPECT_THAT(refusal("sigma_m = 150.0", "sigma_factor = 1.0"), HasSubstr("one of the two"));
}

TEST(KalmanMaker, RefusesGatesAndLimitsOutOfRange) {
  for (const char* bad : {"gate_probability = 1.0", "gate_probability = 0.1", "gate_probability = -1", "lost_after_s = 0.0",
                          "lost_after_s = -5.0", "form = \"josef\"", "space = \"volume\"", "gate = 9.0"})
    EXPECT_THAT(error_message([&] { make(kLine + bad + "\n", "kalman"); }), HasSubstr("study.toml")) << bad;
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
  EXPECT_THAT(error_message([] { make("components = [\"position_m\"]\nsigma = [150.0, 1.0]\n", "raw"); }), HasSubstr("sigma"));
  EXPECT_THAT(error_message([] { make("components = []\nsigma = []\n", "raw"); }), HasSubstr("components"));
}

TEST(RecordedMaker, ReadsItsFileBesideTheStudy) {
  const TemporaryFolder folder;
  folder.write("logs/steps.csv", "time_s,track,x_position_m,x_velocity_mps,P_1_1,P_1_2,P_2_2\n1,0,10,2,4,1,9\n");
  const toml::table table = parse_toml("file = \"logs/steps.csv\"", (folder.path() / "s.toml").string());
  TableReader reader(table, (folder.path() / "s.toml").string(), "trackers.other");
  EXPECT_EQ(make_tracker("recorded", reader)->step(testing::position(1.0, 0.0))[0].x[0], 10.0);
  EXPECT_THAT(error_message([] { make("file = \"nowhere.csv\"", "recorded"); }), HasSubstr("nowhere.csv"));
}

}  // namespace
}  // namespace truebearing
