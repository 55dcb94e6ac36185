// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/ranks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <fmt/format.h>
#include <numeric>

#include "tests/support/error_message.hpp"
#include "tests/support/line_trackers.hpp"
#include "tests/support/thread_ranks.hpp"
#include "truebearing/evaluation/report.hpp"

namespace truebearing::ranks_test {
namespace {

using testing::at_ranks;
using ::testing::Each;
using testing::error_message;
using ::testing::HasSubstr;

TrackerSet trackers() {
  Ensemble ensemble;
  ensemble.add("plain", testing::RadarFilter().tracker());
  TrackerSet set(std::move(ensemble));
  set.show_member("plain");
  return set;
}

TEST(Ranks, ShareTheRunsOfAComparisonAndTheFirstHasTheFiguresOfOneProcessByteForByte) {
  const TrackerSet set = trackers();
  const LineScenario scenario = testing::radar_family(10);
  const std::vector<NamedScenario> scenarios{{"family", &scenario}, {"again", &scenario}};
  ComparisonOptions options;
  options.runs = 301;
  options.threads = 1;
  const std::string one = comparison_json(compare(set, scenarios, options));
  for (const std::size_t count : {2u, 5u}) {
    std::atomic<std::size_t> most_done = 0;
    const std::vector<std::string> said = at_ranks(count, [&](Ranks& ranks) {
      ComparisonRuns runs(set, scenarios, options);
      ComparisonFigures figures(runs);
      run_blocks(
          runs, &ranks, [&](std::size_t done, std::size_t) { most_done = std::max(most_done.load(), done); },
          [&](std::size_t block, std::string_view bytes) { figures.add(block, bytes); });
      return is_first(&ranks) ? comparison_json(figures.comparison()) : std::string();
    });
    EXPECT_EQ(said[0], one);
    EXPECT_EQ(most_done, 602u);
  }
}

TEST(Ranks, DoEachPieceOfWorkOnceAndTheFirstHasAllOfIt) {
  for (const std::size_t items : {0u, 1u, 50u}) {
    std::vector<std::atomic<int>> made(items);
    const auto taken = at_ranks(3, [&](Ranks& ranks) {
      std::vector<std::string> first(items), second(items);
      std::size_t most_done = 0;
      const auto make = [&](std::size_t item, std::size_t worker) {
        EXPECT_EQ(item % 3, ranks.rank());
        EXPECT_LT(worker, 2u);
        ++made[item];
        return fmt::format("{}", item);
      };
      const auto into = [](std::vector<std::string>& all) {
        return [&](std::size_t item, const std::string& bytes) { all[item] += bytes; };
      };
      share_work(ranks, items, 2, make, into(first), [&](std::size_t done, std::size_t total) {
        EXPECT_EQ(total, items);
        EXPECT_EQ(done, ++most_done);
      });
      share_work(
          ranks, items, 1, [](std::size_t item, std::size_t) { return fmt::format("again {}", item); }, into(second));
      EXPECT_EQ(most_done, ranks.rank() == 0 ? items : 0u);
      first.insert(first.end(), second.begin(), second.end());
      return first;
    });
    std::vector<std::string> expected;
    for (const char* text : {"{}", "again {}"})
      for (std::size_t item = 0; item < items; ++item) expected.push_back(fmt::format(fmt::runtime(text), item));
    EXPECT_EQ(taken[0], expected);
    EXPECT_THAT(taken[1], Each(""));
    EXPECT_THAT(taken[2], Each(""));
    EXPECT_EQ(std::accumulate(made.begin(), made.end(), 0), static_cast<int>(items));
  }
}

TEST(Ranks, HaveOneRunInSoMany) {
  const auto have = at_ranks(3, [](Ranks& ranks) {
    const BlockRange own = own_runs(&ranks, 7);
    return std::vector<std::size_t>{own.first, own.stride, own.size()};
  });
  EXPECT_EQ(have, (std::vector<std::vector<std::size_t>>{{0, 3, 3}, {1, 3, 2}, {2, 3, 2}}));
  EXPECT_EQ(own_runs(nullptr, 7).size(), 7u);
}

TEST(Ranks, HearWhatTheFirstSays) {
  EXPECT_THAT(at_ranks(3, [](Ranks& ranks) { return from_first(ranks, fmt::format("by {}", ranks.rank())); }),
              Each("by 0"));
}

TEST(Ranks, WithOtherInputsAreRefusedAtAllOfThem) {
  const auto messages = at_ranks(3, [](Ranks& ranks) {
    return error_message([&] { check_all_have(ranks, ranks.rank() == 2 ? "other" : "text", "study"); });
  });
  EXPECT_THAT(messages, Each(HasSubstr("rank 2: has another study than rank 0")));
}

}  // namespace
}  // namespace truebearing::ranks_test
