// SPDX-License-Identifier: Apache-2.0
// The innermost loops of variable projection (projected_cost.hpp), over a block of rows: in SIMD instructions where the
// processor has them, the same bits with them and without. Every sum is taken in the order of its index, so that it does
// not matter who takes it.
#pragma once

namespace truebearing::kernels {

/// Rows of a block at most: its strengths stay in the cache. A multiple of the eight that are worked on together.
inline constexpr int kBlockRows = 256;
/// From one column of a block to the next: no power of two, or all of them would share the same places of the cache.
inline constexpr int kBlockStride = kBlockRows + 8;

/// Normalised strengths phi of `rules` rules at the rows of a block.
struct StrengthsBlock {
  int rows;             ///< n <= kBlockRows
  int rules;            ///< M
  int terms;            ///< K = 2 d + 1
  const double* basis;  ///< V (kBlockStride x K), by columns; finite beyond `rows` too, to the next multiple of 8
  const double* coefficients;  ///< E (K x M), by columns: the exponents are V E
  double* by_rule;             ///< phi (kBlockStride x M), by columns
  double* by_row;              ///< phi' (stride x n), by columns, zero in its last stride - M rows
  int stride;                  ///< padded_to_lanes(M)
};
void block_strengths(const StrengthsBlock& block);

/// C (a x b, by columns) = A B', A (a x n) and B (b x n) by columns, a and b multiples of kLanes. Where `lower`, of
/// a == b, what stands in tiles above the diagonal is not written.
struct OuterSum {
  int n;
  int a;
  int b;
  const double* A;
  const double* B;
  double* C;
  bool lower;
};
void outer_sum(const OuterSum& sum);

/// Y (q x n) = W' Phi', of Phi' (stride x n) and W' (q x M) by columns, q a multiple of kLanes.
struct BlockOutputs {
  int rows;
  int rules;
  int stride;
  int outputs;  ///< q
  const double* by_row;
  const double* consequents;  ///< W' (q x M)
  double* y;                  ///< (q x n)
};
void block_outputs(const BlockOutputs& block);

/// G' (stride x n) = phi_nj (r.y_n - r.w_j), which is the gradient by the exponents but for a factor.
struct ExponentGradient {
  int rows;
  int stride;
  int outputs;                ///< p
  int residual_stride;        ///< q
  const double* by_row;       ///< Phi' (stride x n)
  const double* consequents;  ///< W (stride x p)
  const double* residuals;    ///< r' (q x n), weighted
  const double* outputs_sum;  ///< r.y (n)
  double* gradient;           ///< G' (stride x n)
};
void exponent_gradient(const ExponentGradient& block);

}  // namespace truebearing::kernels
