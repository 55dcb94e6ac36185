// SPDX-License-Identifier: Apache-2.0
// What the module truebearing_mpi.so has for the program that loads it.
#pragma once

#include <memory>

#include "truebearing/evaluation/ranks.hpp"

namespace truebearing {

struct MpiModule {
  /// Joins the processes that mpirun has started. Throws InputError.
  std::unique_ptr<Ranks> (*join)();
};

}  // namespace truebearing
