// SPDX-License-Identifier: Apache-2.0
// Monte Carlo runs over threads. A run is a pure function of its number; threads only share out the numbers.
#pragma once

#include <cstddef>
#include <functional>

namespace truebearing {

/// Called with (runs done, runs in all), from one thread at a time. May be empty.
using Progress = std::function<void(std::size_t, std::size_t)>;

/// Calls body(run, worker) once for every run in [0, runs), on at most `threads` threads (0: one per core). Of two
/// calls with the same worker number, in [0, worker_count(threads)), one ends before the other begins: state may be
/// kept per worker. An exception in a body stops the rest and is thrown on.
void monte_carlo(std::size_t runs, int threads, const std::function<void(std::size_t run, std::size_t worker)>& body,
                 const Progress& progress = {});

std::size_t worker_count(int threads);

/// How many runs a worker should make together, side by side in the lanes of registers (tracker_pack.hpp): 1 to
/// kPackLanes, so many that each worker has two turns at least. It depends on the machine, and decides who makes a run and
/// when, never what is made.
std::size_t runs_together(std::size_t runs, int threads);

/// monte_carlo() in groups of runs, [first, first + count): `together`, of which the last may have fewer. Progress is of
/// runs.
void monte_carlo_together(std::size_t runs, std::size_t together, int threads,
                          const std::function<void(std::size_t first, std::size_t count, std::size_t worker)>& body,
                          const Progress& progress = {});

}  // namespace truebearing
