// SPDX-License-Identifier: Apache-2.0
// kill -9 at random moments of whatever writes: every file is the old one or the whole new one, and after the next run
// nothing else lies beside them; a network that is taught in many epochs is the same as if it had not been killed.
// TRUEBEARING_KILLS says how often each command is killed.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "tests/app/program_tests.hpp"
#include "tests/support/environment.hpp"
#include "truebearing/core/random.hpp"

namespace truebearing::app_test::kill_test {
namespace {

int kills() {
  return testing::number_from_environment("TRUEBEARING_KILLS", 3);
}

struct Command {
  std::string name, arguments;
  std::vector<std::string> outputs;
  std::string old = "what was there before";  ///< of every output
};

std::vector<std::string> logs(int runs) {
  std::vector<std::string> names;
  for (int k = 0; k < runs; ++k) names.push_back(fmt::format("logs/run_{:04}.csv", k));
  return names;
}

const std::vector<Command> kCommands{
    {"train", "train small.toml --quiet", {"small.nfnn.json"}},
    {"train_recurrent", "train recurrent.toml --tracker gru --quiet", {"small.gru.json"}},
    {"tune", "tune small.toml --quiet", {"small.parameters.toml"}, testing::kParameters},
    {"compare", "compare small.toml --runs 2000 --quiet --json result.json", {"result.json"}},
    {"track",
     "track small.toml log.csv -o steps.csv --json scores.json --events events.csv",
     {"steps.csv", "scores.json", "events.csv"}},
    {"smooth", "smooth small.toml log.csv -o smoothed.csv --json smoothed.json", {"smoothed.csv", "smoothed.json"}},
    {"simulate", "simulate scenario.toml -o logs --runs 40 --seed 7 --quiet", logs(40)},
};

// All but how long the trackers took.
std::string without_times(const std::string& text) {
  auto json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains("trackers")) return text;
  const std::function<void(nlohmann::json&)> strip = [&](nlohmann::json& node) {
    if (node.is_object()) node.erase("ns_per_step");
    if (node.is_structured())
      for (nlohmann::json& child : node) strip(child);
  };
  strip(json);
  return json.dump();
}

std::vector<std::string> contents(const TemporaryFolder& folder, const Command& command) {
  std::vector<std::string> texts;
  for (const std::string& output : command.outputs) texts.push_back(without_times(folder.read(output)));
  return texts;
}

std::set<std::string> names(const TemporaryFolder& folder) {
  std::set<std::string> all;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path()))
    all.insert(entry.path().lexically_relative(folder.path()).string());
  return all;
}

class ProgramKilled : public ::testing::TestWithParam<Command> {};

TEST_P(ProgramKilled, LeavesTheOldFilesOrTheNewOnes) {
  const Command& command = GetParam();
  if (command.name == "train_recurrent" &&
      !std::filesystem::exists(std::filesystem::path(TRUEBEARING_PROGRAM).parent_path() / "truebearing_torch.so"))
    GTEST_SKIP() << "no LibTorch";
  const TemporaryFolder folder, outputs;
  write_study(folder);
  folder.write("recurrent.toml", testing::kRecurrentStudy);
  ASSERT_EQ(run(folder, "train small.toml --quiet").status, 0);
  ASSERT_EQ(run(folder, "simulate scenario.toml -o . --quiet").status, 0);
  std::filesystem::rename(folder.path() / "run_0000.csv", folder.path() / "log.csv");
  const auto put_back = [&] {
    for (const std::string& output : command.outputs) folder.write(output, command.old);
  };
  put_back();
  const auto begin = std::chrono::steady_clock::now();
  ASSERT_EQ(run(folder, command.arguments).status, 0);
  const std::chrono::duration<double> whole = std::chrono::steady_clock::now() - begin;
  const std::vector<std::string> expected = contents(folder, command);
  const std::set<std::string> files = names(folder);

  RandomStream random({.seed = 9}, StreamId::test);
  int in_the_middle = 0, left = 0;
  for (int k = 0; k < kills(); ++k) {
    put_back();
    const pid_t child = start(folder, command.arguments, outputs.path());
    std::this_thread::sleep_for(whole * random.uniform());
    ::kill(child, SIGKILL);
    in_the_middle += wait_for(child) == 128 + SIGKILL;
    const std::vector<std::string> found = contents(folder, command);
    for (std::size_t i = 0; i < found.size(); ++i)
      EXPECT_TRUE(found[i] == command.old || found[i] == expected[i]) << command.outputs[i] << ", kill " << k;
    left += names(folder) != files;
    ASSERT_EQ(run(folder, command.arguments).status, 0) << "and it starts again";
    EXPECT_EQ(contents(folder, command), expected);
    EXPECT_EQ(names(folder), files) << "nothing is left";
  }
  EXPECT_GT(in_the_middle, 0) << "of " << kills() << " in " << whole.count() << " s";
  RecordProperty("in_the_middle", in_the_middle);
  RecordProperty("left_a_temporary_file", left);
}

INSTANTIATE_TEST_SUITE_P(Commands, ProgramKilled, ::testing::ValuesIn(kCommands),
                         [](const auto& command) { return command.param.name; });

}  // namespace
}  // namespace truebearing::app_test::kill_test
