// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/batch_trackers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/error_message.hpp"
#include "truebearing/study/tracker_registry.hpp"

namespace truebearing::batch_trackers_test {
namespace {

using ::testing::AllOf;
using testing::error_message;
using ::testing::HasSubstr;

const std::string kBearings = "measurement = { model = \"bearing\", bearing_sigma_deg = 1.0 }\n";
const std::string kFrequencies =
    "measurement = { model = \"bearing_frequency\", bearing_sigma_deg = 1.0, frequency_sigma_hz = 0.02 }\n";

std::unique_ptr<Tracker> make(const std::string& text) {
  const SharedTable table = parse_toml(text, "study.toml");
  TableReader reader(table, "study.toml", "trackers.mine");
  auto tracker = make_tracker("bearings_batch", reader);
  reader.finish();
  return tracker;
}

TEST(BatchTrackers, FrequenciesAddTheirSourceToTheState) {
  EXPECT_EQ(&make("method = \"ml\"\n" + kBearings)->space(), &plane_space());
  EXPECT_EQ(&make("method = \"ml\"\n" + kFrequencies)->space(), &plane_frequency_space());
  for (const char* handling : {"levels", "segments", "switch", "ignored"})
    EXPECT_NO_THROW(make("method = \"ml\"\nfrequency_changes = \"" + std::string(handling) + "\"\n" + kFrequencies));
  EXPECT_NO_THROW(
      make("method = \"map\"\nfalse_alarm_probability = 1e-4\nscan_threshold = 20\n"
           "prior = { kind = \"velocity\", velocity_sigma_mps = 4 }\n" +
           kFrequencies));
}

TEST(BatchTrackers, FrequenciesThatCannotBeUsedAreAnError) {
  EXPECT_THAT(error_message([] { make("method = \"gauss_newton\"\n" + kFrequencies); }),
              AllOf(HasSubstr("gauss_newton"), HasSubstr("bearings only")));
  EXPECT_THAT(error_message([] { make("method = \"ml\"\nfrequency_changes = \"level\"\n" + kFrequencies); }),
              HasSubstr("levels"));
  EXPECT_THAT(error_message([] { make("method = \"ml\"\nfrequency_changes = \"levels\"\n" + kBearings); }),
              HasSubstr("frequency_changes"));
  EXPECT_THAT(error_message([] { make("method = \"ml\"\nfalse_alarm_probability = 0.0\n" + kFrequencies); }),
              HasSubstr("false_alarm_probability"));
}

}  // namespace
}  // namespace truebearing::batch_trackers_test
