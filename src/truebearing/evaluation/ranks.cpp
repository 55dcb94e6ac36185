// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/ranks.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <fmt/format.h>
#include <future>
#include <limits>
#include <map>
#include <mutex>
#include <thread>
#include <utility>

#include "truebearing/core/error.hpp"

namespace truebearing {
namespace {

using Clock = std::chrono::steady_clock;
using Make = std::function<std::string(std::size_t item, std::size_t worker)>;
using Take = std::function<void(std::size_t item, std::string bytes)>;

// How fast a rank's threads make items, and so how often it looks for what has come: a look takes the processor from
// them, and a message that waits for one delays the next item.
class Pace {
 public:
  void took(Clock::duration item) { last_ = item; }
  Clock::duration between_looks() const {
    return std::clamp<Clock::duration>(last_.load() / 4, std::chrono::microseconds(100), std::chrono::milliseconds(2));
  }
  // Who makes items fast has the next one before it needs it. Of those that take longer none should lie at a rank
  // while others are out of work.
  bool wants_ahead() const {
    const Clock::duration last = last_;
    return last > Clock::duration::zero() && last < std::chrono::milliseconds(50);
  }

 private:
  std::atomic<Clock::duration> last_ = Clock::duration::zero();  // none yet
};

// Other ranks send what they made of an item, by which they ask for another. Their numbers besides: they ask, or have
// made all that they were given. Rank 0 answers with an item, or that nothing is left.
constexpr std::size_t kAsks = std::numeric_limits<std::size_t>::max(), kHasDone = kAsks - 1, kNothingLeft = kAsks;

// Threads of their own that make items: of a Source, which gives the next one or none, takes what was made, can be told
// to give no more, and knows their pace.
template <typename Source>
std::future<void> at_work(int threads, const Make& make, Source& source) {
  return std::async(std::launch::async, [threads, &make, &source] {
    monte_carlo(worker_count(threads), threads, [&](std::size_t, std::size_t worker) {
      try {
        while (const std::optional<std::size_t> item = source.next()) {
          const Clock::time_point begin = Clock::now();
          std::string bytes = make(*item, worker);
          source.pace.took(Clock::now() - begin);
          source.give(*item, std::move(bytes));
        }
      } catch (...) {
        source.stop();
        throw;
      }
    });
  });
}

// Throws what the work threw.
bool has_ended(std::future<void>& work) {
  if (work.valid() && work.wait_for(std::chrono::seconds(0)) == std::future_status::ready) work.get();
  return !work.valid();
}

// At rank 0: the items that nobody has begun, and what was made of the others.
class AllItems {
 public:
  AllItems(std::size_t items, const Take& take, const Progress& progress)
      : items_(items), take_(take), progress_(progress) {}

  Pace pace;
  std::optional<std::size_t> next() {
    const std::size_t item = next_++;
    return item < items_ ? std::optional(item) : std::nullopt;
  }
  void give(std::size_t item, std::string bytes) {
    const std::lock_guard lock(mutex_);
    take_(item, std::move(bytes));
    if (progress_) progress_(++done_, items_);
  }
  void stop() { next_ = items_; }

 private:
  std::size_t items_;
  const Take& take_;
  const Progress& progress_;
  std::atomic<std::size_t> next_ = 0;
  std::mutex mutex_;
  std::size_t done_ = 0;
};

// At another rank: between its threads and the one that talks with rank 0.
class Desk {
 public:
  Pace pace;
  std::optional<std::size_t> next() {
    std::unique_lock lock(mutex_);
    if (items_.empty() && pace.wants_ahead()) ++wanted_;
    for_threads_.wait(lock, [&] { return is_closed_ || !items_.empty(); });
    if (is_closed_) return std::nullopt;
    const std::size_t item = items_.front();
    items_.pop_front();
    return item;
  }
  void give(std::size_t item, std::string bytes) {
    const std::lock_guard lock(mutex_);
    made_.emplace_back(item, std::move(bytes));
    for_talker_.notify_one();
  }
  void stop() {
    const std::lock_guard lock(mutex_);
    is_closed_ = true;
    for_threads_.notify_all();
  }

  void put(std::size_t item) {
    const std::lock_guard lock(mutex_);
    items_.push_back(item);
    for_threads_.notify_one();
  }
  bool has_items() {
    const std::lock_guard lock(mutex_);
    return !items_.empty();
  }
  struct News {
    std::vector<std::pair<std::size_t, std::string>> made;
    std::size_t wanted;  // so many times a thread had to wait
  };
  // Waits for some, but not long.
  News news() {
    std::unique_lock lock(mutex_);
    for_talker_.wait_for(lock, pace.between_looks(), [&] { return !made_.empty(); });
    return {std::exchange(made_, {}), std::exchange(wanted_, 0)};
  }

 private:
  std::mutex mutex_;
  std::condition_variable for_threads_, for_talker_;
  std::deque<std::size_t> items_;
  std::vector<std::pair<std::size_t, std::string>> made_;
  std::size_t wanted_ = 0;
  bool is_closed_ = false;
};

void work_and_lead(Ranks& ranks, std::size_t items, int threads, const Make& make, const Take& take,
                   const Progress& progress) {
  AllItems all(items, take, progress);
  std::future<void> own = at_work(threads, make, all);
  try {
    for (std::size_t others = ranks.size() - 1; others > 0;) {
      has_ended(own);
      std::optional<Ranks::Message> come = ranks.receive();
      if (!come) {
        std::this_thread::sleep_for(all.pace.between_looks());
      } else if (come->number == kHasDone) {
        --others;
      } else {
        ranks.send(come->rank, all.next().value_or(kNothingLeft), {});  // before anything that takes time
        if (come->number != kAsks) all.give(come->number, std::move(come->bytes));
      }
    }
    if (own.valid()) own.get();
  } catch (...) {
    all.stop();
    throw;
  }
}

void work_for_first(Ranks& ranks, int threads, const Make& make) {
  Desk desk;
  std::future<void> own = at_work(threads, make, desk);
  try {
    std::size_t unanswered = 0;
    const auto send = [&](std::size_t number, std::string bytes) {
      ranks.send(0, number, std::move(bytes));
      ++unanswered;
    };
    for (std::size_t i = 0; i < worker_count(threads); ++i) send(kAsks, {});
    for (bool is_any_left = true, have_ended = false; !have_ended || unanswered > 0;) {
      have_ended = has_ended(own);  // all that they made is among the news then
      Desk::News news = desk.news();
      for (auto& [item, bytes] : news.made) send(item, std::move(bytes));
      for (; is_any_left && news.wanted > 0; --news.wanted) send(kAsks, {});
      while (const std::optional<Ranks::Message> come = ranks.receive()) {
        --unanswered;
        if (come->number == kNothingLeft) {
          is_any_left = false;
        } else {
          desk.put(come->number);
        }
      }
      if (!is_any_left && unanswered == 0 && !desk.has_items()) desk.stop();
    }
  } catch (...) {
    desk.stop();
    throw;
  }
  ranks.send(0, kHasDone, {});
}

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
  if (ranks.rank() == 0) {
    work_and_lead(ranks, items, threads, make, take, progress);
  } else {
    work_for_first(ranks, threads, make);
  }
  ranks.gather_all({});  // nobody asks for the next work while rank 0 shares out this
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
