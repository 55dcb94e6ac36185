// SPDX-License-Identifier: Apache-2.0
// What the two trainings with LibTorch share: of the network (recurrent_trainer.cpp) and of its covariance head
// (covariance_head.cpp). The only header of the house with one of LibTorch.
#pragma once

#include <torch/torch.h>

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "training/recurrent_training.hpp"
#include "truebearing/correction/gated_recurrent.hpp"

extern "C" void openblas_set_num_threads(int) __attribute__((weak));

namespace truebearing {

inline constexpr double kLargestGradient = 1.0;  // its norm

/// The rate of learning as a share of its largest, at `progress` in [0, 1): it rises by half a cosine and falls by another.
inline double one_cycle(double progress) {
  constexpr double kWarmUp = 0.3, kFirst = 1.0 / 25.0, kLast = 1e-4;
  const auto between = [](double from, double to, double share) {
    return to + 0.5 * (from - to) * (1.0 + std::cos(std::numbers::pi * share));
  };
  return progress < kWarmUp ? between(kFirst, 1.0, progress / kWarmUp)
                            : between(1.0, kLast, (progress - kWarmUp) / (1.0 - kWarmUp));
}

/// Sums come out the same whatever machine it is: the calling thread works alone.
inline void one_thread_each() {
  at::set_num_threads(1);
  if (openblas_set_num_threads) openblas_set_num_threads(1);
}

/// A tensor of one or two dimensions; the first is down the column.
inline Eigen::MatrixXf matrix(const torch::Tensor& tensor) {
  const torch::Tensor values = tensor.detach().contiguous();
  const auto rows = values.size(0), columns = values.dim() == 2 ? values.size(1) : 1;
  using ByRows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  return Eigen::Map<const ByRows>(values.data_ptr<float>(), rows, columns);
}

/// Teaches the covariance head of a network whose mean has settled: `errors` (n x N) are what that mean leaves at `rows`.
/// Returns the mean of - ln p over the last epoch, without its constant.
double fit_covariance_head(const RecurrentRows& rows, const Eigen::MatrixXf& errors, std::uint64_t seed,
                           const RecurrentProgress& progress, GatedRecurrent::Parameters& parameters);

}  // namespace truebearing
