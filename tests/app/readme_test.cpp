// SPDX-License-Identifier: Apache-2.0
// Every command that the README and docs/ print runs, with few runs; so do their studies; and every link leads somewhere.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/app/program_tests.hpp"

namespace truebearing::app_test::readme_test {
namespace {

namespace fs = std::filesystem;

struct Document {
  fs::path path;
  std::string text;
};

std::vector<Document> documents() {
  const fs::path source(TRUEBEARING_SOURCE_DIR);
  std::vector<fs::path> paths{source / "README.md", source / "CONTRIBUTING.md"};
  for (const auto& entry : fs::directory_iterator(source / "docs"))
    if (entry.path().extension() == ".md") paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  std::vector<Document> all;
  for (const fs::path& path : paths) {
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    all.push_back({path, text.str()});
  }
  return all;
}

std::vector<std::string> all_matches(const std::string& text, const std::regex& pattern) {
  std::vector<std::string> found;
  for (std::sregex_iterator match(text.begin(), text.end(), pattern), end; match != end; ++match)
    found.push_back((*match)[1]);
  return found;
}

// `truebearing ARGUMENTS` in the order in which they stand in a document, names of subcommands alone apart.
std::vector<std::string> commands(const Document& document) {
  return all_matches(document.text, std::regex("`(?:build/release/)?truebearing ([a-z]+ [^`\n]+)`"));
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
  std::set<std::string> seen;
  for (const Document& document : documents())
    for (const std::string& arguments : commands(document)) {
      if (!seen.insert(shortened(arguments)).second) continue;
      write_data(folder, arguments);
      const Outcome outcome = run(folder, shortened(arguments));
      EXPECT_EQ(outcome.status, 0) << document.path << ": " << arguments << "\n" << outcome.err;
    }
  EXPECT_GT(seen.size(), 20u);
}

TEST(Readme, ItsStudiesCanBeTunedAndCompared) {
  const TemporaryFolder folder;
  int studies = 0;
  for (const Document& document : documents())
    for (const std::string& study :
         all_matches(document.text, std::regex("```toml\n(name = \"[a-z]+\"\nruns[\\s\\S]*?)```"))) {
      ++studies;
      const std::string name = all_matches(study, std::regex("^name = \"([a-z]+)\"")).front() + ".toml";
      folder.write(name, study);
      for (const std::string step : {"check", "tune", "compare"}) {
        const Outcome outcome = run(folder, step + " " + name + (step == "compare" ? " --runs 5 --quiet" : ""));
        EXPECT_EQ(outcome.status, 0) << document.path << ": " << step << "\n" << outcome.err;
      }
    }
  EXPECT_GE(studies, 1);
}

TEST(Readme, EveryLinkLeadsSomewhere) {
  int links = 0;
  for (const Document& document : documents())
    for (const std::string& link : all_matches(document.text, std::regex("\\]\\(([^)#:]+)(?:#[^)]*)?\\)"))) {
      ++links;
      EXPECT_TRUE(fs::exists(document.path.parent_path() / link)) << document.path << ": " << link;
    }
  EXPECT_GT(links, 20);
}

}  // namespace
}  // namespace truebearing::app_test::readme_test
