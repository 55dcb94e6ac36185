// SPDX-License-Identifier: Apache-2.0
// The covariance head of a recurrent network: the Cholesky factor of what its mean leaves, by the Gaussian likelihood.
#include <algorithm>
#include <vector>

#include "training/torch/recurrent_trainer.hpp"
#include "truebearing/correction/network_answer.hpp"

namespace truebearing {
namespace {

using torch::Tensor;

// The hidden states (H x N) of a network at the taught rows, of tracks or their mirror images.
Eigen::MatrixXf hidden_states(const RecurrentRows& rows, const GatedRecurrent::Parameters& parameters, bool mirror,
                              Eigen::Index count) {
  GatedRecurrent::Parameters raw = parameters;  // for inputs that are standardised already
  raw.input_mean.setZero();
  raw.input_scale.setOnes();
  raw.input_clip = 1e6;
  const Eigen::Index n = raw.output_scale.size(), entries = n * (n + 1) / 2;
  raw.covariance_weight = Eigen::MatrixXf::Zero(entries, raw.weight_hh.cols());  // which is what is sought
  raw.covariance_bias = Eigen::VectorXf::Zero(entries);
  const GatedRecurrent network(raw);
  Eigen::MatrixXf states(network.memory(), count);
  NetworkMemory kept = NetworkMemory::Zero(network.memory()), memory;
  NetworkAnswer answer;
  Eigen::Index next = 0;
  for (Eigen::Index row = 0; row < rows.inputs.cols(); ++row) {
    const auto i = static_cast<std::size_t>(row);
    if (rows.begins[i]) kept.setZero();
    memory = kept;
    Eigen::VectorXf inputs = rows.inputs.col(row);
    if (mirror) inputs = inputs.cwiseProduct(rows.parity);
    network.answer(inputs.cast<double>(), memory, answer);
    if (rows.used[i]) kept = memory;
    if (rows.taught[i]) states.col(next++) = memory;
  }
  return states;
}

// - ln of the Gaussian density of e (N x n) under C C', its mean without the constant: sum ln C_ii + |C^-1 e|^2 / 2, by
// substitution. `factor` (N x n (n + 1) / 2) has the rows of C, ln C_ii on its diagonal.
Tensor negative_log_likelihood(const Tensor& factor, const Tensor& errors) {
  std::vector<Tensor> whitened;
  Tensor sum = torch::zeros({errors.size(0)});
  for (std::int64_t i = 0; i < errors.size(1); ++i) {
    Tensor rest = errors.select(1, i);
    for (std::int64_t j = 0; j < i; ++j)
      rest = rest - factor.select(1, i * (i + 1) / 2 + j) * whitened[static_cast<std::size_t>(j)];
    const Tensor logarithm = factor.select(1, i * (i + 1) / 2 + i).clamp(-20.0, 20.0);
    whitened.push_back(rest * torch::exp(-logarithm));
    sum = sum + logarithm + 0.5 * whitened.back().square();
  }
  return sum.mean();
}

}  // namespace

double fit_covariance_head(const RecurrentRows& rows, const Eigen::MatrixXf& errors, std::uint64_t seed,
                           const RecurrentProgress& progress, GatedRecurrent::Parameters& parameters) {
  constexpr int kLeastEpochs = 8, kLeastSteps = 400, kRows = 4096;
  constexpr double kRate = 0.01;
  one_thread_each();
  torch::manual_seed(seed);
  const auto n = errors.rows(), H = parameters.weight_hh.cols(), entries = n * (n + 1) / 2;
  Eigen::Index count = 0;
  for (const bool taught : rows.taught) count += taught;
  const bool mirrors = rows.parity.size() > 0;
  std::vector<Tensor> states, targets;
  Eigen::MatrixXf taught(n, count);
  Eigen::Index next = 0;
  for (Eigen::Index row = 0; row < errors.cols(); ++row)
    if (rows.taught[static_cast<std::size_t>(row)]) taught.col(next++) = errors.col(row);
  for (const bool mirror : {false, true}) {
    if (mirror && !mirrors) continue;
    Eigen::MatrixXf h = hidden_states(rows, parameters, mirror, count);
    Eigen::MatrixXf e = mirror ? Eigen::MatrixXf(rows.out_parity.asDiagonal() * taught) : taught;
    states.push_back(torch::from_blob(h.data(), {count, H}).clone());
    targets.push_back(torch::from_blob(e.data(), {count, n}).clone());
  }
  const Tensor h = torch::cat(states), e = torch::cat(targets);
  torch::nn::Linear head(H, entries);
  {
    const torch::NoGradGuard guard;
    head->weight.zero_();
    head->bias.zero_();
    const Tensor deviation = e.square().mean(0).sqrt().clamp_min(1e-6);
    for (std::int64_t i = 0; i < n; ++i) head->bias[i * (i + 1) / 2 + i] = deviation[i].log();
  }
  torch::optim::Adam adam(head->parameters(), torch::optim::AdamOptions(kRate));
  double mean = 0.0;
  const std::int64_t batches = (h.size(0) + kRows - 1) / kRows;
  const auto epochs = static_cast<int>(std::max<std::int64_t>(kLeastEpochs, (kLeastSteps + batches - 1) / batches));
  for (int epoch = 0; epoch < epochs; ++epoch) {
    const Tensor order = torch::randperm(h.size(0));
    mean = 0.0;
    for (std::int64_t b = 0; b < batches; ++b) {
      const Tensor chosen = order.slice(0, b * kRows, std::min<std::int64_t>((b + 1) * kRows, h.size(0)));
      const Tensor batch = negative_log_likelihood(head->forward(h.index_select(0, chosen)), e.index_select(0, chosen));
      adam.zero_grad();
      batch.backward();
      torch::nn::utils::clip_grad_norm_(head->parameters(), kLargestGradient);
      static_cast<torch::optim::AdamOptions&>(adam.param_groups()[0].options())
          .lr(kRate * one_cycle(static_cast<double>(epoch * batches + b) / static_cast<double>(epochs * batches)));
      adam.step();
      mean += batch.item<double>() / static_cast<double>(batches);
    }
    if (progress) progress(epoch + 1, epochs, mean);
  }
  parameters.covariance_weight = matrix(head->weight);
  parameters.covariance_bias = matrix(head->bias);
  return mean;
}

}  // namespace truebearing
