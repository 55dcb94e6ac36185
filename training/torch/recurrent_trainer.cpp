// SPDX-License-Identifier: Apache-2.0
// Back-propagation through time with LibTorch. A batch is a number of tracks. Of each, the rows that the network
// remembers make one sequence, and those that it does not (no measurement was used) are asked afterwards, each from the
// memory that the last of the others left: as at run time. A batch is halved, and the halves are added, so that one
// thread and two give the same bits.
#include <torch/torch.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <thread>
#include <utility>
#include <vector>

#include "training/recurrent_training.hpp"
#include "truebearing/core/random.hpp"

extern "C" void openblas_set_num_threads(int) __attribute__((weak));

namespace truebearing {
namespace {

using torch::Tensor;

constexpr double kLargestGradient = 1.0;  // its norm
constexpr double kWarmUp = 0.3, kFirstRate = 1.0 / 25.0, kLastRate = 1e-4;

struct Net {
  torch::nn::Linear encoder;
  torch::nn::GRU gru;
  torch::nn::Linear output;

  Net(int inputs, int units, int outputs)
      : encoder(inputs, units), gru(torch::nn::GRUOptions(units, units)), output(units, outputs) {}

  std::vector<Tensor> parameters() const {
    std::vector<Tensor> all = encoder->parameters();
    for (const Tensor& parameter : gru->parameters()) all.push_back(parameter);
    for (const Tensor& parameter : output->parameters()) all.push_back(parameter);
    return all;
  }
};

struct TrackRows {
  Eigen::Index begin, end;
};

std::vector<TrackRows> tracks_of(const RecurrentRows& rows) {
  std::vector<TrackRows> tracks;
  for (Eigen::Index row = 0; row < rows.inputs.cols(); ++row) {
    if (rows.begins[static_cast<std::size_t>(row)]) tracks.push_back({row, row});
    tracks.back().end = row + 1;
  }
  return tracks;
}

// Some tracks as tensors: the sequences (T x B x d) with targets (T x B x n) and weights (T x B x 1), and the rows that
// are not remembered (K x ...) with the place of the memory before them among (T + 1) B.
struct Batch {
  Tensor inputs, targets, weights;
  Tensor lone_inputs, lone_targets, lone_weights, lone_places;
  double taught = 0.0;
};

Batch batch_of(const RecurrentRows& rows, const std::vector<TrackRows>& tracks, const std::vector<std::size_t>& chosen,
               const std::vector<bool>& mirrored) {
  const auto d = rows.inputs.rows(), n = rows.targets.rows();
  const auto B = static_cast<std::int64_t>(chosen.size());
  std::int64_t T = 1, K = 0;
  for (const std::size_t track : chosen) {
    std::int64_t used = 0;
    for (Eigen::Index row = tracks[track].begin; row < tracks[track].end; ++row)
      used += rows.used[static_cast<std::size_t>(row)];
    T = std::max(T, used);
    K += tracks[track].end - tracks[track].begin - used;
  }
  Batch batch;
  batch.inputs = torch::zeros({T, B, d});
  batch.targets = torch::zeros({T, B, n});
  batch.weights = torch::zeros({T, B, 1});
  batch.lone_inputs = torch::zeros({K, d});
  batch.lone_targets = torch::zeros({K, n});
  batch.lone_weights = torch::zeros({K, 1});
  batch.lone_places = torch::zeros({K}, torch::kLong);
  std::int64_t k = 0;
  for (std::int64_t b = 0; b < B; ++b) {
    const TrackRows& track = tracks[chosen[static_cast<std::size_t>(b)]];
    const bool mirror = mirrored[static_cast<std::size_t>(b)];
    std::int64_t t = 0;
    for (Eigen::Index row = track.begin; row < track.end; ++row) {
      const bool used = rows.used[static_cast<std::size_t>(row)], taught = rows.taught[static_cast<std::size_t>(row)];
      const std::int64_t place = used ? t * B + b : k;
      float* const input = (used ? batch.inputs : batch.lone_inputs).data_ptr<float>() + place * d;
      float* const target = (used ? batch.targets : batch.lone_targets).data_ptr<float>() + place * n;
      for (Eigen::Index i = 0; i < d; ++i) input[i] = rows.inputs(i, row) * (mirror ? rows.parity[i] : 1.0F);
      for (Eigen::Index i = 0; i < n; ++i) target[i] = rows.targets(i, row) * (mirror ? rows.out_parity[i] : 1.0F);
      (used ? batch.weights : batch.lone_weights).data_ptr<float>()[place] = taught ? 1.0F : 0.0F;
      batch.taught += taught;
      if (used)
        ++t;
      else
        batch.lone_places.data_ptr<std::int64_t>()[k++] = t * B + b;
    }
  }
  return batch;
}

// The sum over a batch of squared differences from the targets.
Tensor squared_errors(const Net& net, const Batch& batch) {
  torch::nn::Linear encoder = net.encoder, output = net.output;
  torch::nn::GRU gru = net.gru;
  const Tensor h = std::get<0>(gru->forward(torch::tanh(encoder->forward(batch.inputs))));
  Tensor sum = (batch.weights * (output->forward(h) - batch.targets).square()).sum();
  if (batch.lone_places.size(0) > 0) {
    const Tensor before = torch::cat({torch::zeros({1, h.size(1), h.size(2)}), h}).reshape({-1, h.size(2)});
    const std::vector<Tensor> w = gru->parameters();
    const Tensor lone = torch::gru_cell(torch::tanh(encoder->forward(batch.lone_inputs)),
                                        before.index_select(0, batch.lone_places), w[0], w[1], w[2], w[3]);
    sum = sum + (batch.lone_weights * (output->forward(lone) - batch.lone_targets).square()).sum();
  }
  return sum;
}

double one_cycle(double progress) {
  const auto between = [](double from, double to, double share) {
    return to + 0.5 * (from - to) * (1.0 + std::cos(M_PI * share));
  };
  return progress < kWarmUp ? between(kFirstRate, 1.0, progress / kWarmUp)
                            : between(1.0, kLastRate, (progress - kWarmUp) / (1.0 - kWarmUp));
}

void one_thread_each() {
  at::set_num_threads(1);
  if (openblas_set_num_threads) openblas_set_num_threads(1);
}

// Both halves of some work, at once where `two_threads`.
void halves(bool two_threads, const std::function<void(int)>& work) {
  if (!two_threads) {
    work(0);
    work(1);
    return;
  }
  std::exception_ptr failure;
  std::thread other([&] {
    try {
      one_thread_each();
      work(1);
    } catch (...) {
      failure = std::current_exception();
    }
  });
  work(0);
  other.join();
  if (failure) std::rethrow_exception(failure);
}

double mean_squared_error(const Net& net, const RecurrentRows& rows, const std::vector<TrackRows>& tracks, int size,
                          bool two_threads) {
  std::array<double, 2> sums{}, taught{};
  halves(two_threads, [&](int half) {
    const torch::NoGradGuard guard;
    const std::size_t middle = tracks.size() / 2;
    const std::size_t first = half == 0 ? 0 : middle, last = half == 0 ? middle : tracks.size();
    for (std::size_t begin = first; begin < last; begin += static_cast<std::size_t>(size)) {
      std::vector<std::size_t> chosen(std::min<std::size_t>(static_cast<std::size_t>(size), last - begin));
      std::iota(chosen.begin(), chosen.end(), begin);
      const Batch batch = batch_of(rows, tracks, chosen, std::vector<bool>(chosen.size()));
      sums[static_cast<std::size_t>(half)] += squared_errors(net, batch).item<double>();
      taught[static_cast<std::size_t>(half)] += batch.taught;
    }
  });
  return (sums[0] + sums[1]) / ((taught[0] + taught[1]) * static_cast<double>(rows.targets.rows()));
}

Eigen::MatrixXf matrix(const Tensor& tensor) {
  const Tensor values = tensor.detach().contiguous();
  const auto rows = values.size(0), columns = values.dim() == 2 ? values.size(1) : 1;
  using ByRows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  return Eigen::Map<const ByRows>(values.data_ptr<float>(), rows, columns);
}

void keep(const Net& net, GatedRecurrent::Parameters& parameters) {
  parameters.encoder_weight = matrix(net.encoder->weight);
  parameters.encoder_bias = matrix(net.encoder->bias);
  const std::vector<Tensor> gru = net.gru->parameters();  // weight_ih, weight_hh, bias_ih, bias_hh
  parameters.weight_ih = matrix(gru[0]);
  parameters.weight_hh = matrix(gru[1]);
  parameters.bias_ih = matrix(gru[2]);
  parameters.bias_hh = matrix(gru[3]);
  parameters.output_weight = matrix(net.output->weight);
  parameters.output_bias = matrix(net.output->bias);
}

double train(const RecurrentRows& training, const RecurrentRows& validation, const RecurrentOptions& options,
             const RecurrentProgress& progress, GatedRecurrent::Parameters& best) {
  one_thread_each();
  torch::manual_seed(options.seed);
  RandomStream random({.seed = options.seed, .role = Role::training, .run = 0}, StreamId::learning);
  const auto n = training.targets.rows();
  const Net net(static_cast<int>(training.inputs.rows()), options.units, static_cast<int>(n));
  const std::vector<Tensor> parameters = net.parameters();
  torch::optim::Adam adam(parameters, torch::optim::AdamOptions(options.learning_rate));
  const std::vector<TrackRows> tracks = tracks_of(training), validated = tracks_of(validation);
  const auto size = static_cast<std::size_t>(options.batch);
  const std::size_t batches = (tracks.size() + size - 1) / size;
  std::vector<std::size_t> order(tracks.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  double least = std::numeric_limits<double>::infinity();
  for (int epoch = 0; epoch < options.epochs; ++epoch) {
    for (std::size_t i = order.size(); i > 1; --i)
      std::swap(order[i - 1], order[static_cast<std::size_t>(random.uniform() * static_cast<double>(i))]);
    for (std::size_t b = 0; b < batches; ++b) {
      const std::size_t first = b * size, last = std::min(first + size, order.size()), middle = (first + last) / 2;
      std::array<std::vector<std::size_t>, 2> chosen{
          std::vector<std::size_t>(order.begin() + static_cast<std::ptrdiff_t>(first),
                                   order.begin() + static_cast<std::ptrdiff_t>(middle)),
          std::vector<std::size_t>(order.begin() + static_cast<std::ptrdiff_t>(middle),
                                   order.begin() + static_cast<std::ptrdiff_t>(last))};
      std::array<std::vector<bool>, 2> mirrored;
      for (std::size_t half = 0; half < 2; ++half)
        for (std::size_t k = 0; k < chosen[half].size(); ++k)
          mirrored[half].push_back(training.parity.size() > 0 && random.uniform() < 0.5);
      std::array<std::vector<Tensor>, 2> gradients;
      std::array<double, 2> taught{};
      halves(options.two_threads, [&](int half) {
        const auto i = static_cast<std::size_t>(half);
        if (chosen[i].empty()) return;
        const Batch batch = batch_of(training, tracks, chosen[i], mirrored[i]);
        taught[i] = batch.taught;
        gradients[i] = torch::autograd::grad({squared_errors(net, batch)}, parameters);
      });
      const double count = std::max(1.0, taught[0] + taught[1]) * static_cast<double>(n);
      for (std::size_t i = 0; i < parameters.size(); ++i) {
        Tensor sum = gradients[1].empty() ? torch::zeros_like(parameters[i]) : gradients[1][i];
        if (!gradients[0].empty()) sum = gradients[0][i] + sum;
        parameters[i].mutable_grad() = sum / count;
      }
      torch::nn::utils::clip_grad_norm_(parameters, kLargestGradient);
      const double done = static_cast<double>(static_cast<std::size_t>(epoch) * batches + b) /
                          static_cast<double>(static_cast<std::size_t>(options.epochs) * batches);
      static_cast<torch::optim::AdamOptions&>(adam.param_groups()[0].options())
          .lr(options.learning_rate * one_cycle(done));
      adam.step();
    }
    const double cost = mean_squared_error(net, validation, validated, options.batch / 2, options.two_threads);
    if (cost < least) {
      least = cost;
      keep(net, best);
    }
    if (progress) progress(epoch + 1, options.epochs, cost);
  }
  return least;
}

void set(const Tensor& parameter, const Eigen::MatrixXf& values) {
  const torch::NoGradGuard guard;
  Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows = values;
  parameter.copy_(torch::from_blob(rows.data(), parameter.sizes()));
}

Eigen::MatrixXf answers(const GatedRecurrent::Parameters& parameters, const Eigen::MatrixXf& inputs) {
  const torch::NoGradGuard guard;
  const auto units = static_cast<int>(parameters.weight_hh.cols());
  const bool encodes = parameters.encoder_weight.size() > 0;
  torch::nn::GRU gru(torch::nn::GRUOptions(parameters.weight_ih.cols(), units));
  torch::nn::Linear output(units, parameters.output_weight.rows());
  const std::vector<Tensor> w = gru->parameters();
  set(w[0], parameters.weight_ih);
  set(w[1], parameters.weight_hh);
  set(w[2], parameters.bias_ih);
  set(w[3], parameters.bias_hh);
  set(output->weight, parameters.output_weight);
  set(output->bias, parameters.output_bias);
  Eigen::MatrixXf columns = inputs;  // a row of the track to a column: by rows, (N x d)
  Tensor x = torch::from_blob(columns.data(), {inputs.cols(), 1, inputs.rows()});
  if (encodes) {
    torch::nn::Linear encoder(inputs.rows(), parameters.encoder_weight.rows());
    set(encoder->weight, parameters.encoder_weight);
    set(encoder->bias, parameters.encoder_bias);
    x = torch::tanh(encoder->forward(x));
  }
  return matrix(output->forward(std::get<0>(gru->forward(x))).squeeze(1)).transpose();
}

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

double fit_covariance(const RecurrentRows& rows, const Eigen::MatrixXf& errors, std::uint64_t seed,
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
  // - ln of the Gaussian density of e under C C', without its constant: sum ln C_ii + |C^-1 e|^2 / 2, by substitution.
  const auto cost = [&](const Tensor& memories, const Tensor& found) {
    const Tensor c = head->forward(memories);
    std::vector<Tensor> whitened;
    Tensor sum = torch::zeros({memories.size(0)});
    for (std::int64_t i = 0; i < n; ++i) {
      Tensor rest = found.select(1, i);
      for (std::int64_t j = 0; j < i; ++j)
        rest = rest - c.select(1, i * (i + 1) / 2 + j) * whitened[static_cast<std::size_t>(j)];
      const Tensor logarithm = c.select(1, i * (i + 1) / 2 + i).clamp(-20.0, 20.0);
      whitened.push_back(rest * torch::exp(-logarithm));
      sum = sum + logarithm + 0.5 * whitened.back().square();
    }
    return sum.mean();
  };
  double mean = 0.0;
  const std::int64_t batches = (h.size(0) + kRows - 1) / kRows;
  const auto epochs = static_cast<int>(std::max<std::int64_t>(kLeastEpochs, (kLeastSteps + batches - 1) / batches));
  for (int epoch = 0; epoch < epochs; ++epoch) {
    const Tensor order = torch::randperm(h.size(0));
    mean = 0.0;
    for (std::int64_t b = 0; b < batches; ++b) {
      const Tensor chosen = order.slice(0, b * kRows, std::min<std::int64_t>((b + 1) * kRows, h.size(0)));
      const Tensor batch = cost(h.index_select(0, chosen), e.index_select(0, chosen));
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

}  // namespace
}  // namespace truebearing

extern "C" [[gnu::visibility("default")]] const truebearing::RecurrentModule truebearing_recurrent_module{
    &truebearing::train, &truebearing::fit_covariance, &truebearing::answers};
