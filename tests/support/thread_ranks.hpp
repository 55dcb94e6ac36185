// SPDX-License-Identifier: Apache-2.0
// Ranks that are threads of the test, in place of processes.
#pragma once

#include <barrier>
#include <cstdlib>
#include <deque>
#include <future>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "truebearing/evaluation/ranks.hpp"

namespace truebearing::testing {

// What holds them together.
struct Wire {
  explicit Wire(std::size_t count) : to(count), said(count), met(static_cast<std::ptrdiff_t>(count)) {}
  std::mutex mutex;
  std::vector<std::deque<Ranks::Message>> to;  // [rank]
  std::vector<std::string> said;
  std::barrier<> met;
};

class ThreadRanks final : public Ranks {
 public:
  ThreadRanks(Wire& wire, std::size_t rank) : wire_(wire), rank_(rank) {}
  std::size_t rank() const override { return rank_; }
  std::size_t size() const override { return wire_.said.size(); }
  void send(std::size_t to, std::size_t number, std::string bytes) override {
    const std::lock_guard lock(wire_.mutex);
    wire_.to[to].push_front({rank_, number, std::move(bytes)});  // the last comes first
  }
  std::optional<Message> receive() override {
    const std::lock_guard lock(wire_.mutex);
    std::deque<Message>& come = wire_.to[rank_];
    if (come.empty()) return std::nullopt;
    Message message = std::move(come.front());
    come.pop_front();
    return message;
  }
  std::vector<std::string> gather_all(std::string_view bytes) override {
    wire_.said[rank_] = bytes;
    wire_.met.arrive_and_wait();
    std::vector<std::string> all = wire_.said;
    wire_.met.arrive_and_wait();
    return all;
  }
  void leave() override {}
  [[noreturn]] void abort() override { std::abort(); }

 private:
  Wire& wire_;
  std::size_t rank_;
};

/// What work(ranks) gives at each of so many ranks, by rank.
template <typename Work>
auto at_ranks(std::size_t count, const Work& work) {
  using Result = decltype(work(std::declval<Ranks&>()));
  Wire wire(count);
  std::vector<std::future<Result>> at_work;
  for (std::size_t rank = 0; rank < count; ++rank)
    at_work.push_back(std::async(std::launch::async, [&wire, &work, rank] {
      ThreadRanks own(wire, rank);
      return work(own);
    }));
  std::vector<Result> results;
  for (std::future<Result>& one : at_work) results.push_back(one.get());
  return results;
}

}  // namespace truebearing::testing
