// SPDX-License-Identifier: Apache-2.0
#include "training/recurrent_checkpoint.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <utility>

#include "truebearing/core/content_hash.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/io/file.hpp"
#include "truebearing/io/safetensors.hpp"

namespace truebearing {
namespace {

constexpr const char* kBelongsTo = "belongs_to";
constexpr const char* kEpochs = "epochs";
constexpr std::uint64_t kVersion = 1;  // of the training: what another one began cannot be gone on with

class Hash {
 public:
  void take(std::uint64_t value) { hash_.take(value); }
  void take(const auto& matrix) {
    take(static_cast<std::uint64_t>(matrix.rows()));
    for (const float value : matrix.reshaped()) take(std::uint64_t{std::bit_cast<std::uint32_t>(value)});
  }
  void take(const std::vector<bool>& values) {
    for (const bool value : values) take(std::uint64_t{value});
  }
  void take(const RecurrentRows& rows) {
    take(rows.inputs);
    take(rows.targets);
    take(rows.begins);
    take(rows.taught);
    take(rows.used);
    take(rows.parity);
    take(rows.out_parity);
  }
  // The upper half of a product is the better mixed one.
  Eigen::Vector4f parts() const {
    const std::uint64_t mixed = hash_.value() ^ (hash_.value() >> 32);
    Eigen::Vector4f parts;
    for (unsigned i = 0; i < 4; ++i) parts[i] = static_cast<float>((mixed >> (16 * i)) & 0xffffU);
    return parts;
  }

 private:
  ContentHash hash_;
};

const std::pair<const char*, std::vector<Eigen::MatrixXf> RecurrentState::*> kParts[] = {
    {"weights", &RecurrentState::weights},
    {"mean", &RecurrentState::mean},
    {"square", &RecurrentState::square},
    {"best", &RecurrentState::best}};

}  // namespace

RecurrentCheckpoint::RecurrentCheckpoint(std::filesystem::path path, const RecurrentRows& training,
                                         const RecurrentRows& validation, const RecurrentOptions& options)
    : path_(std::move(path)), epochs_(options.epochs) {
  const Eigen::Index d = training.inputs.rows(), n = training.targets.rows(), H = options.units;
  layers_ = {{{"encoder.weight", H, d},
              {"encoder.bias", H, 1},
              {"gru.weight_ih_l0", 3 * H, H},
              {"gru.weight_hh_l0", 3 * H, H},
              {"gru.bias_ih_l0", 3 * H, 1},
              {"gru.bias_hh_l0", 3 * H, 1},
              {"output.weight", n, H},
              {"output.bias", n, 1}}};
  if (path_.empty()) return;
  Hash hash;
  for (const std::uint64_t option :
       {kVersion, static_cast<std::uint64_t>(options.units), static_cast<std::uint64_t>(options.epochs),
        static_cast<std::uint64_t>(options.batch), std::bit_cast<std::uint64_t>(options.learning_rate), options.seed})
    hash.take(option);
  hash.take(training);
  hash.take(validation);
  belongs_to_ = hash.parts();
}

RecurrentState RecurrentCheckpoint::read() const {
  RecurrentState state;
  std::error_code unknown;
  if (path_.empty() || !std::filesystem::exists(path_, unknown)) return state;
  const Tensors tensors = parse_safetensors(read_text_file(path_, TensorLimits{}.max_bytes), path_.string());
  const auto array = [&](const std::string& name, Eigen::Index rows, Eigen::Index columns) -> const Eigen::MatrixXf& {
    const auto found = tensors.find(name);
    if (found == tensors.end() || found->second.values.rows() != rows || found->second.values.cols() != columns)
      throw InputError(path_.string(), fmt::format("holds no {} of {} x {}", name, rows, columns),
                       "what `truebearing train` wrote; remove it to begin afresh");
    return found->second.values;
  };
  if (array(kBelongsTo, 4, 1) != belongs_to_)
    throw InputError(path_.string(), "was begun by another study, with other keys or with another seed",
                     "the same again; remove it to begin afresh");
  const float epochs = array(kEpochs, 1, 1)(0, 0);
  if (!(epochs >= 1.0F && epochs <= static_cast<float>(epochs_) && epochs == std::floor(epochs)))
    throw InputError(path_.string(), fmt::format("has done {} epochs", epochs), fmt::format("1 to {}", epochs_));
  state.epochs = static_cast<int>(epochs);
  for (const auto& [part, member] : kParts)
    for (const Layer& layer : layers_)
      (state.*member).push_back(array(fmt::format("{}.{}", part, layer.name), layer.rows, layer.columns));
  return state;
}

void RecurrentCheckpoint::write(const RecurrentState& state) const {
  if (path_.empty()) return;
  Tensors tensors;
  tensors[kBelongsTo] = {belongs_to_};
  tensors[kEpochs] = {Eigen::MatrixXf::Constant(1, 1, static_cast<float>(state.epochs))};
  for (const auto& [part, member] : kParts)
    for (std::size_t i = 0; i < layers_.size(); ++i)
      tensors[fmt::format("{}.{}", part, layers_[i].name)] = {(state.*member)[i]};
  write_file_atomically(path_, safetensors_bytes(tensors));
}

}  // namespace truebearing
