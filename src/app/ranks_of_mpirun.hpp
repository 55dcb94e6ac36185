// SPDX-License-Identifier: Apache-2.0
// mpirun -n N truebearing ...: one piece of work of N processes.
#pragma once

#include <functional>

#include "truebearing/evaluation/ranks.hpp"

namespace truebearing {

/// Calls work with the ranks that mpirun has started this one with; with nullptr where it is alone. Where it throws,
/// all of them end. Throws InputError.
void with_ranks(const std::function<void(Ranks* ranks)>& work);

}  // namespace truebearing
