// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/gated_recurrent.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <string>
#include <utility>

#include "truebearing/core/error.hpp"
#include "truebearing/correction/gated_recurrent_kernel.hpp"

namespace truebearing {
namespace {

constexpr int kMostCovarianceEntries = kMaxDimension * (kMaxDimension + 1) / 2;
constexpr float kLargestLogarithm = 20.0F;  // of a diagonal entry of C

static_assert(kernels::kMostRows >= GatedRecurrent::kMaxUnits);
static_assert(kernels::kMostRows >= kMaxDimension + kMostCovarianceEntries);

int filled_up(Eigen::Index count) {
  return static_cast<int>((count + kernels::kFloatLanes - 1) / kernels::kFloatLanes * kernels::kFloatLanes);
}

void require_shape(const Eigen::MatrixXf& values, const char* name, Eigen::Index rows, Eigen::Index columns) {
  require_valid(values.rows() == rows && values.cols() == columns, name,
                fmt::format("is {} x {}", values.rows(), values.cols()), fmt::format("{} x {}", rows, columns));
  require_valid(values.allFinite(), name, "holds a number that is not finite", "finite numbers");
}

// Blocks of rows (H each) by columns, every block filled up to `rows` rows; columns that fill up are zero.
std::vector<float> by_columns(const Eigen::MatrixXf& A, int blocks, int rows, int columns) {
  std::vector<float> values(static_cast<std::size_t>(blocks * rows * columns), 0.0F);
  const Eigen::Index height = A.rows() / blocks;
  for (Eigen::Index j = 0; j < A.cols(); ++j)
    for (Eigen::Index i = 0; i < A.rows(); ++i)
      values[static_cast<std::size_t>(j * blocks * rows + i / height * rows + i % height)] = A(i, j);
  return values;
}

}  // namespace

GatedRecurrent::GatedRecurrent(Parameters parameters) : parameters_(std::move(parameters)) {
  const Parameters& p = parameters_;
  const Eigen::Index d = p.input_mean.size(), H = p.weight_hh.cols(), n = p.output_scale.size();
  const bool encodes = p.encoder_weight.size() > 0;
  const Eigen::Index e = encodes ? p.encoder_weight.rows() : d;
  require_valid(d >= 1 && d <= kMaxFeatures, "inputs", fmt::format("are {}", d), fmt::format("1 to {}", kMaxFeatures));
  require_valid(H >= 1 && H <= kMaxUnits, "units", fmt::format("are {}", H), fmt::format("1 to {}", kMaxUnits));
  require_valid(e >= 1 && e <= kMaxUnits, "encoder.weight", fmt::format("has {} rows", e),
                fmt::format("1 to {}", kMaxUnits));
  require_valid(n >= 1 && n <= kMaxDimension, "outputs", fmt::format("are {}", n),
                fmt::format("1 to {}", kMaxDimension));
  require_valid(p.input_mean.allFinite() && p.input_scale.size() == d && p.input_scale.allFinite() &&
                    (p.input_scale.array() > 0.0).all() && p.input_clip > 0.0 && std::isfinite(p.input_clip),
                "normalisation", "of the inputs is no mean, scale and clip", fmt::format("{} finite ones, > 0", d));
  require_valid(p.output_scale.allFinite() && (p.output_scale.array() > 0.0).all(), "output_scale", "is not positive",
                "finite numbers > 0");
  require_shape(p.encoder_weight, "encoder.weight", encodes ? e : 0, encodes ? d : 0);
  require_shape(p.encoder_bias, "encoder.bias", encodes ? e : 0, 1);
  require_shape(p.weight_ih, "gru.weight_ih_l0", 3 * H, e);
  require_shape(p.weight_hh, "gru.weight_hh_l0", 3 * H, H);
  require_shape(p.bias_ih, "gru.bias_ih_l0", 3 * H, 1);
  require_shape(p.bias_hh, "gru.bias_hh_l0", 3 * H, 1);
  require_shape(p.output_weight, "output.weight", n, H);
  require_shape(p.output_bias, "output.bias", n, 1);
  require_shape(p.covariance_weight, "covariance.weight", n * (n + 1) / 2, H);
  require_shape(p.covariance_bias, "covariance.bias", n * (n + 1) / 2, 1);
  packed_ = packed(p);
}

GatedRecurrent::Packed GatedRecurrent::packed(const Parameters& p) {
  const Eigen::Index H = p.weight_hh.cols(), n = p.output_weight.rows();
  Packed packed;
  packed.units = filled_up(H);
  packed.encoded = filled_up(p.encoder_weight.rows());
  Eigen::MatrixXf head(n + p.covariance_weight.rows(), H);
  head << p.output_weight, p.covariance_weight;
  Eigen::VectorXf head_bias(head.rows());
  head_bias << p.output_bias, p.covariance_bias;
  packed.heads = filled_up(head.rows());
  if (packed.encoded > 0) {
    packed.encoder = by_columns(p.encoder_weight, 1, packed.encoded, static_cast<int>(p.encoder_weight.cols()));
    packed.encoder_bias = by_columns(p.encoder_bias, 1, packed.encoded, 1);
  }
  packed.input = by_columns(p.weight_ih, 3, packed.units,
                            packed.encoded > 0 ? packed.encoded : static_cast<int>(p.weight_ih.cols()));
  Eigen::VectorXf bias = p.bias_ih;
  bias.head(2 * H) += p.bias_hh.head(2 * H);
  packed.input_bias = by_columns(bias, 3, packed.units, 1);
  packed.hidden = by_columns(p.weight_hh, 3, packed.units, packed.units);
  packed.new_bias = by_columns(p.bias_hh.tail(H), 1, packed.units, 1);
  packed.head = by_columns(head, 1, packed.heads, packed.units);
  packed.head_bias = by_columns(head_bias, 1, packed.heads, 1);
  return packed;
}

void GatedRecurrent::answer(const NetworkInputs& inputs, NetworkMemory& h, NetworkAnswer& answer) const {
  const Eigen::Index n = outputs();
  float u[kMaxFeatures], hidden[kMaxUnits] = {}, heads[kernels::kMostRows];
  bool known = inputs.allFinite();
  for (Eigen::Index i = 0; i < inputs.size(); ++i)
    u[i] = static_cast<float>(std::clamp((inputs[i] - parameters_.input_mean[i]) / parameters_.input_scale[i],
                                         -parameters_.input_clip, parameters_.input_clip));
  if (known) {
    std::copy(h.begin(), h.end(), hidden);
    kernels::gated_recurrent_step({.inputs = static_cast<int>(inputs.size()),
                                   .encoded = packed_.encoded,
                                   .units = packed_.units,
                                   .heads = packed_.heads,
                                   .encoder = packed_.encoder.data(),
                                   .encoder_bias = packed_.encoder_bias.data(),
                                   .input = packed_.input.data(),
                                   .input_bias = packed_.input_bias.data(),
                                   .hidden = packed_.hidden.data(),
                                   .new_bias = packed_.new_bias.data(),
                                   .head = packed_.head.data(),
                                   .head_bias = packed_.head_bias.data()},
                                  u, hidden, heads);
    std::copy_n(hidden, h.size(), h.data());
  } else {
    std::fill(std::begin(heads), std::end(heads), std::numeric_limits<float>::quiet_NaN());
  }
  answer.y.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) answer.y[i] = parameters_.output_scale[i] * static_cast<double>(heads[i]);
  BoundedMatrix C = BoundedMatrix::Zero(n, n);
  const float* c = heads + n;
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < i; ++j) C(i, j) = static_cast<double>(*c++);
    C(i, i) = std::exp(static_cast<double>(std::clamp(*c++, -kLargestLogarithm, kLargestLogarithm)));
  }
  answer.inflation = 1.0;
  answer.moments.noalias() = C.lazyProduct(C.transpose());
}

void GatedRecurrent::check(const CorrectionDesign& design, int state) const {
  require_valid(outputs() == state, "output.weight", fmt::format("gives {} numbers", outputs()),
                fmt::format("{}, one per component of the state", state));
  require_valid(design.covariance_moments, "covariance", "is \"inflation\"", "\"moments\" for a recurrent network");
}

}  // namespace truebearing
