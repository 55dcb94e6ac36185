// SPDX-License-Identifier: Apache-2.0
// One step of a gated recurrent network: the gates, and with them the heads that say correction and covariance. Beside
// it LibTorch's GRUCell in the same run (recurrent_bench_torch.cpp), where it is installed.
//     bench_recurrent --benchmark_repetitions=9 --benchmark_enable_random_interleaving=true
//                     --benchmark_report_aggregates_only=true
#include "recurrent_bench.hpp"

#include <benchmark/benchmark.h>

namespace truebearing::bench {
namespace {

void gru(benchmark::State& state) {
  const GatedRecurrent asked = network(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  const Eigen::MatrixXd rows = spread(kFeatures, kRows, 1.0).cast<double>();
  NetworkMemory h = NetworkMemory::Zero(asked.memory());
  NetworkAnswer answer;
  Eigen::Index row = 0;
  for (auto _ : state) {
    asked.answer(rows.col(row), h, answer);
    benchmark::DoNotOptimize(answer.y[0]);
    row = (row + 1) % kRows;
  }
}
BENCHMARK(gru)->ArgNames({"units", "encoder"})->Args({32, 0})->Args({48, 0})->Args({48, 48})->Args({64, 64});

}  // namespace
}  // namespace truebearing::bench
