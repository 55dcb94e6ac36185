// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "tests/app/program_tests.hpp"

namespace truebearing::app_test::data_folder_test {
namespace {

const std::filesystem::path kSource = TRUEBEARING_SOURCE_DIR;

// The words that the shell would offer for the last of `words`, which begin behind the program's name.
std::string completed(const TemporaryFolder& folder, const std::string& words, int last) {
  const std::string script = "source '" + (kSource / "packaging/truebearing.bash").string() + "'; COMP_WORDS=('" +
                             TRUEBEARING_PROGRAM + "' " + words + "); COMP_CWORD=" + std::to_string(last) +
                             "; _truebearing; echo \"${COMPREPLY[@]}\" > '" + (folder.path() / "out").string() + "'";
  folder.write("script", script);
  EXPECT_EQ(std::system(("bash '" + (folder.path() / "script").string() + "'").c_str()), 0);
  return folder.read("out");
}

// Of the commands that --help lists.
std::vector<std::string> commands(const TemporaryFolder& folder) {
  std::istringstream help(run(folder, "--help").out);
  std::vector<std::string> names;
  std::string line;
  while (std::getline(help, line) && line != "Subcommands:") {
  }
  while (std::getline(help, line))
    if (std::istringstream words(line); words >> line) names.push_back(line);
  return names;
}

TEST(DataFolder, HasWhatComesWithTheProgram) {
  const TemporaryFolder folder;
  const Outcome outcome = run(folder, "--data-dir");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const std::filesystem::path data = outcome.out.substr(0, outcome.out.find('\n'));
  EXPECT_TRUE(std::filesystem::exists(data / "data/studies/radar_1d_family.toml")) << data;
  EXPECT_TRUE(std::filesystem::exists(data / "models/radar_1d_family.nfnn.json")) << data;
}

TEST(DataFolder, StudiesAndScenariosAreFoundByNameFromAnywhere) {
  const TemporaryFolder folder;
  for (const char* command : {"check radar_1d_family", "check radar_1d_family.toml", "simulate radar_2d -o logs",
                              "track radar_2d logs/run_0000.csv", "compare radar_1d_family --runs 2 --quiet"}) {
    const Outcome outcome = run(folder, command);
    EXPECT_EQ(outcome.status, 0) << command << "\n" << outcome.err;
  }
  const Outcome nowhere = run(folder, "check radar_1d_famly");
  EXPECT_EQ(nowhere.status, 1);
  EXPECT_THAT(nowhere.err, HasSubstr("radar_1d_famly: cannot be opened"));
}

TEST(DataFolder, FileInTheCurrentFolderComesFirst) {
  const TemporaryFolder folder;
  write_study(folder);
  std::filesystem::copy(folder.path() / "small.toml", folder.path() / "radar_1d_family.toml");
  EXPECT_THAT(run(folder, "check radar_1d_family.toml").out, HasSubstr("small: 20 runs"));
}

TEST(DataFolder, HelpThatCannotBeWrittenIsAnError) {
  const TemporaryFolder folder;
  for (const char* option : {"--help > /dev/full", "--version > /dev/full", "--data-dir > /dev/full"})
    EXPECT_EQ(run(folder, option).status, 1) << option;
}

TEST(ManPage, TellsEveryCommand) {
  const TemporaryFolder folder;
  std::ostringstream page;
  page << std::ifstream(kSource / "packaging/truebearing.1").rdbuf();
  const std::vector<std::string> names = commands(folder);
  EXPECT_GE(names.size(), 8u);
  for (const std::string& name : names) EXPECT_THAT(page.str(), HasSubstr(".BI " + name + " \""));
}

TEST(Completion, OffersCommandsStudiesAndOptions) {
  const TemporaryFolder folder;
  for (const std::string& name : commands(folder)) EXPECT_EQ(completed(folder, name, 1), name + "\n");
  EXPECT_EQ(completed(folder, "--ver", 1), "--version\n");
  EXPECT_EQ(completed(folder, "compare radar_1d_s", 2), "radar_1d_shift\n");
  EXPECT_EQ(completed(folder, "simulate cho_s2", 2), "cho_s2\n");
  EXPECT_EQ(completed(folder, "new so", 2), "sonar\n");
  EXPECT_EQ(completed(folder, "compare radar_1d_shift --se", 3), "--seed\n");
}

}  // namespace
}  // namespace truebearing::app_test::data_folder_test
