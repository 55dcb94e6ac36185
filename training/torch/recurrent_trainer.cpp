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
#include <memory>
#include <numeric>
#include <thread>
#include <utility>
#include <vector>

#include "training/torch/recurrent_trainer.hpp"
#include "truebearing/core/random.hpp"

namespace truebearing {
namespace {

using torch::Tensor;

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

// Both halves of some work, at once where `two_threads`.
void halves(bool two_threads, const std::function<void(int)>& work) {
  if (!two_threads) {
    work(0);
    work(1);
    return;
  }
  std::exception_ptr failure;
  std::jthread other([&] {  // which is waited for where this half throws, too
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

void set(const Tensor& parameter, const Eigen::MatrixXf& values) {
  const torch::NoGradGuard guard;
  Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows = values;
  parameter.copy_(torch::from_blob(rows.data(), parameter.sizes()));
}

void set(const std::vector<Tensor>& parameters, const std::vector<Eigen::MatrixXf>& values) {
  for (std::size_t i = 0; i < parameters.size(); ++i) set(parameters[i], values[i]);
}

std::unique_ptr<torch::optim::OptimizerParamState>& remembered(torch::optim::Adam& adam, const Tensor& parameter) {
  return adam.state()[c10::guts::to_string(parameter.unsafeGetTensorImpl())];
}

RecurrentState state_of(const Net& net, torch::optim::Adam& adam, const GatedRecurrent::Parameters& best, int epochs) {
  RecurrentState state{.epochs = epochs,
                       .weights = {},
                       .mean = {},
                       .square = {},
                       .best = {best.encoder_weight, best.encoder_bias, best.weight_ih, best.weight_hh, best.bias_ih,
                                best.bias_hh, best.output_weight, best.output_bias}};
  for (const Tensor& parameter : net.parameters()) {
    const auto& kept = static_cast<const torch::optim::AdamParamState&>(*remembered(adam, parameter));
    state.weights.push_back(matrix(parameter));
    state.mean.push_back(matrix(kept.exp_avg()));
    state.square.push_back(matrix(kept.exp_avg_sq()));
  }
  return state;
}

void go_on(const RecurrentState& begun, std::int64_t steps, const Net& net, torch::optim::Adam& adam) {
  const std::vector<Tensor> parameters = net.parameters();
  set(parameters, begun.weights);
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    auto kept = std::make_unique<torch::optim::AdamParamState>();
    kept->step(steps);
    kept->exp_avg(torch::zeros_like(parameters[i]));
    kept->exp_avg_sq(torch::zeros_like(parameters[i]));
    set(kept->exp_avg(), begun.mean[i]);
    set(kept->exp_avg_sq(), begun.square[i]);
    remembered(adam, parameters[i]) = std::move(kept);
  }
}

double train(const RecurrentRows& training, const RecurrentRows& validation, const RecurrentOptions& options,
             const RecurrentState& begun, const KeepRecurrentState& keep_state, const RecurrentProgress& progress,
             GatedRecurrent::Parameters& best) {
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
  if (begun.epochs > 0) {
    set(parameters, begun.best);
    keep(net, best);
    least = mean_squared_error(net, validation, validated, options.batch / 2, options.two_threads);
    go_on(begun, begun.epochs * static_cast<std::int64_t>(batches), net, adam);
    if (progress) progress(begun.epochs, options.epochs, least);
  }
  for (int epoch = 0; epoch < options.epochs; ++epoch) {
    const bool done_before = epoch < begun.epochs;  // all but its random draws
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
      if (done_before) continue;
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
    if (done_before) continue;
    const double cost = mean_squared_error(net, validation, validated, options.batch / 2, options.two_threads);
    if (cost < least) {
      least = cost;
      keep(net, best);
    }
    if (keep_state && std::isfinite(cost)) keep_state(state_of(net, adam, best, epoch + 1));
    if (progress) progress(epoch + 1, options.epochs, cost);
  }
  return least;
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

}  // namespace
}  // namespace truebearing

extern "C" [[gnu::visibility("default")]] const truebearing::RecurrentModule truebearing_recurrent_module{
    &truebearing::train, &truebearing::fit_covariance_head, &truebearing::answers};
