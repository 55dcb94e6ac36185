// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/ranks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <fmt/format.h>
#include <future>
#include <numeric>
#include <thread>

#include "tests/support/error_message.hpp"
#include "tests/support/line_trackers.hpp"
#include "tests/support/thread_ranks.hpp"
#include "truebearing/core/error.hpp"
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

// One that waits until all else is made would wait for ever if some of it were its own.
TEST(Ranks, MakeWhatASlowOneDoesNotComeTo) {
  constexpr std::size_t kItems = 50;
  for (const std::size_t slow : {0u, 2u}) {
    std::atomic<std::size_t> made = 0;
    const auto by_rank = at_ranks(3, [&](Ranks& ranks) {
      std::atomic<std::size_t> own = 0;
      const auto make = [&](std::size_t, std::size_t) {
        for (int look = 0; ranks.rank() == slow && made < kItems - 1 && look < 5000; ++look)
          std::this_thread::sleep_for(std::chrono::milliseconds(1));
        ++own;
        ++made;
        return std::string();
      };
      share_work(ranks, kItems, 1, make, [](std::size_t, const std::string&) {});
      return own.load();
    });
    EXPECT_LE(by_rank[slow], 1u);
    EXPECT_EQ(made, kItems);
  }
}

// Messages to the first, which are played by hand: a rank with one thread, and what it says before it is answered.
TEST(Ranks, AskForTheNextItemBeforeTheyNeedItWhereItemsTakeLittleTime) {
  for (const bool quick : {true, false}) {
    testing::Wire wire(2);
    testing::ThreadRanks first(wire, 0), second(wire, 1);
    std::vector<Ranks::Message> asked;
    const auto hear = [&](std::size_t count, int most_looks) {
      for (int look = 0; asked.size() < count && look < most_looks; ++look) {
        while (std::optional<Ranks::Message> come = first.receive()) asked.push_back(std::move(*come));
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
      return asked.size();
    };
    auto work = std::async(std::launch::async, [&] {
      const auto make = [&](std::size_t, std::size_t) {
        if (!quick) std::this_thread::sleep_for(std::chrono::milliseconds(60));
        return std::string("made");
      };
      share_work(second, 9, 1, make, [](std::size_t, const std::string&) {});
    });
    ASSERT_EQ(hear(1, 5000), 1u);
    const std::size_t asks = asked[0].number;
    first.send(1, 7, {});
    ASSERT_GE(hear(2, 5000), 2u);
    EXPECT_EQ(hear(3, quick ? 5000 : 50), quick ? 3u : 2u);
    EXPECT_TRUE(std::any_of(asked.begin(), asked.end(),
                            [](const Ranks::Message& come) { return come.number == 7 && come.bytes == "made"; }));
    for (std::size_t i = 1; i < asked.size(); ++i) first.send(1, asks, {});  // nothing is left
    first.gather_all({});
    work.get();
  }
}

// Which ends the program, where the other threads of the rank wait for work.
TEST(Ranks, ThrowWhatTheirWorkThrows) {
  const auto make = [](std::size_t, std::size_t) -> std::string { throw InputError("here", "failed"); };
  const auto take = [](std::size_t, const std::string&) {};
  for (const std::size_t rank : {0u, 1u}) {
    testing::Wire wire(2);
    testing::ThreadRanks ranks(wire, rank);
    wire.to[1].push_back({0, 3, {}});
    EXPECT_THAT(error_message([&] { share_work(ranks, 5, 2, make, take); }), HasSubstr("here: failed"));
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
