// What a tracker may publish as an estimate: anything else is `failed`, whatever a hostile log made of its arithmetic.
#pragma once

#include "truebearing/core/bounded.hpp"

namespace truebearing {

/// Whether x (n) and P (n x n) are finite and no variance is below zero.
inline bool is_publishable(const BoundedVector& x, const BoundedMatrix& P) {
  return x.allFinite() && P.allFinite() && (P.diagonal().array() >= 0.0).all();
}

}  // namespace truebearing
