// SPDX-License-Identifier: Apache-2.0
// The strengths of fuzzy rules, the innermost loops of a correction, in SIMD instructions where the processor has them: the
// same bits with them and without.
#pragma once

namespace truebearing::kernels {

/// Rules in blocks of kLanes (core/simd_lanes.hpp): column b inputs + i of both arrays (kLanes x blocks inputs, by
/// columns) is input i of block b.
struct RuleBlocks {
  int blocks;
  int inputs;
  const double* centres;         ///< c / (sqrt(2) s)
  const double* inverse_widths;  ///< 1 / (sqrt(2) s)
};

/// phi (kLanes blocks): exp(-|u / (sqrt(2) s) - c / (sqrt(2) s)|^2) of every rule over their sum, for inputs u.
void rule_strengths(const RuleBlocks& rules, const double* u, double* phi);

}  // namespace truebearing::kernels
