// SPDX-License-Identifier: Apache-2.0
// Training of gated recurrent networks: the data as the network sees them, and the way to LibTorch, which does the work in
// a module of its own that is loaded when it is wanted (torch/). Nothing else of the house knows LibTorch.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "truebearing/correction/gated_recurrent.hpp"

namespace truebearing {

/// N rows of tracks, one track behind the other; d inputs, n outputs.
struct RecurrentRows {
  Eigen::MatrixXf inputs;      ///< (d x N), standardised and clipped
  Eigen::MatrixXf targets;     ///< (n x N), in units of the output's scale
  std::vector<bool> begins;    ///< (N), the first row of a track
  std::vector<bool> taught;    ///< (N), a row without a target is not
  std::vector<bool> used;      ///< (N), a row that the network remembers
  Eigen::VectorXf parity;      ///< (d), +-1 of a mirrored target; empty: mirror images are not taught
  Eigen::VectorXf out_parity;  ///< (n)
};

struct RecurrentOptions {
  int units = 48;  ///< also of the encoder
  int epochs = 40;
  int batch = 128;              ///< tracks
  double learning_rate = 4e-3;  ///< the highest, of one cycle
  std::uint64_t seed = 1;
  bool two_threads = true;  ///< the answer is the same with one
};

/// Called after each epoch with its number from 1, their total, and the mean squared error of the validation's rows.
using RecurrentProgress = std::function<void(int epoch, int total, double cost)>;

/// Where a training stands between two epochs: encoder, gates and output in the order of GatedRecurrent::Parameters, and
/// of each what Adam remembers. The random draws are made again, the cost of the best epoch is measured again.
struct RecurrentState {
  int epochs = 0;  ///< done; 0: not begun
  std::vector<Eigen::MatrixXf> weights, mean, square, best;
};
/// Called after each epoch whose cost is a number; may be empty.
using KeepRecurrentState = std::function<void(const RecurrentState& state)>;

/// What the module exports, under kRecurrentTrainer: fits encoder, gates and output of `parameters` by truncated
/// back-propagation, Adam and a one-cycle rate, and keeps the epoch that was best on the validation's rows. Returns their
/// mean squared error. The same for the same rows and options, to the bit, whether it goes on from `begun` or begins.
using RecurrentTrainer = double(const RecurrentRows& training, const RecurrentRows& validation,
                                const RecurrentOptions& options, const RecurrentState& begun,
                                const KeepRecurrentState& keep, const RecurrentProgress& progress,
                                GatedRecurrent::Parameters& parameters);
/// Fits the covariance head of `parameters`, whose other layers stay, to errors (n x N, in standard deviations) by their
/// Gaussian likelihood. Returns its mean per row.
using CovarianceTrainer = double(const RecurrentRows& rows, const Eigen::MatrixXf& errors, std::uint64_t seed,
                                 const RecurrentProgress& progress, GatedRecurrent::Parameters& parameters);

/// What LibTorch's own layers answer to the rows of one track, inputs (d x N) standardised: (n x N), in units of the
/// output's scale. For tests that hold the run-time network to it.
using RecurrentAnswers = Eigen::MatrixXf(const GatedRecurrent::Parameters& parameters, const Eigen::MatrixXf& inputs);

struct RecurrentModule {
  RecurrentTrainer* train;
  CovarianceTrainer* fit_covariance;
  RecurrentAnswers* answers;
};
/// Loads the module in `folder`; where that is empty, the one that stands beside the program or where it is installed.
/// Throws InputError where there is none.
RecurrentModule recurrent_module(const std::filesystem::path& folder = {});

}  // namespace truebearing
