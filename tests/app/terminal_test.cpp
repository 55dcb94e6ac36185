// SPDX-License-Identifier: Apache-2.0
// What is printed for people: its width, its marks, its sentences. On a terminal: script(1) makes one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <string>

#include "tests/app/program_tests.hpp"

namespace truebearing::app_test::terminal_test {
namespace {

using ::testing::ContainsRegex;

std::size_t widest_line(const std::string& text) {
  std::size_t widest = 0;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) widest = std::max(widest, line.size());
  return widest;
}

TEST(Terminal, CompareHas100ColumnsUnlessItMayBeWide) {
  const TemporaryFolder folder;
  const std::string arguments = "compare manoeuvre_2d --runs 3 --quiet ";
  const Outcome narrow = run(folder, arguments), wide = run(folder, arguments + "--wide");
  ASSERT_EQ(narrow.status, 0) << narrow.err;
  const std::string tables = narrow.out.substr(0, narrow.out.size() - last_line(narrow.out).size());
  EXPECT_LE(widest_line(tables), 100u);
  EXPECT_GT(widest_line(wide.out), 100u);
  EXPECT_THAT(narrow.out, ContainsRegex("\ngru +[0-9.]+\\*? ")) << "each block has the trackers' names";
  EXPECT_THAT(narrow.out, Not(HasSubstr("\033"))) << "no colour where nobody looks at a terminal";
}

TEST(Terminal, CompanionsHaveARowWhereTheyAreAskedFor) {
  const TemporaryFolder folder;
  EXPECT_THAT(run(folder, "compare manoeuvre_2d --runs 2 --quiet").out, Not(HasSubstr("\nslow ")));
  EXPECT_THAT(run(folder, "compare manoeuvre_2d --runs 2 --quiet --all").out, HasSubstr("\nslow "));
}

TEST(Terminal, CompareEndsWithTheSentenceOfTheReport) {
  const TemporaryFolder folder;
  const Outcome outcome = run(folder, "compare radar_1d_family --runs 20 --quiet --report page.html");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const std::string sentence = last_line(outcome.out);
  EXPECT_THAT(sentence, ContainsRegex("^nfnn is .* tuned in position .* the bound bayes_bank"));
  EXPECT_THAT(folder.read("page.html"), HasSubstr(sentence.substr(0, sentence.size() - 1)));
}

TEST(Terminal, MarkdownIsTablesForADocument) {
  const TemporaryFolder folder;
  const Outcome outcome = run(folder, "compare radar_1d_family --runs 20 --quiet --markdown");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("| tracker | position RMSE m | +- |"));
  EXPECT_THAT(outcome.out, ContainsRegex("\\| \\*\\*[0-9.]+\\*\\* \\|")) << "the best is bold";
}

TEST(Terminal, ColourIsForATerminalThatNobodyObjectsTo) {
  if (std::system("command -v script > /dev/null 2>&1") != 0) GTEST_SKIP() << "no script(1)";
  const TemporaryFolder folder;
  const auto on_terminal = [&](const std::string& environment) {
    const std::string command = "cd '" + folder.path().string() + "' && " + environment + " script -qec \"'" +
                                TRUEBEARING_PROGRAM +
                                "' compare radar_1d_family --runs 2 --quiet\" /dev/null > out.txt < /dev/null";
    EXPECT_EQ(std::system(command.c_str()), 0);
    return folder.read("out.txt");
  };
  EXPECT_THAT(on_terminal("TERM=xterm NO_COLOR="), ContainsRegex("\033\\[32m[0-9.]+\\*\033\\[0m"));
  EXPECT_THAT(on_terminal("TERM=xterm NO_COLOR=1"), Not(HasSubstr("\033[")));
  EXPECT_THAT(on_terminal("TERM=dumb NO_COLOR="), Not(HasSubstr("\033[")));
}

TEST(Terminal, AMistypedSubcommandGetsTheNearestName) {
  const TemporaryFolder folder;
  const Outcome outcome = run(folder, "comprae small.toml");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("\"comprae\" is no subcommand; valid: did you mean \"compare\""));
  EXPECT_TRUE(is_one_line(outcome.err)) << outcome.err;
  EXPECT_EQ(outcome.out, "");
}

TEST(Terminal, RulesAreATableWithALegend) {
  const TemporaryFolder folder;
  write_study(folder);
  EXPECT_EQ(run(folder, "tune small.toml --quiet").status, 0);
  EXPECT_EQ(run(folder, "train small.toml --quiet").status, 0);
  const Outcome outcome = run(folder, "rules small.nfnn.json");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  for (const char* says : {"a fuzzy network (NFNN): 3 inputs, 4 rules, 2 outputs",
                           "b  difference of wide in velocity_mps", "adds position_m", "VS very small", "seed: 5"})
    EXPECT_THAT(outcome.out, HasSubstr(says));
  EXPECT_THAT(outcome.out, ContainsRegex("\n4 +[0-9.]+ +[A-Z]+ +[A-Z]+ +[A-Z]+ +[-+0-9.e]+ +[-+0-9.e]+\n"));
  const Outcome sentences = run(folder, "rules small.nfnn.json --sentences");
  EXPECT_THAT(sentences.out, HasSubstr("4. IF ln step is"));
}

TEST(Terminal, OfARecurrentNetworkItsFactsAreTold) {
  const TemporaryFolder folder;
  const Outcome outcome =
      run(folder, "rules '" + std::string(TRUEBEARING_SOURCE_DIR) + "/models/manoeuvre_2d.gru.json'");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  for (const char* says : {"a recurrent network (GRU): ", " weights; it holds no rules", "frame: track", "seed: 1",
                           "validation: 200 runs", "difference of slow in along_m"})
    EXPECT_THAT(outcome.out, HasSubstr(says));
  EXPECT_THAT(outcome.out, Not(HasSubstr("IF")));
}

}  // namespace
}  // namespace truebearing::app_test::terminal_test
