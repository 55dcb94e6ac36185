// SPDX-License-Identifier: Apache-2.0
// What becomes of files when the program is killed, the disk is full or two of it write at once: the old file or the new one.
#include <gtest/gtest.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/app/program_tests.hpp"
#include "truebearing/correction/model_file.hpp"

namespace truebearing::app_test::crash_test {
namespace {

TEST(ProgramCrash, KilledWhileTrainingLeavesTheOldModel) {
  const TemporaryFolder folder, outputs;
  // Long enough that it is always killed in the middle of it.
  write_study(folder, replaced(replaced(kStudy, "iterations = 10", "iterations = 100000"), "runs = 20\niterations",
                               "runs = 200\niterations"));
  folder.write("small.nfnn.json", "the old model");
  const int files = folder.files();
  for (const int milliseconds : {0, 30, 150, 400}) {
    const pid_t child = start(folder, "train small.toml", outputs.path());
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
    ::kill(child, SIGKILL);
    EXPECT_EQ(wait_for(child), 128 + SIGKILL);
    EXPECT_EQ(folder.read("small.nfnn.json"), "the old model") << milliseconds;
    EXPECT_EQ(folder.files(), files) << milliseconds;
  }
}

TEST(ProgramCrash, KilledAtAnyTimeTheModelIsTheOldOrTheWholeNewOne) {
  const TemporaryFolder folder, outputs;
  write_study(folder);
  EXPECT_EQ(run(folder, "train small.toml --quiet -o expected.json").status, 0);
  const std::string expected = folder.read("expected.json");
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(run(folder, "train small.toml --quiet -o expected.json").status, 0);
  const auto whole = std::chrono::steady_clock::now() - begin;
  folder.write("small.nfnn.json", "the old model");
  for (int k = 0; k < 8; ++k) {
    const pid_t child = start(folder, "train small.toml --quiet", outputs.path());
    std::this_thread::sleep_for(whole * (70 + 5 * k) / 100);  // about the time when it writes
    ::kill(child, SIGKILL);
    wait_for(child);
    const std::string model = folder.read("small.nfnn.json");
    EXPECT_TRUE(model == "the old model" || model == expected);
  }
  EXPECT_EQ(run(folder, "train small.toml --quiet").status, 0) << "and it starts again";
  EXPECT_EQ(folder.read("small.nfnn.json"), expected) << "to the same bits";
}

TEST(ProgramCrash, FullDiskLeavesTheOldFile) {
  const TemporaryFolder folder;
  write_study(folder);
  folder.write("small.nfnn.json", "the old model");
  folder.write("small.parameters.toml", testing::kParameters);
  const int files = folder.files();
  // A limit on the size of files stands for a full disk: the write fails where it is reached.
  const Outcome trained = run(folder, "train small.toml --quiet", "trap '' XFSZ; ulimit -f 1;");
  EXPECT_EQ(trained.status, 1);
  EXPECT_THAT(trained.err, HasSubstr("small.nfnn.json"));
  EXPECT_TRUE(is_one_line(trained.err)) << trained.err;
  EXPECT_EQ(folder.read("small.nfnn.json"), "the old model");
  EXPECT_EQ(folder.files(), files) << "no half-written file is left";
}

TEST(ProgramCrash, OfTwoWritersOneWinsWhole) {
  const TemporaryFolder folder, one, two;
  write_study(folder);
  EXPECT_EQ(run(folder, "train small.toml --quiet --seed 1 -o one.json").status, 0);
  EXPECT_EQ(run(folder, "train small.toml --quiet --seed 2 -o two.json").status, 0);
  const std::string first = folder.read("one.json"), second = folder.read("two.json");
  ASSERT_NE(first, second);
  for (int k = 0; k < 4; ++k) {
    const pid_t a = start(folder, "train small.toml --quiet --seed 1", one.path());
    const pid_t b = start(folder, "train small.toml --quiet --seed 2", two.path());
    EXPECT_EQ(wait_for(a), 0);
    EXPECT_EQ(wait_for(b), 0);
    const std::string model = folder.read("small.nfnn.json");
    EXPECT_TRUE(model == first || model == second);
  }
}

}  // namespace
}  // namespace truebearing::app_test::crash_test
