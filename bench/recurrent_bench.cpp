// SPDX-License-Identifier: Apache-2.0
// One step of a gated recurrent network: the gates, and with them the heads that say correction and covariance. Beside
// it LibTorch's GRUCell in the same run (recurrent_bench_torch.cpp), where it is installed.
//     bench_recurrent --benchmark_repetitions=9 --benchmark_enable_random_interleaving=true
//                     --benchmark_report_aggregates_only=true
#include "recurrent_bench.hpp"

#include <benchmark/benchmark.h>

#include "truebearing/correction/gated_recurrent.hpp"

namespace truebearing::bench {
namespace {

GatedRecurrent network(int units, int encoded) {
  constexpr int kEntries = kOutputs * (kOutputs + 1) / 2;
  GatedRecurrent::Parameters p;
  p.input_mean = Eigen::VectorXd::Zero(kFeatures);
  p.input_scale = Eigen::VectorXd::Ones(kFeatures);
  p.output_scale = Eigen::VectorXd::Ones(kOutputs);
  if (encoded > 0) {
    p.encoder_weight = spread(encoded, kFeatures, 0.5);
    p.encoder_bias = spread(encoded, 1, 0.5);
  }
  p.weight_ih = spread(3 * units, encoded > 0 ? encoded : kFeatures, 0.3);
  p.weight_hh = spread(3 * units, units, 0.3);
  p.bias_ih = spread(3 * units, 1, 0.3);
  p.bias_hh = spread(3 * units, 1, 0.3);
  p.output_weight = spread(kOutputs, units, 0.3);
  p.output_bias = spread(kOutputs, 1, 0.3);
  p.covariance_weight = spread(kEntries, units, 0.1);
  p.covariance_bias = spread(kEntries, 1, 0.1);
  return GatedRecurrent(std::move(p));
}

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
