// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/comparison_runs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/evaluation/corrected_set.hpp"
#include "tests/support/error_message.hpp"
#include "tests/support/line_trackers.hpp"
#include "truebearing/evaluation/report.hpp"
#include "truebearing/simulation/recorded_scenario.hpp"

namespace truebearing::comparison_runs_test {
namespace {

using testing::error_message;
using ::testing::HasSubstr;
using testing::RadarFilter;

TrackerSet trackers() {
  Ensemble ensemble;
  RadarFilter radar;
  ensemble.add("plain", radar.tracker());
  radar.sigma_m = 4000.0;
  ensemble.add("tuned", radar.tracker());
  TrackerSet set(std::move(ensemble));
  for (const char* name : {"plain", "tuned"}) set.show_member(name);
  return set;
}

ComparisonOptions options(std::size_t runs) {
  ComparisonOptions made;
  made.runs = runs;
  made.pairs = {{"plain", "tuned"}};
  made.scoring.loss_thresholds = {{"position_m", 500.0}};
  made.scoring.times_s = {2.0, 4.0};
  made.details = true;
  return made;
}

// The tallies of all blocks, computed in two processes that each know half of them.
std::vector<std::string> tallies(ComparisonRuns& runs) {
  std::vector<std::string> all(runs.blocks());
  const std::size_t half = runs.blocks() / 2;
  const auto keep = [&](std::size_t block, std::string_view bytes) { all[block] = bytes; };
  run_blocks(runs, BlockRange{half, runs.blocks()}, {}, keep);
  run_blocks(runs, BlockRange{0, half, 2}, {}, keep);
  run_blocks(runs, BlockRange{1, half, 2}, {}, keep);
  return all;
}

TEST(RunsOfBlock, AreOneOfFewAndSixteenOfThousandsAndABlockOfFourThousandOfMany) {
  EXPECT_EQ(runs_of_block(1), 1u);
  EXPECT_EQ(runs_of_block(256), 1u);
  EXPECT_EQ(runs_of_block(257), 2u);
  EXPECT_EQ(runs_of_block(10000), 16u);
  EXPECT_EQ(runs_of_block(65536), 16u);
  EXPECT_EQ(runs_of_block(65537), 32u);
  EXPECT_EQ(runs_of_block(1000000000), 262144u);
}

TEST(ComparisonRuns, BlocksFromTwoProcessesGiveTheFiguresOfOneByteForByte) {
  const TrackerSet set = trackers();
  const LineScenario scenario = testing::radar_family(10), longer = testing::radar_family(12);
  for (const std::vector<NamedScenario>& scenarios :
       {std::vector<NamedScenario>{{"family", &scenario}},
        std::vector<NamedScenario>{{"family", &scenario}, {"longer", &longer}}}) {
    const ComparisonOptions asked = options(601);
    ComparisonRuns runs(set, scenarios, asked);
    const std::vector<std::string> blocks = tallies(runs);
    ComparisonFigures figures(runs);
    for (std::size_t block = 0; block < blocks.size(); ++block) figures.add(block, blocks[block]);
    EXPECT_EQ(comparison_json(figures.comparison()), comparison_json(compare(set, scenarios, asked)));
  }
}

// A corrected tracker and its details, whose runs of a block are stepped together.
TEST(ComparisonRuns, BlocksAreThoseOfRunsStepByStepAlone) {
  const TrackerSet set = testing::corrected_set({"plain", "tuned"});
  const LineScenario scenario = testing::radar_family(20);
  const std::vector<NamedScenario> scenarios{{"family", &scenario}};
  const ComparisonOptions asked = options(3000);
  ComparisonRuns runs(set, scenarios, asked);
  constexpr std::size_t kBlock = 187;  // the last, of 8 of 16 runs
  ASSERT_EQ(runs.runs_in(kBlock), 8u);
  for (const std::size_t block : {std::size_t{5}, kBlock}) {
    ComparisonTally alone(set, runs.scorers(), asked, kMostValuesApart, true);
    TrackerSet copy = set.fresh();
    for (std::size_t i = 0; i < runs.runs_in(block); ++i) {
      const Recording recording = scenario.simulate({asked.seed, asked.role, 16 * block + i});
      RunOutcome outcome;
      outcome.corrections = correction_tallies(copy);
      outcome.scores = score_recording(copy, runs.scorers(), recording, asked.scoring, [&](std::size_t step) {
        outcome.corrections[2]->take(step, copy.records(2), copy.correction(2)->accounts());
      });
      alone.add(outcome);
    }
    EXPECT_EQ(runs.run(block, 0), alone.bytes(false)) << block;
  }
}

// Of more than 65536 runs, blocks are compact: medians come as bins, errors and values in groups.
TEST(ComparisonRuns, ManyRunsAreAsGoodAsOneByOne) {
  const TrackerSet set = trackers();
  const LineScenario scenario = testing::radar_family(2);
  const std::vector<NamedScenario> scenarios{{"family", &scenario}};
  const ComparisonOptions asked = options(65600);
  ComparisonRuns runs(set, scenarios, asked);
  EXPECT_EQ(runs.runs_in(0), 32u);
  const std::string first = runs.run(0, 0);
  const Comparison many = compare(set, scenarios, asked);

  // The same runs one by one.
  std::vector<std::vector<RunScore>> scores(2);
  TrackerSet copy = set.fresh();
  for (std::size_t run = 0; run < asked.runs; ++run) {
    std::vector<RunScore> of_run =
        score_recording(copy, runs.scorers(), scenario.simulate({asked.seed, asked.role, run}), asked.scoring);
    for (std::size_t i = 0; i < 2; ++i) scores[i].push_back(std::move(of_run[i]));
  }
  std::vector<const RunScore*> plain, tuned;
  for (std::size_t run = 0; run < asked.runs; ++run) {
    plain.push_back(&scores[0][run]);
    tuned.push_back(&scores[1][run]);
  }
  const TrackerSummary apart = summarise("plain", runs.scorers()[0], plain, asked.scoring);
  const QuantitySummary &one = apart.quantities[0], &other = many.trackers[0].quantities[0];
  EXPECT_NEAR(other.rmse, one.rmse, 1e-12 * one.rmse);
  EXPECT_NEAR(other.median, one.median, one.median / 4096.0);
  EXPECT_NEAR(other.rmse_se, one.rmse_se, 0.05 * one.rmse_se);
  EXPECT_EQ(many.trackers[0].loss_rate, apart.loss_rate);
  const PairedDifference paired = paired_difference(runs.scorers()[0], plain, runs.scorers()[1], tuned)[0];
  EXPECT_NEAR(many.pairs[0].differences[0].mean, paired.mean, 1e-9 * std::abs(paired.mean));
  EXPECT_NEAR(many.pairs[0].differences[0].se, paired.se, 1e-9 * paired.se);
}

// The same run again would count as one more that is independent of the first.
TEST(ComparisonRuns, AreNoMoreThanDiffer) {
  const TrackerSet set = trackers();
  const LineScenario family = testing::radar_family(10);
  const RecordedScenario replayed = RecordedScenario::replayed(family.simulate({}));
  const auto made = [&](const std::vector<NamedScenario>& scenarios) {
    const ComparisonRuns runs(set, scenarios, options(20));
    std::size_t sum = 0;
    for (std::size_t block = 0; block < runs.blocks(); ++block) sum += runs.runs_in(block);
    EXPECT_EQ(sum, scenarios.size() * runs.options().runs);
    return runs.options().runs;
  };
  EXPECT_EQ(made({{"replayed", &replayed}}), 1u);
  EXPECT_EQ(made({{"family", &family}}), 20u);
  EXPECT_EQ(made({{"replayed", &replayed}, {"family", &family}}), 20u);
}

TEST(ComparisonRuns, TalliesOfOtherRunsAreRefused) {
  const TrackerSet set = trackers();
  const LineScenario scenario = testing::radar_family(10);
  const std::vector<NamedScenario> scenarios{{"family", &scenario}};
  const ComparisonOptions asked = options(2);
  ComparisonRuns runs(set, scenarios, asked);
  const std::string block = runs.run(0, 0);
  const auto refused = [&](const std::string& bytes) {
    ComparisonFigures figures(runs);
    return error_message([&] { figures.add(0, bytes); });
  };
  EXPECT_THAT(refused(block.substr(0, block.size() - 1)), HasSubstr("tally of runs: is cut short"));
  EXPECT_THAT(refused(""), HasSubstr("tally of runs: is cut short"));
  EXPECT_THAT(refused(block + "12345678"), HasSubstr("tally of runs: has more in it than the study's figures"));
  EXPECT_THAT(refused(std::string(block.size(), '\xff')), HasSubstr("tally of runs: is cut short"));
}

}  // namespace
}  // namespace truebearing::comparison_runs_test
