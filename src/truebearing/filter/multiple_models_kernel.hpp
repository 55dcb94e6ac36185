// SPDX-License-Identifier: Apache-2.0
// Eight multiple models side by side, mode j of each in the lanes of block j (filter_block.hpp): their equations
// (interacting_multiple_model.hpp), in the order in which one of them is worked on, so to the same bits but for the sign
// of a zero.
#pragma once

#include "truebearing/filter/filter_block.hpp"

namespace truebearing::kernels {

/// c_j = sum_i Pi_ij mu_i and weights[i r + j] = Pi_ij mu_i / c_j of r modes; Pi[i r + j]. `good` where every mode can be
/// entered.
void weigh_entries(const OfFilters* Pi, const OfFilters* mu, int r, OfFilters* c, OfFilters* weights, FilterMask& good);

/// Block j of `mixed` becomes the mixture of all modes by weights[i r + j].
template <int N>
void mix_entries(const FilterBlock<N>* modes, int r, const OfFilters* weights, FilterBlock<N>* mixed);

/// Mean and covariance of the mixtures of all modes.
template <int N>
void mix_models(const FilterBlock<N>* modes, int r, const OfFilters* weights, FilterBlock<N>& mixed);

/// nu, S and the NIS of the mixture of what the modes expected, which have the weights c.
template <int N, int M>
void combine_innovations(const UpdateBlock<N>* updates, int r, const OfFilters* c, UpdateBlock<N>& combined);
/// The gain that the modes have together.
template <int N, int M>
void combine_gains(const UpdateBlock<N>* updates, int r, const OfFilters* mu, UpdateBlock<N>& combined);

/// mu_j ~ c_j e^(likelihood_j): first the exponents, of which the largest is zero, and from their powers mu.
template <int N>
void find_exponents(const UpdateBlock<N>* updates, int r, OfFilters* exponents);
void weigh_modes(const OfFilters* c, const OfFilters* powers, int r, OfFilters* mu);

}  // namespace truebearing::kernels
