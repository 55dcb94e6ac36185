// SPDX-License-Identifier: Apache-2.0
// The mixtures of a multiple model whose modes stand in the lanes of filter_block.hpp.
#pragma once

#include "truebearing/filter/filter_block.hpp"

namespace truebearing::kernels {

/// The mixtures that the modes begin with: weights[i blocks + b], of mode i in those of block b. Equations (11.6.6-8)
/// to (-10) of Bar-Shalom, Li and Kirubarajan 2001.
template <int N>
void mix_modes(const FilterBlock<N>* modes, int count, const OfFilters* weights, FilterBlock<N>* mixed);

/// Mean and covariance (n x n, by columns) of the mixture of all modes by `weights`, zero in those that repeat.
template <int N>
void mix_to_one(const FilterBlock<N>* modes, int count, const OfFilters* weights, double* x, double* P);

/// nu (M) and S (M x M) of the mixture of what the modes expected, and their weighted K (N x M). What a mode without a
/// weight expected must be finite too.
template <int N, int M>
void mix_innovations(const UpdateBlock<N>* updates, int count, const OfFilters* weights, double* nu, double* S);
template <int N, int M>
void mix_gains(const UpdateBlock<N>* updates, int count, const OfFilters* weights, double* K);

}  // namespace truebearing::kernels
