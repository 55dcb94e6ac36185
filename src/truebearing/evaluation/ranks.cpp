// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/ranks.hpp"

#include <chrono>
#include <exception>
#include <fmt/format.h>
#include <future>
#include <map>
#include <mutex>
#include <thread>

#include "truebearing/core/error.hpp"

namespace truebearing {
namespace {

// Rank 0 computes too: it looks for what has come, and leaves the processor to its own runs in between.
constexpr std::chrono::microseconds kBetweenLooks{500};

// Gives blocks on in their order, whoever they come from.
class InOrder {
 public:
  InOrder(const ComparisonRuns& runs, const Progress& progress,
          const std::function<void(std::size_t, std::string_view)>& take)
      : runs_(runs), progress_(progress), take_(take), total_(runs.scenarios().size() * runs.options().runs) {}

  void add(std::size_t block, std::string bytes) {
    const std::lock_guard lock(mutex_);
    waiting_.emplace(block, std::move(bytes));
    for (auto it = waiting_.begin(); it != waiting_.end() && it->first == next_; it = waiting_.erase(it), ++next_)
      take_(it->first, it->second);
    done_ += runs_.runs_in(block);
    if (progress_) progress_(done_, total_);
  }

 private:
  const ComparisonRuns& runs_;
  const Progress& progress_;
  const std::function<void(std::size_t, std::string_view)>& take_;
  std::size_t total_, done_ = 0, next_ = 0;
  std::map<std::size_t, std::string> waiting_;
  std::mutex mutex_;
};

}  // namespace

void check_all_have(Ranks& ranks, const std::string& text, const std::string& what) {
  const std::vector<std::string> all = ranks.gather_all(text);
  for (std::size_t rank = 1; rank < all.size(); ++rank)
    if (all[rank] != all[0])
      throw InputError(fmt::format("rank {}", rank), "has another " + what + " than rank 0",
                       "the same on all machines");
}

void run_blocks(ComparisonRuns& runs, Ranks& ranks, const Progress& progress,
                const std::function<void(std::size_t block, std::string_view bytes)>& take) {
  // Every rank has one block in so many: what costs more stands together in sets.
  const BlockRange own{ranks.rank(), runs.blocks(), ranks.size()};
  if (ranks.rank() != 0) {
    run_blocks(runs, own, {}, [&](std::size_t block, std::string_view bytes) { ranks.send(block, bytes); });
    return;
  }
  InOrder in_order(runs, progress, take);
  std::future<void> computed = std::async(std::launch::async, [&] {
    run_blocks(runs, own, {},
               [&](std::size_t block, std::string_view bytes) { in_order.add(block, std::string(bytes)); });
  });
  std::size_t missing = runs.blocks() - own.size();
  const auto failed = [&] {
    return computed.valid() && computed.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  };
  while (missing > 0) {
    if (failed()) computed.get();  // throws what its own runs threw
    if (auto come = ranks.receive()) {
      in_order.add(come->first, std::move(come->second));
      --missing;
    } else {
      std::this_thread::sleep_for(kBetweenLooks);
    }
  }
  if (computed.valid()) computed.get();
}

}  // namespace truebearing
