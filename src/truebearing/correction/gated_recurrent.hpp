// SPDX-License-Identifier: Apache-2.0
// The gated recurrent network (GRU) of Cho et al. 2014 in the form and order of torch.nn.GRU, between two linear layers:
//
//     u  = clip((input - mean) / scale)                       e = tanh(W_e u + b_e), or u where there is no encoder
//     r  = sigma(W_ir e + b_ir + W_hr h + b_hr)               z = sigma(W_iz e + b_iz + W_hz h + b_hz)
//     n  = tanh(W_in e + b_in + r o (W_hn h + b_hn))          h <- (1 - z) o n + z o h
//     y  = output_scale o (W_y h + b_y)                       c = W_c h + b_c
//
// and the covariance is C C' with C lower triangular of the entries c, row by row, its diagonal exp(c). d inputs, e
// encoded, H units, n outputs. In float; the same bits on every processor (gated_recurrent_kernel.cpp).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "truebearing/correction/correction_design.hpp"
#include "truebearing/correction/network_answer.hpp"

namespace truebearing {

class GatedRecurrent {
 public:
  static constexpr int kMaxUnits = kMaxMemory;

  /// Matrices and gate order (r, z, n) as PyTorch keeps them.
  struct Parameters {
    Eigen::VectorXd input_mean;         ///< (d), in the units of the features
    Eigen::VectorXd input_scale;        ///< (d), > 0
    double input_clip = 4.0;            ///< standardised inputs are clipped to +- this
    Eigen::VectorXd output_scale;       ///< (n), > 0, in the units of the outputs
    Eigen::MatrixXf encoder_weight;     ///< (e x d), or empty: e = d
    Eigen::VectorXf encoder_bias;       ///< (e), or empty
    Eigen::MatrixXf weight_ih;          ///< (3H x e)
    Eigen::MatrixXf weight_hh;          ///< (3H x H)
    Eigen::VectorXf bias_ih;            ///< (3H)
    Eigen::VectorXf bias_hh;            ///< (3H)
    Eigen::MatrixXf output_weight;      ///< (n x H)
    Eigen::VectorXf output_bias;        ///< (n)
    Eigen::MatrixXf covariance_weight;  ///< (n (n + 1) / 2 x H)
    Eigen::VectorXf covariance_bias;    ///< (n (n + 1) / 2)
    bool operator==(const Parameters&) const = default;
  };

  GatedRecurrent() = default;
  /// Throws InputError where shapes disagree, sizes pass the maxima, a number is not finite or a scale is not positive.
  explicit GatedRecurrent(Parameters parameters);

  int inputs() const { return static_cast<int>(parameters_.input_mean.size()); }
  int outputs() const { return static_cast<int>(parameters_.output_scale.size()); }
  int memory() const { return static_cast<int>(parameters_.weight_hh.cols()); }  ///< h (H)
  const Parameters& parameters() const { return parameters_; }

  void answer(const NetworkInputs& inputs, NetworkMemory& h, NetworkAnswer& answer) const;
  void check(const CorrectionDesign& design, int state) const;

 private:
  // The matrices by columns, their rows filled up to whole registers, gate by gate; biases that are only added are one.
  struct Packed {
    int encoded = 0, units = 0, heads = 0;  // filled up
    std::vector<float> encoder, encoder_bias, input, input_bias, hidden, new_bias, head, head_bias;
  };
  static Packed packed(const Parameters& parameters);

  Parameters parameters_;
  Packed packed_;
};

}  // namespace truebearing
