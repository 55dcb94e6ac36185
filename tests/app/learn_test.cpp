// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/app/program_tests.hpp"

namespace truebearing::app_test::learn_test {
namespace {

void write_unlearned(const TemporaryFolder& folder) {
  write_study(folder);
  for (const char* product : {"small.parameters.toml", "small.nfnn.json"})
    std::filesystem::remove(folder.path() / product);
}

TEST(Learn, DoesInOneGoWhatTuneTrainAndCompareDo) {
  const TemporaryFolder folder;
  write_unlearned(folder);
  const Outcome outcome = run(folder, "learn small.toml --quiet --json learned.json --report page.html");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  for (const char* says : {"written: small.parameters.toml", "written: small.nfnn.json", "nfnn - tuned", "nfnn is "})
    EXPECT_THAT(outcome.out, HasSubstr(says));
  EXPECT_THAT(folder.read("page.html"), HasSubstr("Does nfnn err less than tuned?"));
  const std::string parameters = folder.read("small.parameters.toml"), model = folder.read("small.nfnn.json");

  write_unlearned(folder);
  EXPECT_EQ(run(folder, "tune small.toml --quiet").status, 0);
  EXPECT_EQ(run(folder, "train small.toml --quiet").status, 0);
  EXPECT_EQ(folder.read("small.parameters.toml"), parameters);
  EXPECT_EQ(folder.read("small.nfnn.json"), model);
}

TEST(Learn, WritesIntoAFolderAndLeavesTheStudysOwnFilesAlone) {
  const TemporaryFolder folder;
  write_unlearned(folder);
  const Outcome outcome = run(folder, "learn small.toml --quiet --runs 2 -o products");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "products/small.parameters.toml"));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "products/small.nfnn.json"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "small.parameters.toml"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "small.nfnn.json"));
}

TEST(Learn, RefusesWhatHasNothingToLearnAndStreams) {
  const TemporaryFolder folder;
  write_unlearned(folder);
  folder.write("plain.toml", kStudy.substr(0, kStudy.find("[trackers.tuned]")).replace(kStudy.find("pairs"), 24, ""));
  for (const auto& [arguments, says] : {std::pair{"learn plain.toml", "has nothing to learn"},
                                        {"learn small.toml --json -", "a file for --json"},
                                        {"learn small.toml --report small.toml", "is read by this command"},
                                        {"learn small.toml -o small.toml", "small.toml: cannot be made"}}) {
    const Outcome outcome = run(folder, arguments);
    EXPECT_EQ(outcome.status, 1) << arguments;
    EXPECT_THAT(outcome.err, HasSubstr(says)) << arguments;
    EXPECT_TRUE(is_one_line(outcome.err)) << outcome.err;
  }
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "small.parameters.toml"));
}

}  // namespace
}  // namespace truebearing::app_test::learn_test
