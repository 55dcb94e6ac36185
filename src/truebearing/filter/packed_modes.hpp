// SPDX-License-Identifier: Apache-2.0
// Modes that are Kalman filters of one length in the default form lie side by side, one in each lane of a register
// (packed_filters_kernel.hpp): six of them cost less than two of SeparateModes. What a model has of its own, f and F of a
// nonlinear motion, h and H, is asked for mode by mode.
#pragma once

#include <memory>

#include "truebearing/filter/mode_bank.hpp"

namespace truebearing {

/// Nothing, and `modes` as they were, where they cannot be held so.
std::unique_ptr<ModeBank> packed_modes(const ModeBank::Modes& modes);

}  // namespace truebearing
