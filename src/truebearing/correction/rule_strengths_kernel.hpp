// SPDX-License-Identifier: Apache-2.0
// The strengths of fuzzy rules and the means that they weight, the innermost loops of a correction, in SIMD
// instructions where the processor has them: the same bits with them and without.
#pragma once

namespace truebearing::kernels {

/// Rules are evaluated in blocks of so many: one register of AVX-512, two of AVX.
inline constexpr int kRuleBlock = 8;
inline constexpr int kMostRules = 256;

/// Rules in blocks: column b inputs + i of both arrays (kRuleBlock x blocks inputs, by columns) is input i of block b.
struct RuleBlocks {
  int blocks;
  int inputs;
  const double* centres;         ///< c / (sqrt(2) s)
  const double* inverse_widths;  ///< 1 / (sqrt(2) s)
};

/// What each rule says, by columns: numbers (rules x columns) and a symmetric matrix (rules x n n), whose lower half
/// counts. Of either there may be none.
struct RuleTables {
  int rules;
  int columns;
  const double* numbers;
  int n;
  const double* matrices;
};

/// phi (kRuleBlock blocks): exp(-|u / (sqrt(2) s) - c / (sqrt(2) s)|^2) of every rule over their sum, for inputs u.
void rule_strengths(const RuleBlocks& rules, const double* u, double* phi);

/// The means of what the rules say, weighted by strengths phi (rules): numbers (columns) and a matrix (n x n), whose
/// lower half counts.
void rule_means(const RuleTables& said, const double* phi, double* numbers, double* matrix);

/// The same for inputs u, in one go: for a sum of 1 the strengths need not be divided by it one by one.
void rule_answer(const RuleBlocks& rules, const RuleTables& said, const double* u, double* numbers, double* matrix);

}  // namespace truebearing::kernels
