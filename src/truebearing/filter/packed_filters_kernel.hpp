// SPDX-License-Identifier: Apache-2.0
// The steps of Kalman filters that stand side by side (filter_block.hpp): the modes of one multiple model
// (PackedModes), or one filter of each of several targets or runs (StatePack). Each lane works as KalmanFilter in
// Joseph's form does (covariance_form.hpp) and in the same order, so to the same bits, whether a register holds two,
// four or eight of them. Lanes behind the last filter that are in a register with it are worked on too, whatever they
// hold.
#pragma once

#include "truebearing/filter/filter_block.hpp"

namespace truebearing::kernels {

/// x = F x, P = F P F' + Q, from `filters` to `moved`, which may be the same. `good` where x is finite and P plainly
/// positive definite; where that is not said, it may still be a covariance.
template <int N>
void predict_filters(const TransitionBlock<N>* transitions, int count, const FilterBlock<N>* filters,
                     FilterBlock<N>* moved, FilterMask* good);

/// K, S and the likelihood, and x and P with the measurement, from `filters` to `updated`, which may be the same.
/// kPosition: H = [I, 0]. `good` as of a prediction.
template <int N, int M, bool kPosition>
void update_filters(int count, const FilterBlock<N>* filters, UpdateBlock<N>* updates, FilterBlock<N>* updated,
                    FilterMask* good);

/// Those of a block of which x and the variances are finite, the first `positions` components of x at most `farthest`
/// from zero, and their variances at most its square.
template <int N>
void find_within(const FilterBlock<N>& filters, int positions, double farthest, FilterMask& within);

}  // namespace truebearing::kernels
