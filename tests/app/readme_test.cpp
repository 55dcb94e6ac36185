// SPDX-License-Identifier: Apache-2.0
// Every command that the README prints runs, with few runs; and so does its study.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "tests/app/program.hpp"

namespace truebearing::readme_test {
namespace {

using ::testing::HasSubstr;
using testing::Outcome;
using testing::run;
using testing::TemporaryFolder;

std::string readme() {
  std::ostringstream text;
  text << std::ifstream(std::string(TRUEBEARING_SOURCE_DIR) + "/README.md").rdbuf();
  return text.str();
}

// `truebearing ARGUMENTS` in the order in which they stand there, names of subcommands alone apart.
std::vector<std::string> commands() {
  const std::string text = readme();
  const std::regex command("`(?:build/release/)?truebearing ([a-z]+ [^`\n]+)`");
  std::vector<std::string> found;
  for (std::sregex_iterator match(text.begin(), text.end(), command), end; match != end; ++match)
    found.push_back((*match)[1]);
  return found;
}

// With two runs where it compares.
std::string shortened(const std::string& arguments) {
  if (!arguments.starts_with("compare")) return arguments;
  return std::regex_replace(arguments, std::regex(" --runs [0-9]+"), "") + " --runs 2 --quiet";
}

// What stands for the files that are not part of the project.
void write_data(const TemporaryFolder& folder, const std::string& arguments) {
  std::ostringstream rows;
  if (arguments.find("radar_1d_flight") != std::string::npos) {
    rows << "time_s,position_m,position_sigma_m,truth_position_m\n";
    for (int k = 1; k <= 60; ++k) rows << 5 * k << ',' << 500 * k + k % 7 << ",150," << 500 * k << '\n';
    folder.write("LOG.csv", rows.str());
  } else if (arguments.find("LOG.csv") != std::string::npos) {
    rows << "time_s,latitude_deg,longitude_deg\n";
    for (int k = 0; k < 60; ++k) rows << 5 * k << ',' << 42.0 + 0.005 * k << ",9.0\n";
    folder.write("LOG.csv", rows.str());
  } else if (arguments.find("ais_solent.csv") != std::string::npos) {
    rows << "time_s,vessel,latitude_deg,longitude_deg\n";
    for (int k = 0; k < 250; ++k) rows << 10 * k << ",33," << 50.0 + 5e-4 * k << ",-1.0\n";
    folder.write("ais_solent.csv", rows.str());
  }
}

TEST(Readme, EveryCommandRuns) {
  const TemporaryFolder folder;
  const std::filesystem::path source(TRUEBEARING_SOURCE_DIR);
  for (const char* shared : {"data", "models"})
    std::filesystem::create_directory_symlink(source / shared, folder.path() / shared);
  const std::vector<std::string> all = commands();
  EXPECT_GT(all.size(), 20u);
  for (const std::string& arguments : all) {
    write_data(folder, arguments);
    const Outcome outcome = run(folder, shortened(arguments));
    EXPECT_EQ(outcome.status, 0) << arguments << "\n" << outcome.err;
  }
}

TEST(Readme, ItsStudyCanBeTunedAndCompared) {
  const TemporaryFolder folder;
  const std::string text = readme(), begin = "```toml\n";
  const std::size_t first = text.find(begin + "name = \"mine\"");
  ASSERT_NE(first, std::string::npos);
  const std::size_t from = first + begin.size();
  folder.write("mine.toml", text.substr(from, text.find("```", from) - from));
  for (const char* arguments : {"check mine.toml", "tune mine.toml --quiet", "compare mine.toml --runs 5 --quiet"}) {
    const Outcome outcome = run(folder, arguments);
    EXPECT_EQ(outcome.status, 0) << arguments << "\n" << outcome.err;
  }
}

}  // namespace
}  // namespace truebearing::readme_test
