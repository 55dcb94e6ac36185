// SPDX-License-Identifier: Apache-2.0
// What the program does with its outputs: nothing of the user's is destroyed, and nothing fails in silence.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/app/program_tests.hpp"

namespace truebearing::app_test::outputs_test {
namespace {

std::string plain_study() {
  return replaced(kStudy.substr(0, kStudy.find("[trackers.tuned]")), "pairs = [\"nfnn - tuned\"]\n", "");
}

TEST(Outputs, NoneReplacesAnInputOfItsOwnRun) {
  const TemporaryFolder folder;
  write_study(folder);
  folder.write("plain.toml", plain_study());
  folder.write("log.csv", "time_s,position_m,truth_position_m\n1,100,100\n2,110,110\n");
  folder.write("bearings.csv", "time_s,bearing_deg\n1,10\n");
  folder.write("run_0000.csv", "time_s,position_m,truth_position_m\n1,100,100\n");
  std::filesystem::create_symlink("log.csv", folder.path() / "link.csv");
  std::filesystem::create_hard_link(folder.path() / "log.csv", folder.path() / "hard.csv");
  const std::vector<std::string> names{"small.toml", "plain.toml",   "scenario.toml", "small.parameters.toml",
                                       "log.csv",    "bearings.csv", "run_0000.csv"};
  std::vector<std::string> before;
  for (const std::string& name : names) before.push_back(folder.read(name));
  for (const char* arguments : {"track plain.toml log.csv -o log.csv",
                                "track plain.toml log.csv -o ./log.csv",
                                "track plain.toml log.csv -o link.csv",
                                "track plain.toml link.csv -o log.csv",
                                "track plain.toml log.csv -o hard.csv",
                                "track plain.toml log.csv --events log.csv",
                                "track plain.toml log.csv --json plain.toml",
                                "track plain.toml log.csv -o scenario.toml",
                                "track plain.toml - -o log.csv < log.csv",
                                "track plain.toml log.csv -o - >> log.csv",
                                "compare plain.toml --json plain.toml",
                                "compare plain.toml --json scenario.toml",
                                "compare plain.toml --truth log.csv --json log.csv",
                                "tune small.toml -o small.toml",
                                "tune small.toml -o scenario.toml",
                                "train small.toml -o small.toml",
                                "train small.toml -o small.parameters.toml",
                                "tma bearings.csv --json bearings.csv",
                                "simulate scenario.toml --track run_0000.csv -o .",
                                "track plain.toml log.csv -o x.csv --json x.csv"}) {
    const Outcome outcome = run(folder, arguments);
    EXPECT_EQ(outcome.status, 1) << arguments;
    EXPECT_TRUE(is_one_line(outcome.err)) << arguments << "\n" << outcome.err;
    for (std::size_t i = 0; i < names.size(); ++i) EXPECT_EQ(folder.read(names[i]), before[i]) << arguments;
  }
  EXPECT_THAT(run(folder, "track plain.toml log.csv -o link.csv").err, HasSubstr("is read by this command"));
  EXPECT_EQ(run(folder, "tune small.toml -o small.parameters.toml --quiet").status, 0) << "its own product is none";
}

TEST(Outputs, OneThatCannotBeWrittenIsSaidBeforeTheWork) {
  const TemporaryFolder folder;
  write_study(folder, replaced(replaced(kStudy, "iterations = 10", "iterations = 100000000"), "runs = 20\nseed",
                               "runs = 10000000\nseed"));
  for (const char* arguments : {"compare small.toml --json nowhere/x.json", "train small.toml -o nowhere/x.json",
                                "tune small.toml -o nowhere/x.toml", "tune small.toml -o ."}) {
    const Outcome outcome = run(folder, arguments);
    EXPECT_EQ(outcome.status, 1) << arguments;
    EXPECT_TRUE(is_one_line(outcome.err)) << outcome.err;
  }
  folder.write("unnamed.toml", replaced(kStudy, "parameters = \"small.parameters.toml\"\n", ""));
  EXPECT_THAT(run(folder, "tune unnamed.toml").err,
              AllOf(HasSubstr("no key `parameters`"), ::testing::Not(HasSubstr("tuned "))));
}

TEST(Outputs, StandardOutputAndPipesAreWrittenByEveryName) {
  const TemporaryFolder folder;
  write_study(folder, plain_study());
  folder.write("log.csv", "time_s,position_m\n1,100\n2,110\n");
  const std::string expected = run(folder, "track small.toml log.csv -o -").out;
  EXPECT_THAT(expected, HasSubstr("time_s,tracker"));
  EXPECT_EQ(run(folder, "track small.toml log.csv -o /dev/stdout").out, expected);
  EXPECT_EQ(run(folder, "track small.toml log.csv -o /dev/stdout > file").status, 0);
  EXPECT_EQ(folder.read("file"), expected);
  EXPECT_EQ(run(folder, "track small.toml log.csv -o pipe > /dev/null & cat pipe", "mkfifo pipe;").out, expected);
  EXPECT_EQ(run(folder, "track small.toml log.csv -o /dev/null").status, 0);
}

TEST(Outputs, FullOrClosedStreamsAreNoAbort) {
  const TemporaryFolder folder;
  write_study(folder, plain_study());
  folder.write("log.csv", "time_s,position_m\n1,100\n2,110\n");
  for (const char* arguments : {"--help", "--version", "compare --help", "check small.toml", "track small.toml log.csv",
                                "track small.toml log.csv -o -", "compare small.toml --runs 2"}) {
    const Outcome full = run(folder, std::string(arguments) + " > /dev/full");
    EXPECT_EQ(full.status, 1) << arguments;
    EXPECT_THAT(full.err, HasSubstr("cannot be written")) << arguments;
    EXPECT_EQ(run(folder, std::string(arguments) + " > /dev/full 2> /dev/full").status, 1) << arguments;
    EXPECT_EQ(run(folder, std::string(arguments) + " >&-").status, 1) << arguments;
    EXPECT_EQ(run(folder, std::string(arguments) + " >&- 2>&-").status, 1) << arguments;
  }
  for (const char* stream : {" 2> /dev/full", " 2>&-"}) {
    EXPECT_EQ(run(folder, std::string("check nowhere.toml") + stream).status, 1) << stream;
    EXPECT_EQ(run(folder, std::string("nonsense") + stream).status, 2) << stream;
    EXPECT_EQ(run(folder, std::string("track small.toml log.csv -o steps.csv") + stream).status, 0) << stream;
  }
  EXPECT_THAT(folder.read("steps.csv"), ::testing::StartsWith("time_s,tracker"));
}

TEST(Outputs, PageIsNotTheFolderOfThePlots) {
  const TemporaryFolder folder;
  write_study(folder, plain_study());
  folder.write("log.csv", "time_s,position_m,truth_position_m\n1,100,100\n2,110,110\n");
  const int files = folder.files();
  for (const char* arguments :
       {"track small.toml log.csv --report a.html --svg a.html", "track small.toml log.csv -o a.html --svg ./a.html",
        "track small.toml log.csv --svg log.csv", "compare small.toml --runs 2 --json a.json --svg a.json",
        "tma log.csv --report a.html --svg a.html"}) {
    const Outcome outcome = run(folder, arguments);
    EXPECT_EQ(outcome.status, 1) << arguments;
    EXPECT_THAT(outcome.err, ::testing::HasSubstr("folder for the plots")) << arguments;
    EXPECT_TRUE(outcome.out.empty()) << "before the work: " << outcome.out;
  }
  EXPECT_EQ(folder.files(), files);
}

TEST(Outputs, ForgottenAndImpossibleValuesAreWrongUsage) {
  const TemporaryFolder folder;
  write_study(folder, plain_study());
  folder.write("log.csv", "time_s,position_m,truth_position_m\n1,100,100\n2,110,110\n");
  const int files = folder.files();
  for (const char* arguments :
       {"compare small.toml --runs 2 --json --quiet", "track small.toml log.csv -o ''",
        "track small.toml log.csv -o --json -", "compare small.toml --seed -1", "tune small.toml --seed -1",
        "simulate scenario.toml -o logs --seed -1", "simulate scenario.toml -o ''", "check ''", "tma log.csv --sigma 0",
        "tma log.csv --sigma -1", "track small.toml log.csv --sort-window -1", "track small.toml log.csv --late inf",
        "track small.toml log.csv --sort-window nan", "tma log.csv --from nan",
        "compare small.toml --seed 18446744073709551616"}) {
    const Outcome outcome = run(folder, arguments);
    EXPECT_EQ(outcome.status, 2) << arguments << outcome.err;
    EXPECT_LT(outcome.err.size(), 300u) << outcome.err;
    EXPECT_TRUE(testing::is_one_line(outcome.err)) << outcome.err;
    EXPECT_THAT(outcome.err, ::testing::StartsWith("truebearing: "));
  }
  EXPECT_EQ(folder.files(), files);
  EXPECT_EQ(run(folder, "compare small.toml --runs 2 --seed 18446744073709551615").status, 0);
}

}  // namespace
}  // namespace truebearing::app_test::outputs_test
