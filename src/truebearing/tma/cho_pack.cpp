// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tma/cho_pack.hpp"

#include <limits>

#include "truebearing/core/simd_width.hpp"
#include "truebearing/core/arctangent.hpp"

namespace truebearing {
namespace {

template <int kWidth>
[[gnu::always_inline]] inline void sum_pack_loops(const BearingArrays& in, double origin_s, ChoPack& pack) {
  using Vector = VectorOf<kWidth>;
  using Doubles = typename Vector::Doubles;
  for (int first = 0; first < kPack; first += kWidth) {
    Doubles x0, y0, vx, vy;
    Vector::load(pack.x[0] + first, x0);
    Vector::load(pack.x[1] + first, y0);
    Vector::load(pack.x[2] + first, vx);
    Vector::load(pack.x[3] + first, vy);
    Doubles cost{}, ra{}, rb{}, rat{}, rbt{}, aa{}, ab{}, bb{}, aat{}, abt{}, bbt{}, aatt{}, abtt{}, bbtt{};
    for (std::size_t i = 0; i < in.count; ++i) {
      const double t = in.time_s[i] - origin_s, w = in.weight[i], sine = in.sine[i], cosine = in.cosine[i];
      const Doubles dx = x0 + vx * t - in.first[i], dy = y0 + vy * t - in.second[i];
      // Sine and cosine of B - B_hat, times the range: the residual comes out wrapped.
      Doubles r;
      arctangent<Doubles>(sine * dy - cosine * dx, cosine * dy + sine * dx, r);
      const Doubles inverse = 1.0 / (dx * dx + dy * dy);
      const Doubles a = dy * inverse, b = -dx * inverse, at = a * t, bt = b * t;
      const Doubles wr = w * r, wa = w * a, wb = w * b, wat = w * at, wbt = w * bt;
      cost += wr * r;
      ra += wr * a;
      rb += wr * b;
      rat += wr * at;
      rbt += wr * bt;
      aa += wa * a;
      ab += wa * b;
      bb += wb * b;
      aat += wa * at;
      abt += wa * bt;
      bbt += wb * bt;
      aatt += wat * at;
      abtt += wat * bt;
      bbtt += wbt * bt;
    }
    cost *= 0.5;
    const Doubles* const all[] = {&cost, &ra, &rb, &rat, &rbt, &aa, &ab, &bb, &aat, &abt, &bbt, &aatt, &abtt, &bbtt};
#pragma GCC unroll 14
    for (int k = 0; k < kCartesianRows; ++k) Vector::store(*all[k], pack.sums[k] + first);
  }
}

// By L D L' without pivots: damping keeps the matrix positive definite but for rounding. A pivot of nothing gives no
// step in its direction.
template <int kWidth>
[[gnu::always_inline]] inline void damped_steps_loops(bool marquardt, ChoPack& pack) {
  using Vector = VectorOf<kWidth>;
  using Doubles = typename Vector::Doubles;
  constexpr double kLeast = std::numeric_limits<double>::min();
  for (int first = 0; first < kPack; first += kWidth) {
    Doubles A[4][4], g[4], mu, muD[4], inverse[4], h[4];
    Vector::load(pack.mu + first, mu);
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) {
      Vector::load(pack.sums[kRa + i] + first, g[i]);
#pragma GCC unroll 4
      for (int j = 0; j <= i; ++j) Vector::load(pack.sums[kNormalMatrix[i][j]] + first, A[i][j]);
      muD[i] = marquardt ? mu * A[i][i] : mu;
      A[i][i] += muD[i];
    }
#pragma GCC unroll 4
    for (int j = 0; j < 4; ++j) {  // below the diagonal A becomes L D, then L
      Doubles size = A[j][j];
      detail::take_sign(size);
      inverse[j] = size > kLeast ? 1.0 / A[j][j] : Doubles{};
#pragma GCC unroll 4
      for (int i = j + 1; i < 4; ++i) {
        const Doubles factor = A[i][j] * inverse[j];
#pragma GCC unroll 4
        for (int k = j + 1; k <= i; ++k) A[i][k] -= factor * A[k][j];
        g[i] -= factor * g[j];
      }
    }
#pragma GCC unroll 4
    for (int j = 3; j >= 0; --j) {
      h[j] = g[j];
#pragma GCC unroll 4
      for (int i = j + 1; i < 4; ++i) h[j] -= A[i][j] * h[i];
      h[j] *= inverse[j];
    }
    Doubles promised{};
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) {
      Doubles gradient;
      Vector::load(pack.sums[kRa + i] + first, gradient);
      promised += h[i] * (muD[i] * h[i] + gradient);
      Vector::store(h[i], pack.h[i] + first);
    }
    Vector::store(0.5 * promised, pack.promised + first);
  }
}

}  // namespace

TRUEBEARING_FOR_WIDEST(sum_pack, (const BearingArrays& bearings, double origin_s, ChoPack& pack),
                       (bearings, origin_s, pack))
TRUEBEARING_FOR_WIDEST(damped_steps, (bool marquardt, ChoPack& pack), (marquardt, pack))

}  // namespace truebearing
