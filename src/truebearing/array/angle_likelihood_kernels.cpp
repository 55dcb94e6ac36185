// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/angle_likelihood_kernels.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>

#include "truebearing/array/column_product.hpp"
#include "truebearing/core/simd_sine.hpp"
#include "truebearing/core/simd_width.hpp"
#include "truebearing/core/with_count.hpp"

namespace truebearing::kernels {
namespace {

constexpr int kMostLanes = padded_to_widest(kMostSignals);

// Registers that sums are kept in at once: few enough for the processor's.
template <int kWidth>
inline constexpr int kSums = kWidth == 8 ? 8 : 4;

template <int kWidth>
[[gnu::always_inline]] inline void steer_signals_loops(const Steering& s) {
  using Vector = VectorOf<kWidth>;
  using Doubles = typename Vector::Doubles;
  for (int g = 0; g < s.N; g += kWidth) {
    double *A = s.A + g, *D = s.D + g;
    Doubles theta, sine, cosine, c, s_, c1, s1;
    Vector::load(s.theta + g, theta);
    sine_and_cosine<kWidth>(theta, sine, cosine);
    const Doubles step = s.wave * sine, turn = (s.wave * std::numbers::sqrt2) * cosine;
    if (s.middle) {
      sine_and_cosine<kWidth>(step, s1, c1);
      s_ = s1;
      c = c1;
    } else {
      sine_and_cosine<kWidth>(0.5 * step, s_, c);
      c1 = 1.0 - 2.0 * s_ * s_;
      s1 = 2.0 * s_ * c;
    }
    const double first = s.middle ? 1.0 : 0.5;  // of the pairs' positions
    for (int i = 0; i < s.pairs; ++i) {
      const double alive = s.live[i] * std::numbers::sqrt2, position = s.live[i] * (i + first);
      const Doubles turning = turn * position;
      Vector::store(alive * c, A + i * s.lanes);
      Vector::store(alive * s_, A + (s.pairs + i) * s.lanes);
      Vector::store(-turning * s_, D + i * s.lanes);
      Vector::store(turning * c, D + (s.pairs + i) * s.lanes);
      const Doubles next = c * c1 - s_ * s1;
      s_ = c * s1 + s_ * c1;
      c = next;
    }
    if (s.middle) {
      Vector::store(Doubles{} + s.live[2 * s.pairs], A + 2 * s.pairs * s.lanes);
      Vector::store(Doubles{}, D + 2 * s.pairs * s.lanes);
    }
  }
}

// Columns j .. j + kColumns - 1 of the Gram matrices, of the lanes that begin at i.
template <int kWidth, int kColumns>
[[gnu::always_inline]] inline void grams_of(const Coupling& s, int i, int j) {
  using Vector = VectorOf<kWidth>;
  typename Vector::Doubles AA[std::size_t(kColumns)] = {}, DA[std::size_t(kColumns)] = {},
                           DD[std::size_t(kColumns)] = {}, a, d;
  for (int m = 0; m < s.M; ++m) {
    const double *A = s.A + m * s.lanes, *D = s.D + m * s.lanes;
    Vector::load(A + i, a);
    Vector::load(D + i, d);
#pragma GCC unroll 8
    for (int c = 0; c < kColumns; ++c) {
      AA[c] += a * A[j + c];
      DA[c] += d * A[j + c];
      DD[c] += d * D[j + c];
    }
  }
#pragma GCC unroll 8
  for (int c = 0; c < kColumns; ++c) {
    const int at = (j + c) * s.lanes + i;
    Vector::store(AA[c], s.AA + at);
    Vector::store(DA[c], s.DA + at);
    Vector::store(DD[c], s.DD + at);
  }
}

template <int kWidth, int kN>
[[gnu::always_inline]] inline void couple_of(const Coupling& s) {
  using Vector = VectorOf<kWidth>;
  using Doubles = typename Vector::Doubles;
  const int N = kN > 0 ? kN : s.N, lanes = s.lanes;
  constexpr int kTogether = kWidth == 8 && kN > 0 && kN < 8 ? kN : kSums<kWidth>;
  for (int i = 0; i < N; i += kWidth) {
    int j = 0;
    for (; j + kTogether <= N; j += kTogether) grams_of<kWidth, kTogether>(s, i, j);
    for (; j < N; ++j) grams_of<kWidth, 1>(s, i, j);
  }

  // -C by sweeping one diagonal element after the other (Goodnight 1979): the matrix stays symmetric, so that a column
  // is its row as well.
  *s.is_positive_definite = false;
  for (int j = 0; j < N; ++j) {
    for (int i = 0; i < N; i += kWidth) {
      Doubles column;
      Vector::load(s.AA + j * lanes + i, column);
      Vector::store(column, s.C + j * lanes + i);
    }
    s.C[j * lanes + j] += s.noise / s.p[j];
  }
  double det = 1.0;
  for (int k = 0; k < N; ++k) {
    double* C_k = s.C + k * lanes;
    const double pivot = C_k[k], inverse = 1.0 / pivot;
    if (!(pivot > 0.0)) return;
    det *= pivot;
    double factor[kMostLanes];  // column k over the pivot
    for (int i = 0; i < N; i += kWidth) {
      Doubles column;
      Vector::load(C_k + i, column);
      Vector::store(column * inverse, factor + i);
    }
    factor[k] = -inverse;
    C_k[k] = 0.0;
    for (int j = 0; j < N; ++j) {
      double* C_j = s.C + j * lanes;
      if (j == k) continue;
      for (int i = 0; i < N; i += kWidth) {
        Doubles swept, by;
        Vector::load(C_j + i, swept);
        Vector::load(C_k + i, by);
        Vector::store(swept - by * factor[j], C_j + i);
      }
      C_j[k] = factor[j];
    }
    for (int i = 0; i < N; i += kWidth) {
      Doubles column;
      Vector::load(factor + i, column);
      Vector::store(column, C_k + i);
    }
  }
  for (int j = 0; j < N; ++j)
    for (int i = 0; i < N; i += kWidth) {
      Doubles column;
      Vector::load(s.C + j * lanes + i, column);
      Vector::store(-column, s.C + j * lanes + i);
    }
  *s.log_det = std::log(det);
  *s.is_positive_definite = true;
}
template <int kWidth>
[[gnu::always_inline]] inline void couple_loops(const Coupling& s) {
  with_count(
      s.N, [&](auto known) __attribute__((always_inline)) { couple_of<kWidth, int(known)>(s); });
}

// Rows m .. m + kRows - 1 of R_hat W.
template <int kWidth, int kRows>
[[gnu::always_inline]] inline void heard_of(const Scores& s, int g, int m) {
  using Vector = VectorOf<kWidth>;
  typename Vector::Doubles sums[std::size_t(kRows)] = {}, w;
  for (int i = 0; i < s.M; ++i) {
    const double* R_i = s.R + i * s.R_stride + m;
    Vector::load(s.W + i * s.lanes + g, w);
#pragma GCC unroll 8
    for (int r = 0; r < kRows; ++r) sums[r] += w * R_i[r];
  }
#pragma GCC unroll 8
  for (int r = 0; r < kRows; ++r) Vector::store(sums[r], s.RW + (m + r) * s.lanes + g);
}

template <int kWidth, int kN>
[[gnu::always_inline]] inline void score_signals_of(const Scores& s) {
  using Vector = VectorOf<kWidth>;
  using Doubles = typename Vector::Doubles;
  const int N = kN > 0 ? kN : s.N, lanes = s.lanes;
  for (int g = 0; g < N; g += kWidth) {
    for (int j = 0; j < N; ++j) {
      Doubles Et{}, aRa{}, column;
      for (int k = 0; k < N; ++k) {
        const double C = s.C[j * lanes + k];
        Vector::load(s.DA + k * lanes + g, column);
        Et += column * C;
        Vector::load(s.AA + k * lanes + g, column);
        aRa += column * C;
      }
      const double inverse_p = 1.0 / s.p[j];
      Vector::store(Et, s.Et + j * lanes + g);
      Vector::store(Et * inverse_p, s.dRa + j * lanes + g);
      Vector::store(aRa * inverse_p, s.aRa + j * lanes + g);
    }
  }
  for (int g = 0; g < N; g += kWidth) {
    for (int j = 0; j < N; ++j) {
      Doubles dRd, column;
      Vector::load(s.DD + j * lanes + g, dRd);
      for (int k = 0; k < N; ++k) {
        Vector::load(s.DA + k * lanes + g, column);
        dRd -= column * s.Et[k * lanes + j];
      }
      Vector::store(dRd * s.inverse_noise, s.dRd + j * lanes + g);
    }
    Doubles p;
    Vector::load(s.p + g, p);
    const Doubles inverse_p = 1.0 / p;
    for (int m = 0; m < s.M; ++m) {
      const double* A_m = s.A + m * lanes;
      Doubles w{}, v, column;
      Vector::load(s.D + m * lanes + g, v);
      for (int k = 0; k < N; ++k) {
        Vector::load(s.C + k * lanes + g, column);
        w += column * A_m[k];
        Vector::load(s.Et + k * lanes + g, column);
        v -= column * A_m[k];
      }
      Vector::store(w * inverse_p, s.W + m * lanes + g);
      Vector::store(v * s.inverse_noise, s.V + m * lanes + g);
    }
    constexpr int kTogether = kSums<kWidth>;
    int m = 0;
    for (; m + kTogether <= s.M; m += kTogether) heard_of<kWidth, kTogether>(s, g, m);
    for (; m < s.M; ++m) heard_of<kWidth, 1>(s, g, m);
    Doubles found_a{}, found_d{}, explained{};
    for (m = 0; m < s.M; ++m) {
      Doubles rw, w, v, a;
      Vector::load(s.RW + m * lanes + g, rw);
      Vector::load(s.W + m * lanes + g, w);
      Vector::load(s.V + m * lanes + g, v);
      Vector::load(s.A + m * lanes + g, a);
      found_a += w * rw;
      found_d += v * rw;
      explained += a * rw;
    }
    Vector::store(found_a, s.found_a + g);
    Vector::store(found_d, s.found_d + g);
    Vector::store(explained, s.explained + g);
  }
}
template <int kWidth>
[[gnu::always_inline]] inline void score_signals_loops(const Scores& s) {
  with_count(
      s.N, [&](auto known) __attribute__((always_inline)) { score_signals_of<kWidth, int(known)>(s); });
}

template <int kWidth>
[[gnu::always_inline]] inline void add_information_loops(const Information& s) {
  using Vector = VectorOf<kWidth>;
  using Doubles = typename Vector::Doubles;
  for (int j = 0; j < s.N; ++j) {
    double mirrored[kMostLanes];  // row j of dRa
    for (int i = 0; i < s.N; ++i) mirrored[i] = s.dRa[i * s.lanes + j];
    for (int i = s.N; i < s.lanes; ++i) mirrored[i] = 0.0;
    for (int i = 0; i < s.N; i += kWidth) {
      const int at = j * s.lanes + i;
      Doubles p, aRa, dRa, aRd, dRd, angles, angle_power, powers;
      Vector::load(s.p + i, p);
      Vector::load(s.aRa + at, aRa);
      Vector::load(s.dRa + at, dRa);
      Vector::load(s.dRd + at, dRd);
      Vector::load(mirrored + i, aRd);
      Vector::load(s.angles + at, angles);
      Vector::load(s.angle_power + at, angle_power);
      Vector::load(s.powers + at, powers);
      const Doubles pp = p * (s.Ns * s.p[j]);
      Vector::store(angles + 2.0 * pp * (dRa * aRd + dRd * aRa), s.angles + at);
      Vector::store(angle_power + 2.0 * pp * (dRa * aRa), s.angle_power + at);
      Vector::store(powers + pp * (aRa * aRa), s.powers + at);
    }
  }
}

template <int kN>
[[gnu::always_inline]] inline void assemble_information_of(const Assembly& s) {
  const int N = kN > 0 ? kN : s.N, n = 2 * N;
  for (int j = 0; j < N; ++j) {
    double *of_angle = s.J + j * n, *of_power = s.J + (N + j) * n;
    const double *angles = s.angles + j * s.lanes, *angle_power = s.angle_power + j * s.lanes,
                 *powers = s.powers + j * s.lanes;
#pragma omp simd
    for (int i = 0; i < N; ++i) {
      of_angle[i] = angles[i];
      of_power[i] = angle_power[i];
      of_power[N + i] = powers[i];
    }
    for (int i = 0; i < N; ++i) of_angle[N + i] = s.angle_power[i * s.lanes + j];
  }
  double rest = 0.0;  // no number where one of them is not finite
#pragma omp simd reduction(+ : rest)
  for (int i = 0; i < n * n; ++i) rest += 0.0 * s.J[i];
  *s.is_finite = rest == 0.0;
}
template <int kWidth>
[[gnu::always_inline]] inline void assemble_information_loops(const Assembly& s) {
  with_count(
      s.N, [&](auto known) __attribute__((always_inline)) { assemble_information_of<int(known)>(s); });
}

}  // namespace

TRUEBEARING_FOR_WIDEST(steer_signals, (const Steering& s), (s))
TRUEBEARING_FOR_WIDEST(couple, (const Coupling& s), (s))
TRUEBEARING_FOR_WIDEST(score_signals, (const Scores& s), (s))
TRUEBEARING_FOR_WIDEST(add_information, (const Information& s), (s))
TRUEBEARING_FOR_WIDEST(assemble_information, (const Assembly& s), (s))

}  // namespace truebearing::kernels
