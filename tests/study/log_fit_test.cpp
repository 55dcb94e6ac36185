// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/log_fit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/support/temporary_folder.hpp"

namespace truebearing::log_fit_test {
namespace {

using ::testing::HasSubstr;
using testing::TemporaryFolder;

const std::string kLine = R"(name = "line"
[scenario]
kind = "line"
period_s = 2.0
steps = 50
target = { position_m = 0.0, velocity_mps = 100.0 }
sensor = { position_sigma_m = 50.0 }
[trackers.plain]
kind = "kalman"
motion = { model = "constant_velocity", noise = "discrete", sigma_a_mps2 = 1.0 }
measurement = { model = "position", sigma_m = 50.0 }
)";

Study study_of(const TemporaryFolder& folder, const std::string& text) {
  return Study::load(folder.write("study.toml", text));
}

TEST(LogFit, PriorIsAsFarBeforeALaterLogAsBeforeTheScenario) {
  const TemporaryFolder folder;
  const Study study = study_of(folder, kLine + "start = { kind = \"prior\", x = [0.0, 0.0], variance = [1e4, 1e4] }\n");
  EXPECT_EQ(study_epoch_s(study, 2.0), 0.0);
  EXPECT_EQ(study_epoch_s(study, 100.0), 0.0) << "within the scenario";
  EXPECT_EQ(study_epoch_s(study, 1.7e9 + 2.0), 1.7e9);
}

TEST(LogFit, StudyWithoutTimesTakesEveryLogAsItIs) {
  const TemporaryFolder folder;
  EXPECT_EQ(study_epoch_s(study_of(folder, kLine + "start = { kind = \"two_point\" }\n"), 1.7e9), 0.0);
}

TEST(LogFit, TimesOfTheScoringCountWhereTrackersHaveNone) {
  const TemporaryFolder folder;
  const Study study = study_of(folder, kLine + "start = { kind = \"two_point\" }\n[scoring]\ntimes_s = [50.0, 80.0]\n");
  EXPECT_EQ(study_epoch_s(study, 80.0), 0.0);
  EXPECT_EQ(study_epoch_s(study, 82.0), 80.0);
}

TEST(LogFit, SaysWhatIsMissing) {
  const TemporaryFolder folder;
  const Study study = study_of(folder, kLine + "start = { kind = \"two_point\" }\n");
  EXPECT_THAT(why_no_track(study, "plain", {.measurements = 3, .missing = 3}), HasSubstr("no usable"));
  EXPECT_THAT(why_no_track(study, "plain", {.measurements = 3, .missing = 2}), HasSubstr("two measurements"));
}

TEST(LogFit, InputsOfAStudyAreItsOwnFilesThatAreThere) {
  const TemporaryFolder folder;
  folder.write("child.toml", "like = \"study.toml\"\nparameters = \"tuned.toml\"\n");
  folder.write("study.toml", kLine + "start = { kind = \"two_point\" }\n");
  const std::vector<std::filesystem::path> files = Study::load(folder.path() / "child.toml").input_files();
  EXPECT_THAT(files, ::testing::Contains(folder.path() / "child.toml"));
  EXPECT_THAT(files, ::testing::Contains(folder.path() / "study.toml"));
  EXPECT_THAT(files, ::testing::Not(::testing::Contains(folder.path() / "tuned.toml")));
}

}  // namespace
}  // namespace truebearing::log_fit_test
