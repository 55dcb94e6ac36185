// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/ranks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <barrier>
#include <deque>
#include <fmt/format.h>
#include <future>
#include <mutex>

#include "tests/support/error_message.hpp"
#include "tests/support/line_trackers.hpp"
#include "truebearing/evaluation/report.hpp"

namespace truebearing::ranks_test {
namespace {

using testing::error_message;
using ::testing::HasSubstr;

// Threads in place of processes.
struct Wire {
  explicit Wire(std::size_t count) : said(count), met(static_cast<std::ptrdiff_t>(count)) {}
  std::mutex mutex;
  std::deque<std::pair<std::size_t, std::string>> to_first;
  std::vector<std::string> said;
  std::barrier<> met;
};

class ThreadRanks final : public Ranks {
 public:
  ThreadRanks(Wire& wire, std::size_t rank) : wire_(wire), rank_(rank) {}
  std::size_t rank() const override { return rank_; }
  std::size_t size() const override { return wire_.said.size(); }
  void send(std::size_t number, std::string_view bytes) override {
    const std::lock_guard lock(wire_.mutex);
    wire_.to_first.emplace_front(number, bytes);  // the last comes first
  }
  std::optional<std::pair<std::size_t, std::string>> receive() override {
    const std::lock_guard lock(wire_.mutex);
    if (wire_.to_first.empty()) return std::nullopt;
    auto come = std::move(wire_.to_first.front());
    wire_.to_first.pop_front();
    return come;
  }
  std::vector<std::string> gather_all(std::string_view bytes) override {
    wire_.said[rank_] = bytes;
    wire_.met.arrive_and_wait();
    return wire_.said;
  }
  void leave() override {}
  [[noreturn]] void abort() override { std::abort(); }

 private:
  Wire& wire_;
  std::size_t rank_;
};

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
    Wire wire(count);
    std::vector<std::future<std::string>> ranks;
    std::atomic<std::size_t> most_done = 0;
    for (std::size_t rank = 0; rank < count; ++rank)
      ranks.push_back(std::async(std::launch::async, [&, rank] {
        ThreadRanks own(wire, rank);
        ComparisonRuns runs(set, scenarios, options);
        ComparisonFigures figures(runs);
        run_blocks(
            runs, own, [&](std::size_t done, std::size_t) { most_done = std::max(most_done.load(), done); },
            [&](std::size_t block, std::string_view bytes) { figures.add(block, bytes); });
        return rank == 0 ? comparison_json(figures.comparison()) : std::string();
      }));
    EXPECT_EQ(ranks[0].get(), one);
    EXPECT_EQ(most_done, 602u);
  }
}

TEST(Ranks, WithOtherInputsAreRefusedAtAllOfThem) {
  Wire wire(3);
  std::vector<std::future<std::string>> messages;
  for (std::size_t rank = 0; rank < 3; ++rank)
    messages.push_back(std::async(std::launch::async, [&, rank] {
      ThreadRanks own(wire, rank);
      return error_message([&] { check_all_have(own, rank == 2 ? "other" : "text", "study"); });
    }));
  for (auto& message : messages) EXPECT_THAT(message.get(), HasSubstr("rank 2: has another study than rank 0"));
}

}  // namespace
}  // namespace truebearing::ranks_test
