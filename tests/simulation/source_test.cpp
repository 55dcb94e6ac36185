// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/source.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/error_message.hpp"

namespace truebearing::source_test {
namespace {

using testing::error_message;
using ::testing::HasSubstr;

SourceParameters read(const std::string& text) {
  const SharedTable table = parse_toml(text, "source.toml");
  TableReader reader(table, "source.toml");
  SourceParameters source = read_source(reader);
  reader.finish();
  return source;
}

SourceTone tone(const std::string& text, std::uint64_t run = 0) {
  RandomStream stream({1, Role::evaluation, run}, StreamId::scenario);
  return read(text).draw(stream);
}

TEST(SourceTone, JumpsToAFrequencyOrByADifference) {
  const SourceTone made = tone(
      "frequency_hz = 100\nchanges = [{ time_s = 600, to_hz = 130 }, { time_s = 800, by_hz = -0.5 }, { time_s = 900, "
      "to_hz = 100 }]\n");
  EXPECT_EQ(made.at(0.0), 100.0);
  EXPECT_EQ(made.at(599.9), 100.0);
  EXPECT_EQ(made.at(600.0), 130.0);
  EXPECT_EQ(made.at(600.0 - 1e-12), 130.0) << "rounding of a sample's time";
  EXPECT_EQ(made.at(800.0), 129.5);
  EXPECT_EQ(made.at(1e6), 100.0);
}

TEST(SourceTone, AChangeThatComesTooEarlyFollowsTheOneBefore) {
  const SourceTone made =
      tone("frequency_hz = 100\nchanges = [{ time_s = 600, to_hz = 130 }, { time_s = 500, to_hz = 90 }]\n");
  EXPECT_EQ(made.at(550.0), 100.0);
  EXPECT_EQ(made.at(600.0), 90.0);
}

TEST(Source, EachRunDrawsFrequencyTimeAndWhetherItChangesAtAll) {
  const std::string text =
      "frequency_hz = { uniform = [80, 160] }\n"
      "changes = [{ time_s = { uniform = [100, 200] }, by_hz = { choice = [-1, 1] }, share = 0.25 }]\n";
  int changed = 0, up = 0, early = 0;
  for (std::uint64_t run = 0; run < 400; ++run) {
    const SourceTone made = tone(text, run);
    EXPECT_GE(made.at(0.0), 80.0);
    EXPECT_LT(made.at(0.0), 160.0);
    EXPECT_EQ(made.at(99.0), made.at(0.0));
    const double by_hz = made.at(200.0) - made.at(0.0);
    changed += by_hz != 0.0;
    up += by_hz > 0.5;
    early += made.at(150.0) != made.at(0.0);
  }
  // Binomial, 100 +- 8.7 and about 50 +- 6.6: five standard deviations.
  EXPECT_NEAR(changed, 100, 44);
  EXPECT_NEAR(up, 50, 34);
  EXPECT_NEAR(early, 50, 34);
}

TEST(Source, MisreadOnesAreErrors) {
  EXPECT_THAT(error_message([] { read("frequency_hz = 0\n"); }), HasSubstr("frequency_hz"));
  EXPECT_THAT(error_message([] { read("frequency_hz = 100\nchanges = [{ time_s = 5 }]\n"); }),
              HasSubstr("neither to_hz nor by_hz"));
  EXPECT_THAT(error_message([] { read("frequency_hz = 100\nchanges = [{ time_s = 5, to_hz = 1, by_hz = 1 }]\n"); }),
              HasSubstr("both to_hz and by_hz"));
  EXPECT_THAT(error_message([] { tone("frequency_hz = 100\nchanges = [{ time_s = 5, by_hz = -100 }]\n"); }),
              HasSubstr("0 Hz"));
}

}  // namespace
}  // namespace truebearing::source_test
