// SPDX-License-Identifier: Apache-2.0
// Ranks: processes, on one machine or several, that do the same work together and share its runs. What is not over runs
// (a network's training, writing) rank 0 does, and the others wait for it. What holds them together is a module of its
// own (mpi/), so that whoever has one machine needs nothing of it.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "truebearing/evaluation/comparison_runs.hpp"

namespace truebearing {

class Ranks {
 public:
  virtual ~Ranks() = default;
  /// Of this process, from 0; of all.
  virtual std::size_t rank() const = 0;
  virtual std::size_t size() const = 0;
  struct Message {
    std::size_t rank;  ///< whom it comes from
    std::size_t number;
    std::string bytes;
  };
  /// To another rank, from one thread at a time. Waits for nobody: what is long goes on its way as both call receive().
  virtual void send(std::size_t to, std::size_t number, std::string bytes) = 0;
  /// What has come from any rank, or nothing. From one thread at a time, as above.
  virtual std::optional<Message> receive() = 0;
  /// To be called by all: what each of them gave, by rank.
  virtual std::vector<std::string> gather_all(std::string_view bytes) = 0;
  /// To be called by all, at the end.
  virtual void leave() = 0;
  /// Ends all of them.
  [[noreturn]] virtual void abort() = 0;
};

/// Is this process the one that prints and writes: rank 0, or one that has no others?
inline bool is_first(const Ranks* ranks) {
  return !ranks || ranks->rank() == 0;
}

/// Throws InputError at every rank where not all gave the same text; `what` they should have in common stands in the
/// message.
void check_all_have(Ranks& ranks, const std::string& text, const std::string& what);

/// To be called by all: what rank 0 gave.
std::string from_first(Ranks& ranks, std::string_view bytes);

/// Which of so many runs are a rank's own: one in so many ranks. Without ranks all are.
BlockRange own_runs(const Ranks* ranks, std::size_t runs);

/// To be called by all: calls make(item, worker) for every item in [0, items) at one of the ranks, on `threads` threads
/// as monte_carlo() has them, and take(item, bytes) with what it gave at rank 0, in any order, from one thread at a
/// time. Items are begun in their order, by whoever is free: rank 0, which takes them all, makes fewer. All return once
/// rank 0 has taken the last. progress: of the items that rank 0 has from all.
void share_work(Ranks& ranks, std::size_t items, int threads,
                const std::function<std::string(std::size_t item, std::size_t worker)>& make,
                const std::function<void(std::size_t item, std::string bytes)>& take, const Progress& progress = {});

/// Runs the blocks of a comparison, each at one of the ranks, or all here where there are none, and gives them to
/// `take` at rank 0 in their order. progress: of the runs that rank 0 has from all.
void run_blocks(ComparisonRuns& runs, Ranks* ranks, const Progress& progress,
                const std::function<void(std::size_t block, std::string_view bytes)>& take);

}  // namespace truebearing
