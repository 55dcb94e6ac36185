// SPDX-License-Identifier: Apache-2.0
#include "training/rule_passes.hpp"

#include <algorithm>

#include "training/rule_passes_kernel.hpp"
#include "truebearing/core/simd_lanes.hpp"
#include "truebearing/evaluation/monte_carlo.hpp"

namespace truebearing {
namespace {

using kernels::kBlockRows, kernels::kBlockStride;

// Blocks whose sums are kept until they are added: few where a pass is over all rows.
constexpr std::size_t kBlocksAtOnce = 64;

int padded(Eigen::Index count) {
  return padded_to_lanes(static_cast<int>(count));
}

std::size_t block_count(std::span<const Eigen::Index> rows) {
  return (rows.size() + kBlockRows - 1) / kBlockRows;
}

std::span<const Eigen::Index> block_of(std::span<const Eigen::Index> rows, std::size_t number) {
  const std::size_t first = number * kBlockRows;
  return rows.subspan(first, std::min<std::size_t>(kBlockRows, rows.size() - first));
}

}  // namespace

Eigen::MatrixXd exponent_coefficients(const Eigen::MatrixXd& centres, const Eigen::MatrixXd& widths) {
  const Eigen::Index d = centres.cols();
  const Eigen::MatrixXd precision = widths.array().square().inverse();
  Eigen::MatrixXd coefficients(2 * d + 1, centres.rows());
  coefficients.row(0) = -0.5 * centres.cwiseAbs2().cwiseProduct(precision).rowwise().sum().transpose();
  coefficients.middleRows(1, d) = centres.cwiseProduct(precision).transpose();
  coefficients.bottomRows(d) = -0.5 * precision.transpose();
  return coefficients;
}

StrengthSums::StrengthSums(Eigen::Index rules, Eigen::Index outputs)
    : squared(Eigen::MatrixXd::Zero(rules, rules)),
      by_targets(Eigen::MatrixXd::Zero(rules, outputs)),
      sum(Eigen::VectorXd::Zero(rules)),
      targets_squared(Eigen::VectorXd::Zero(outputs)) {}

RulePasses::RulePasses(int threads) : threads_(threads), scratch_(worker_count(threads)) {}

const StrengthSums& RulePasses::sums(const NormalisedRows& rows, std::span<const Eigen::Index> chosen,
                                     const Eigen::MatrixXd& E) {
  rows_ = &rows;
  chosen_ = chosen;
  add_sums(E, false);
  return sums_;
}

const StrengthSums& RulePasses::sums_to_go_on(const NormalisedRows& rows, std::span<const Eigen::Index> chosen,
                                              const Eigen::MatrixXd& E) {
  rows_ = &rows;
  chosen_ = chosen;
  strengths_.resize(padded(E.cols()), static_cast<Eigen::Index>(chosen.size()));
  add_sums(E, true);
  return sums_;
}

void RulePasses::add_sums(const Eigen::MatrixXd& E, bool remember) {
  const Eigen::Index M = E.cols(), p = rows_->targets.rows();
  const std::size_t blocks = block_count(chosen_);
  sums_ = StrengthSums(M, p);
  block_sums_.resize(std::min(blocks, kBlocksAtOnce));
  for (std::size_t first = 0; first < blocks; first += kBlocksAtOnce) {
    const std::size_t count = std::min(kBlocksAtOnce, blocks - first);
    monte_carlo(count, threads_, [&](std::size_t i, std::size_t worker) {
      Scratch& scratch = scratch_[worker];
      scratch.by_row.resize(padded(M), kBlockRows);
      double* const by_row =
          remember ? strengths_.col(static_cast<Eigen::Index>(first + i) * kBlockRows).data() : scratch.by_row.data();
      take_sums(block_of(chosen_, first + i), E, by_row, scratch, block_sums_[i]);
    });
    for (std::size_t i = 0; i < count; ++i) {
      const StrengthSums& block = block_sums_[i];
      sums_.rows += block.rows;
      sums_.squared.triangularView<Eigen::Lower>() += block.squared.topLeftCorner(M, M);
      sums_.by_targets += block.by_targets.topLeftCorner(M, p);
      sums_.sum += block.sum;
      sums_.targets_squared += block.targets_squared;
    }
  }
}

void RulePasses::fill_basis_row(std::span<const Eigen::Index> block, Scratch& scratch) const {
  const Eigen::Index d = rows_->inputs.rows();
  scratch.basis_row.setZero(padded(2 * d + 1), kBlockRows);
  for (std::size_t n = 0; n < block.size(); ++n) {
    double* const row = scratch.basis_row.col(static_cast<Eigen::Index>(n)).data();
    const double* const u = rows_->inputs.col(block[n]).data();
    row[0] = 1.0;
    for (Eigen::Index i = 0; i < d; ++i) {
      row[1 + i] = u[i];
      row[1 + d + i] = u[i] * u[i];
    }
  }
}

void RulePasses::take_sums(std::span<const Eigen::Index> block, const Eigen::MatrixXd& E, double* by_row,
                           Scratch& scratch, StrengthSums& sums) const {
  const Eigen::Index M = E.cols(), terms = E.rows(), p = rows_->targets.rows();
  const auto count = static_cast<Eigen::Index>(block.size());
  const int stride = padded(M), q = padded(p);
  fill_basis_row(block, scratch);
  scratch.basis.resize(kBlockStride, terms);
  scratch.basis.topRows(count) = scratch.basis_row.topLeftCorner(terms, count).transpose();
  scratch.basis.bottomRows(kBlockStride - count).setZero();
  scratch.by_rule.resize(kBlockStride, M);
  kernels::block_strengths({static_cast<int>(count), static_cast<int>(M), static_cast<int>(terms), scratch.basis.data(),
                            E.data(), scratch.by_rule.data(), by_row, stride});

  scratch.targets.setZero(q, kBlockRows);
  for (Eigen::Index n = 0; n < count; ++n)
    scratch.targets.col(n).head(p) = rows_->targets.col(block[static_cast<std::size_t>(n)]);
  const int n = static_cast<int>(count);
  sums.rows = count;
  sums.squared.resize(stride, stride);
  kernels::outer_sum({n, stride, stride, by_row, by_row, sums.squared.data(), true});
  sums.by_targets.resize(stride, q);
  kernels::outer_sum({n, stride, q, by_row, scratch.targets.data(), sums.by_targets.data(), false});
  sums.sum = scratch.by_rule.topRows(count).colwise().sum().transpose();
  sums.targets_squared = scratch.targets.topLeftCorner(p, count).rowwise().squaredNorm();
}

const RulePasses::Gradient& RulePasses::gradient(const Eigen::MatrixXd& W, const Eigen::VectorXd& weights) {
  const Eigen::Index M = W.rows(), p = W.cols(), terms = 2 * rows_->inputs.rows() + 1;
  Eigen::MatrixXd filled = Eigen::MatrixXd::Zero(padded(M), p), by_row = Eigen::MatrixXd::Zero(padded(p), M);
  filled.topRows(M) = W;
  by_row.topRows(p) = W.transpose();
  const std::size_t blocks = block_count(chosen_);
  block_gradients_.resize(std::min(blocks, kBlocksAtOnce));
  gradient_.cost = 0.0;
  gradient_.by_coefficients.setZero(terms, M);
  for (std::size_t first = 0; first < blocks; first += kBlocksAtOnce) {
    const std::size_t count = std::min(kBlocksAtOnce, blocks - first);
    monte_carlo(count, threads_, [&](std::size_t i, std::size_t worker) {
      const double* const strengths = strengths_.col(static_cast<Eigen::Index>(first + i) * kBlockRows).data();
      take_gradient(block_of(chosen_, first + i), strengths, filled, by_row, weights, scratch_[worker],
                    block_gradients_[i]);
    });
    for (std::size_t i = 0; i < count; ++i) {
      gradient_.cost += block_gradients_[i].cost;
      gradient_.by_coefficients += block_gradients_[i].by_basis.topLeftCorner(M, terms).transpose();
    }
  }
  return gradient_;
}

void RulePasses::take_gradient(std::span<const Eigen::Index> block, const double* by_row, const Eigen::MatrixXd& W,
                               const Eigen::MatrixXd& W_by_row, const Eigen::VectorXd& weights, Scratch& scratch,
                               BlockGradient& gradient) const {
  const Eigen::Index M = W_by_row.cols(), p = W.cols();
  const int n = static_cast<int>(block.size()), stride = static_cast<int>(W.rows());
  const int q = static_cast<int>(W_by_row.rows()), terms = padded(2 * rows_->inputs.rows() + 1);
  fill_basis_row(block, scratch);
  scratch.outputs.resize(q, kBlockRows);
  scratch.residuals.resize(q, kBlockRows);
  scratch.outputs_sum.resize(kBlockRows);
  scratch.gradient.resize(stride, kBlockRows);
  kernels::block_outputs({n, static_cast<int>(M), stride, q, by_row, W_by_row.data(), scratch.outputs.data()});
  gradient.cost = 0.0;
  for (Eigen::Index row = 0; row < n; ++row) {
    const auto t = rows_->targets.col(block[static_cast<std::size_t>(row)]);
    double along = 0.0;
    for (Eigen::Index o = 0; o < p; ++o) {
      const double y = scratch.outputs(o, row), r = t[o] - y, weighted = r * weights[o];
      gradient.cost += r * weighted;
      scratch.residuals(o, row) = weighted;
      along += weighted * y;
    }
    scratch.outputs_sum[row] = along;
  }
  kernels::exponent_gradient({n, stride, static_cast<int>(p), q, by_row, W.data(), scratch.residuals.data(),
                              scratch.outputs_sum.data(), scratch.gradient.data()});
  gradient.by_basis.resize(stride, terms);
  kernels::outer_sum(
      {n, stride, terms, scratch.gradient.data(), scratch.basis_row.data(), gradient.by_basis.data(), false});
}

}  // namespace truebearing
