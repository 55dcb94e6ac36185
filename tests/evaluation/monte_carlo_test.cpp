// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/monte_carlo.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <set>
#include <stdexcept>
#include <vector>

#include "truebearing/core/random.hpp"

namespace truebearing::monte_carlo_test {
namespace {

TEST(MonteCarlo, EveryRunIsDoneOnce) {
  for (const int threads : {0, 1, 2, 8}) {
    std::vector<std::atomic<int>> done(1000);
    monte_carlo(done.size(), threads, [&](std::size_t run, std::size_t worker) {
      EXPECT_LT(worker, worker_count(threads));
      ++done[run];
    });
    for (const std::atomic<int>& count : done) ASSERT_EQ(count, 1) << threads;
  }
}

TEST(MonteCarlo, NoRunsAreNoWork) {
  monte_carlo(0, 4, [](std::size_t, std::size_t) { FAIL(); });
}

TEST(MonteCarlo, StateOfAWorkerIsNeverSharedAtOnce) {
  std::vector<std::atomic<int>> inside(worker_count(8));
  monte_carlo(400, 8, [&](std::size_t, std::size_t worker) {
    EXPECT_EQ(inside[worker].fetch_add(1), 0);
    inside[worker].fetch_sub(1);
  });
}

TEST(MonteCarlo, ResultsDoNotDependOnTheThreads) {
  const auto results = [](int threads) {
    std::vector<double> values(300);
    monte_carlo(values.size(), threads, [&](std::size_t run, std::size_t) {
      RandomStream random({.seed = 1, .role = Role::evaluation, .run = run}, StreamId::test);
      for (int k = 0; k < 100; ++k) values[run] += random.normal();
    });
    return values;
  };
  EXPECT_EQ(results(1), results(2));
  EXPECT_EQ(results(1), results(8));
}

TEST(MonteCarlo, ExceptionStopsTheRestAndComesThrough) {
  for (const int threads : {1, 4}) {
    std::atomic<int> done{0};
    const auto body = [&](std::size_t run, std::size_t) {
      if (run == 10) throw std::runtime_error("run 10");
      ++done;
    };
    EXPECT_THROW(monte_carlo(1000000, threads, body), std::runtime_error) << threads;
    EXPECT_LT(done, 1000000) << threads;
  }
}

TEST(MonteCarlo, ProgressCountsEveryRun) {
  std::vector<std::size_t> seen;
  monte_carlo(
      50, 4, [](std::size_t, std::size_t) {},
      [&](std::size_t done, std::size_t total) {
        EXPECT_EQ(total, 50u);
        seen.push_back(done);
      });
  ASSERT_EQ(seen.size(), 50u);
  for (std::size_t i = 0; i < seen.size(); ++i) EXPECT_EQ(seen[i], i + 1);
}

}  // namespace
}  // namespace truebearing::monte_carlo_test
