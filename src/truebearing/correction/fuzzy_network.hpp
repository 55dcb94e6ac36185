// SPDX-License-Identifier: Apache-2.0
// The normalized fuzzy neural network (NFNN) of Chao and Teng 1995 as Lee et al. use it, eqs. (11) and (12): rule j
// says "IF u_1 is A_1j AND ... AND u_d is A_dj THEN y = w_j" with Gaussian terms
//     mu_ij(u_i) = exp(-(u_i - c_ji)^2 / (2 s_ji^2)),
// and the output is y = sum_j phi_j w_j with phi_j the rule strengths prod_i mu_ij, normalised over the rules. The
// strengths stay in the log domain until the normalisation (a softmax), so that inputs far from every rule do not give
// 0/0: the output is always in the hull of the consequents.
//
// d inputs, M rules, p outputs. Inputs are standardised, u = clip((input - mean) / scale), before the rules see them;
// outputs are multiplied by output_scale.
#pragma once

#include <Eigen/Core>

#include "truebearing/core/bounded.hpp"
#include "truebearing/correction/network_answer.hpp"
#include "truebearing/correction/rule_strengths_kernel.hpp"

namespace truebearing {

class FuzzyNetwork {
 public:
  static constexpr int kMaxInputs = kMaxFeatures;
  static constexpr int kMaxRules = kernels::kMostRules;
  static constexpr int kMaxOutputs = kMaxDimension;

  using Inputs = NetworkInputs;
  using Strengths = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxRules, 1>;
  using Outputs = BoundedVector;

  struct Parameters {
    Eigen::VectorXd input_mean;    ///< (d), in the units of the features
    Eigen::VectorXd input_scale;   ///< (d), > 0
    double input_clip = 4.0;       ///< standardised inputs are clipped to +- this
    Eigen::MatrixXd centres;       ///< (M x d), standardised
    Eigen::MatrixXd widths;        ///< (M x d), standardised, > 0
    Eigen::MatrixXd consequents;   ///< (M x p), in units of output_scale
    Eigen::VectorXd output_scale;  ///< (p), > 0, in the units of the outputs
    bool operator==(const Parameters&) const = default;
  };

  FuzzyNetwork() = default;
  /// Throws InputError where shapes disagree, sizes pass the maxima, a number is not finite or a scale is not positive.
  explicit FuzzyNetwork(Parameters parameters);

  int inputs() const { return static_cast<int>(parameters_.centres.cols()); }
  int rules() const { return static_cast<int>(parameters_.centres.rows()); }
  int outputs() const { return static_cast<int>(parameters_.consequents.cols()); }
  const Parameters& parameters() const { return parameters_; }

  /// phi (M): the normalised strengths of the rules at `input` (d); they are >= 0 and sum to 1. No allocation.
  /// A NaN input gives NaN strengths; the caller decides what that means.
  void strengths(const Inputs& input, Strengths& phi) const;
  /// y (p) for given strengths. No allocation.
  Outputs output(const Strengths& phi) const;
  /// Both at once, and mean (n x n): that of a symmetric matrix of each rule, the rows of `matrices` (M x n n, by
  /// columns), of which the lower half counts. To rounding what strengths() weights. No allocation.
  void answer(const Inputs& input, Outputs& y, int n, const double* matrices, double* mean) const;

  using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxOutputs, kMaxInputs>;
  /// dy/dinput (p x d) at `input`, whose strengths are phi: with a_ji = (c_ji - u_i) / s_ji^2
  ///     dy/du_i = sum_j phi_j a_ji (w_j - y),
  /// and zero in an input that is clipped. No allocation.
  Jacobian jacobian(const Inputs& input, const Strengths& phi) const;

 private:
  // Rules are evaluated in blocks; those that fill up the last one never fire.
  using Blocks = Eigen::Array<double, kernels::kRuleBlock, Eigen::Dynamic>;

  bool standardise(const Inputs& input, double* u) const;
  kernels::RuleBlocks blocks() const;

  Parameters parameters_;
  int blocks_ = 0;
  // The exponents as they are evaluated, -((u - c) / (sqrt(2) s))^2: column b d + i is input i of block b.
  Blocks scaled_centres_;               // c / (sqrt(2) s)
  Blocks inverse_widths_;               // 1 / (sqrt(2) s)
  Eigen::MatrixXd scaled_consequents_;  // (M x p), in the units of the outputs
};

}  // namespace truebearing
