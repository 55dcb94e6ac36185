// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/monte_carlo.hpp"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <thread>

#include "truebearing/filter/lane_mask.hpp"

namespace truebearing {

std::size_t worker_count(int threads) {
  return threads > 0 ? static_cast<std::size_t>(threads) : std::max(1u, std::thread::hardware_concurrency());
}

std::size_t runs_together(std::size_t runs, int threads) {
  constexpr std::size_t kTurnsOfAWorker = 2;
  return std::clamp(runs / (kTurnsOfAWorker * worker_count(threads)), std::size_t{1}, std::size_t{kPackLanes});
}

void monte_carlo_together(std::size_t runs, std::size_t together, int threads,
                          const std::function<void(std::size_t first, std::size_t count, std::size_t worker)>& body,
                          const Progress& progress) {
  std::atomic<std::size_t> done{0};
  Progress of_groups;
  if (progress) of_groups = [&](std::size_t, std::size_t) { progress(done, runs); };
  monte_carlo((runs + together - 1) / together, threads,
              [&](std::size_t group, std::size_t worker) {
                const std::size_t first = group * together, count = std::min(together, runs - first);
                body(first, count, worker);
                done += count;
              },
              of_groups);
}

void monte_carlo(std::size_t runs, int threads, const std::function<void(std::size_t run, std::size_t worker)>& body,
                 const Progress& progress) {
  std::atomic<std::size_t> next{0};
  std::size_t done = 0;
  std::mutex progress_mutex;
  const std::size_t workers = std::min(worker_count(threads), std::max<std::size_t>(runs, 1));
  // More workers than cores take turns: asking TBB for threads that it will not give makes it complain.
  tbb::task_arena arena(std::min(static_cast<int>(workers), tbb::this_task_arena::max_concurrency()));
  arena.execute([&] {
    tbb::parallel_for(
        std::size_t{0}, workers,
        [&](std::size_t worker) {
          for (std::size_t run = next++; run < runs; run = next++) {
            try {
              body(run, worker);
            } catch (...) {
              next = runs;
              throw;
            }
            if (!progress) continue;
            const std::lock_guard lock(progress_mutex);
            progress(++done, runs);
          }
        },
        tbb::simple_partitioner());
  });
}

}  // namespace truebearing
