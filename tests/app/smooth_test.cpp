// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/app/program_tests.hpp"
#include "tests/support/radar_study.hpp"
#include "truebearing/tracker/step_log.hpp"

namespace truebearing::app_test::smooth_test {
namespace {

// The small study without what is yet to be trained, and a log of it.
void write_log(const TemporaryFolder& folder) {
  write_study(folder);
  folder.write("plain.toml", kStudy.substr(0, kStudy.find("[trackers.wide]")).replace(kStudy.find("pairs"), 24, ""));
  ASSERT_EQ(run(folder, "simulate scenario.toml -o logs --runs 1").status, 0);
}

TEST(Smooth, WritesSmoothedRecordsAsTrackDoes) {
  const TemporaryFolder folder;
  write_log(folder);
  const Outcome smooth = run(folder, "smooth plain.toml logs/run_0000.csv -o smooth.csv --json smooth.json");
  EXPECT_EQ(smooth.status, 0) << smooth.err;
  EXPECT_THAT(smooth.out, AllOf(HasSubstr("plain_smoothed"), HasSubstr("tuned_smoothed"), HasSubstr("position m")));
  EXPECT_THAT(folder.read("smooth.json"), HasSubstr("\"tuned_smoothed\""));
  ASSERT_EQ(run(folder, "track plain.toml logs/run_0000.csv -o track.csv").status, 0);
  const auto smoothed = read_step_log(folder.path() / "smooth.csv", "tuned_smoothed").records;
  const auto tracked = read_step_log(folder.path() / "track.csv", "tuned").records;
  ASSERT_EQ(smoothed.size(), 40u);
  ASSERT_EQ(tracked.size(), 40u);
  for (std::size_t k = 0; k + 1 < 40; ++k) EXPECT_LT(smoothed[k].P(0, 0), tracked[k].P(0, 0)) << k;
  EXPECT_EQ(smoothed.back().x, tracked.back().x);
}

TEST(Smooth, OfAFixedLagKnowsLess) {
  const TemporaryFolder folder;
  write_log(folder);
  ASSERT_EQ(run(folder, "smooth plain.toml logs/run_0000.csv -o smooth.csv").status, 0);
  ASSERT_EQ(run(folder, "smooth plain.toml logs/run_0000.csv --lag 3 -o lag.csv").status, 0);
  const auto smoothed = read_step_log(folder.path() / "smooth.csv", "tuned_smoothed").records;
  const auto lagged = read_step_log(folder.path() / "lag.csv", "tuned_smoothed").records;
  EXPECT_GT(lagged[10].P(0, 0), 1.01 * smoothed[10].P(0, 0));
  EXPECT_EQ(run(folder, "smooth plain.toml logs/run_0000.csv --lag 0").status, 2);
}

// A study of a log may compare a filter with its smoother; `track` then waits for the log's end.
TEST(Smooth, TrackRunsTheSmoothersOfAStudy) {
  const TemporaryFolder folder;
  write_log(folder);
  folder.write("both.toml", folder.read("plain.toml") + "\n[trackers.smooth]\nkind = \"smoother\"\nof = \"tuned\"\n");
  ASSERT_EQ(run(folder, "track both.toml logs/run_0000.csv -o both.csv").status, 0);
  ASSERT_EQ(run(folder, "smooth plain.toml logs/run_0000.csv -o smooth.csv").status, 0);
  const auto both = read_step_log(folder.path() / "both.csv", "smooth").records;
  const auto smoothed = read_step_log(folder.path() / "smooth.csv", "tuned_smoothed").records;
  ASSERT_EQ(both.size(), smoothed.size());
  for (std::size_t k = 0; k < both.size(); ++k) EXPECT_EQ(both[k].x, smoothed[k].x);
  EXPECT_EQ(run(folder, "compare both.toml --runs 3 --quiet").status, 0);
}

TEST(Smooth, SaysWhatThereIsNoSmootherOf) {
  const TemporaryFolder folder;
  write_log(folder);
  const std::string raw = "\n[trackers.raw]\nkind = \"raw\"\ncomponents = [\"position_m\"]\nsigma = [3162.0]\n";
  folder.write("raw.toml", folder.read("plain.toml") + raw);
  EXPECT_THAT(run(folder, "smooth raw.toml logs/run_0000.csv").err,
              AllOf(HasSubstr("raw: is left out"), Not(HasSubstr("tuned"))));
  const std::string text = folder.read("plain.toml");
  folder.write("only.toml", text.substr(0, text.find("[trackers.plain]")) + raw);
  const Outcome none = run(folder, "smooth only.toml logs/run_0000.csv");
  EXPECT_EQ(none.status, 1);
  EXPECT_THAT(none.err, HasSubstr("shows no filter that there is a smoother of"));
}

}  // namespace
}  // namespace truebearing::app_test::smooth_test
