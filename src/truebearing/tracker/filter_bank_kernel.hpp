// SPDX-License-Identifier: Apache-2.0
// The weights of FilterBank, many side by side. Lists are padded to whole registers (padded_to_widest()), of
// logarithms of weights with minus infinity.
#pragma once

#include <cstddef>

namespace truebearing::kernels {

/// log_weights += gained, and all less by the largest, which becomes 0. False, and nothing is done, where that is minus
/// infinity.
bool gain_weights(const double* gained, std::size_t padded, double* log_weights);

/// weights = exp(log_weights), those below e^-708 of the largest zero, of logarithms of at most 0. Gives their sum.
double weights_of(const double* log_weights, std::size_t padded, double* weights);

}  // namespace truebearing::kernels
