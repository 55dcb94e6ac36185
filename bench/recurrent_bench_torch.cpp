// SPDX-License-Identifier: Apache-2.0
// The benchmarks of recurrent_bench.cpp with LibTorch's GRUCell, the gates alone, on one thread and without gradients.
#include <torch/torch.h>

#include <benchmark/benchmark.h>

#include "recurrent_bench.hpp"

namespace truebearing::bench {
namespace {

void libtorch_gru_cell(benchmark::State& state) {
  const torch::NoGradGuard guard;
  at::set_num_threads(1);
  torch::nn::GRUCell cell(kFeatures, state.range(0));
  const Eigen::MatrixXf rows = spread(kFeatures, kRows, 1.0);
  const torch::Tensor inputs =
      torch::from_blob(const_cast<float*>(rows.data()), {kRows, 1, kFeatures});  // which only reads them
  torch::Tensor h = torch::zeros({1, state.range(0)});
  std::int64_t row = 0;
  for (auto _ : state) {
    h = cell->forward(inputs[row], h);
    benchmark::DoNotOptimize(h.data_ptr<float>());
    row = (row + 1) % kRows;
  }
}
BENCHMARK(libtorch_gru_cell)->ArgName("units")->Arg(32)->Arg(48);

}  // namespace
}  // namespace truebearing::bench
