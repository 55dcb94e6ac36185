// SPDX-License-Identifier: Apache-2.0
// `truebearing keys`: docs/keys.md is what it writes; every key that is read has a meaning, and every meaning a key.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "tests/app/program_tests.hpp"

namespace truebearing::app_test::keys_test {
namespace {

std::string document() {
  std::ostringstream text;
  text << std::ifstream(std::filesystem::path(TRUEBEARING_SOURCE_DIR) / "docs/keys.md").rdbuf();
  return text.str();
}

// The command refuses where a key that is read lacks a meaning, where a meaning is of no key that is read, and where no
// study visits a kind or model.
TEST(Keys, DocumentIsWhatTheCommandWrites) {
  const TemporaryFolder folder;
  const Outcome written = run(folder, "keys --markdown");
  ASSERT_EQ(written.status, 0) << written.err;
  EXPECT_EQ(written.out, document()) << "run `truebearing keys --markdown > docs/keys.md`";
}

TEST(Keys, OneTableIsPrintedInAHundredColumns) {
  const TemporaryFolder folder;
  const Outcome printed = run(folder, "keys motion");
  ASSERT_EQ(printed.status, 0) << printed.err;
  EXPECT_THAT(printed.out, AllOf(HasSubstr("[tracker.motion]"), HasSubstr("turn_rate_degps (deg/s): turn rate"),
                                 HasSubstr("a number in [-90, 90]; default: required"), Not(HasSubstr("[scoring]"))));
  std::istringstream lines(printed.out);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 100U) << line;
}

TEST(Keys, KindOfTrackerPrintsWhatItTakes) {
  const TemporaryFolder folder;
  const Outcome printed = run(folder, "keys imm");
  ASSERT_EQ(printed.status, 0) << printed.err;
  EXPECT_THAT(printed.out,
              AllOf(HasSubstr("[tracker]"), HasSubstr("\n  modes: "), HasSubstr("\n  transition: "),
                    HasSubstr("; of imm\n"), Not(HasSubstr("\n  particles: ")), Not(HasSubstr("\n  base: "))));
  // And what stands in the tables that only it has.
  EXPECT_THAT(printed.out, AllOf(HasSubstr("[tracker.modes]"), HasSubstr("\n  turn_rates_degps"),
                                 HasSubstr("[tracker.modes.vertical]"), HasSubstr("[tracker.transition]"),
                                 Not(HasSubstr("[tracker.start]"))));
}

TEST(Keys, MistypedTableIsGivenTheNearest) {
  const TemporaryFolder folder;
  const Outcome refused = run(folder, "keys motoin");
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("motoin"), HasSubstr("did you mean \"motion\"?")));
  EXPECT_TRUE(is_one_line(refused.err)) << refused.err;
}

}  // namespace
}  // namespace truebearing::app_test::keys_test
