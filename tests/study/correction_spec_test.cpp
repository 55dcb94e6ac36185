// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/correction_spec.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/error_message.hpp"
#include "tests/support/radar_study.hpp"
#include "truebearing/study/study.hpp"

namespace truebearing::correction_spec_test {
namespace {

using testing::error_message;
using ::testing::HasSubstr;

TEST(CorrectionSpec, StepsLeftOutOfTrainingAreOfAQuantityOfTheTruth) {
  const testing::TemporaryFolder folder;
  const auto loaded = [&](const std::string& limit) {
    const std::string from = "[trackers.nfnn.training]\n";
    return Study::load(testing::write_study(
        folder, testing::replaced(testing::kStudy, from, from + "leave_out_beyond = { " + limit + " }\n")));
  };
  const Study study = loaded("position_m = 9000.0, velocity_mps = 300");
  const auto& limits = study.tracker("nfnn").correction->training.leave_out_beyond;
  const std::vector<std::pair<std::string, double>> wanted{{"position_m", 9000.0}, {"velocity_mps", 300.0}};
  EXPECT_EQ(limits, wanted);
  EXPECT_THAT(error_message([&] { loaded("angle_deg = 3.0"); }),
              HasSubstr("trackers.nfnn.training.leave_out_beyond.angle_deg"));
  EXPECT_THAT(error_message([&] { loaded("position_m = -3.0"); }), HasSubstr("leave_out_beyond.position_m"));
}

TEST(CorrectionSpec, RefereeOfABaseThatMeasuresNoPositionIsRefused) {
  const testing::TemporaryFolder folder;
  const std::string with_referee = testing::replaced(testing::kStudy, "kappa = 3.0\n", "kappa = 3.0\nreferee = true\n");
  const auto path = testing::write_study(folder, with_referee);
  EXPECT_NO_THROW(Study::load(path));
  folder.write("scenario.toml", testing::kScenario + "velocity_sigma_mps = 10.0\n");
  folder.write("small.toml", testing::replaced(with_referee, "\"position\", variance_m2 = 1e7",
                                               "\"position_velocity\", sigma_m = 3162.0, velocity_sigma_mps = 10.0"));
  const std::string error = error_message([&] { Study::load(path); });
  EXPECT_THAT(error, ::testing::ContainsRegex("small.toml:[0-9]+: trackers.nfnn.referee"));
  EXPECT_THAT(error, HasSubstr("\"plain\""));
}

}  // namespace
}  // namespace truebearing::correction_spec_test
