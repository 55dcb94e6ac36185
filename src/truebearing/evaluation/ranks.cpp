// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/ranks.hpp"

#include <chrono>
#include <exception>
#include <fmt/format.h>
#include <future>
#include <map>
#include <mutex>
#include <thread>
#include <utility>

#include "truebearing/core/error.hpp"

namespace truebearing {
namespace {

// Rank 0 works too: it looks for what has come, and leaves the processor to its own runs in between.
constexpr std::chrono::microseconds kBetweenLooks{500};

// Gives blocks on in their order, whoever they come from.
class InOrder {
 public:
  InOrder(const ComparisonRuns& runs, const Progress& progress,
          const std::function<void(std::size_t, std::string_view)>& take)
      : runs_(runs), progress_(progress), take_(take), total_(runs.scenarios().size() * runs.options().runs) {}

  void add(std::size_t block, std::string bytes) {
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
};

}  // namespace

void check_all_have(Ranks& ranks, const std::string& text, const std::string& what) {
  const std::vector<std::string> all = ranks.gather_all(text);
  for (std::size_t rank = 1; rank < all.size(); ++rank)
    if (all[rank] != all[0])
      throw InputError(fmt::format("rank {}", rank), "has another " + what + " than rank 0",
                       "the same on all machines");
}

std::string from_first(Ranks& ranks, std::string_view bytes) {
  return std::move(ranks.gather_all(is_first(&ranks) ? bytes : std::string_view()).front());
}

BlockRange own_runs(const Ranks* ranks, std::size_t runs) {
  // What costs more may stand together, in sets of runs say.
  return ranks ? BlockRange{ranks->rank(), runs, ranks->size()} : BlockRange{0, runs};
}

void share_work(Ranks& ranks, std::size_t items, int threads,
                const std::function<std::string(std::size_t item, std::size_t worker)>& make,
                const std::function<void(std::size_t item, std::string bytes)>& take, const Progress& progress) {
  const BlockRange own = own_runs(&ranks, items);
  std::mutex mutex;
  const auto do_own = [&](const auto& give) {
    monte_carlo(own.size(), threads, [&](std::size_t i, std::size_t worker) {
      const std::size_t item = own.first + i * own.stride;
      std::string bytes = make(item, worker);
      const std::lock_guard lock(mutex);
      give(item, std::move(bytes));
    });
  };
  if (ranks.rank() != 0) {
    do_own([&](std::size_t item, const std::string& bytes) { ranks.send(item, bytes); });
  } else {
    std::size_t done = 0;
    const auto add = [&](std::size_t item, std::string bytes) {
      take(item, std::move(bytes));
      if (progress) progress(++done, items);
    };
    std::future<void> computed = std::async(std::launch::async, [&] { do_own(add); });
    const auto is_ready = [&] {
      return computed.valid() && computed.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
    };
    for (std::size_t missing = items - own.size(); missing > 0;) {
      if (is_ready()) computed.get();  // throws what its own work threw
      if (auto come = ranks.receive()) {
        const std::lock_guard lock(mutex);
        add(come->first, std::move(come->second));
        --missing;
      } else {
        std::this_thread::sleep_for(kBetweenLooks);
      }
    }
    if (computed.valid()) computed.get();
  }
  ranks.gather_all({});  // nobody sends of the next work while rank 0 receives of this
}

void run_blocks(ComparisonRuns& runs, Ranks* ranks, const Progress& progress,
                const std::function<void(std::size_t block, std::string_view bytes)>& take) {
  if (!ranks) return run_blocks(runs, BlockRange{0, runs.blocks()}, progress, take);
  InOrder in_order(runs, progress, take);
  share_work(
      *ranks, runs.blocks(), runs.options().threads,
      [&](std::size_t block, std::size_t worker) { return runs.run(block, worker); },
      [&](std::size_t block, std::string bytes) { in_order.add(block, std::move(bytes)); });
}

}  // namespace truebearing
