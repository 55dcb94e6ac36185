// SPDX-License-Identifier: Apache-2.0
#include "truebearing/filter/packed_modes_kernel.hpp"

#include <limits>

#include "truebearing/core/simd_logarithm.hpp"
#include "truebearing/core/simd_width.hpp"
#include "truebearing/filter/covariance_form.hpp"
#include "truebearing/filter/factorization.hpp"

namespace truebearing::kernels {
namespace {

constexpr double kLogTwoPi = 1.8378770664093454836;

template <typename Item, int Count>
using List = Item[static_cast<std::size_t>(Count)];
template <typename Item, int Rows, int Cols>
using Table = Item[static_cast<std::size_t>(Rows)][static_cast<std::size_t>(Cols)];

// kWidth modes, from `first` on, as registers.
template <int kWidth>
struct Registers {
  using Vector = VectorOf<kWidth>;
  using Doubles = typename Vector::Doubles;
  using Bits = typename Vector::Bits;

  [[gnu::always_inline]] static void load(const OfModes& from, int first, Doubles& to) {
    Vector::load(from.lane + first % kBlock, to);
  }
  [[gnu::always_inline]] static void store(const Doubles& from, int first, OfModes& to) {
    Vector::store(from, to.lane + first % kBlock);
  }
  template <int N>
  [[gnu::always_inline]] static void load(const ModeBlock<N>& from, int first, List<Doubles, N>& x,
                                          Table<Doubles, N, N>& P) {
    for (int i = 0; i < N; ++i) {
      load(from.x[i], first, x[i]);
      for (int j = 0; j <= i; ++j) load(from.P[i][j], first, P[i][j]);
    }
    mirror<N>(P);
  }
  template <int N>
  [[gnu::always_inline]] static void store(const List<Doubles, N>& x, const Table<Doubles, N, N>& P, int first,
                                           ModeBlock<N>& to) {
    for (int i = 0; i < N; ++i) {
      store(x[i], first, to.x[i]);
      for (int j = 0; j < N; ++j) store(P[i > j ? i : j][i > j ? j : i], first, to.P[i][j]);
    }
  }
  template <int N>
  [[gnu::always_inline]] static void mirror(Table<Doubles, N, N>& P) {
    for (int j = 1; j < N; ++j)
      for (int i = 0; i < j; ++i) P[i][j] = P[j][i];
  }

  // What is asked of the lanes. By signs, since compilers take comparisons of the widest registers apart.
  class Verdict {
   public:
    [[gnu::always_inline]] void is_less(const Doubles& a, const Doubles& b) { yes_ &= reinterpret_cast<Bits>(a - b); }
    [[gnu::always_inline]] void is_not_less(const Doubles& a, const Doubles& b) {
      yes_ &= ~reinterpret_cast<Bits>(a - b);
    }
    [[gnu::always_inline]] void is_finite(const Doubles& a) { infinite_ |= reinterpret_cast<Bits>(a - a); }
    [[gnu::always_inline]] void store(int first, ModeMask& mask) const {
      *reinterpret_cast<typename Vector::BitsInMemory*>(mask.lane + first % kBlock) =
          yes_ & ~(infinite_ | (Bits{} - infinite_));
    }

   private:
    Bits yes_ = ~Bits{};  // the sign of a number of them
    Bits infinite_{};     // any bit of it, no number or infinite
  };

  // detail::is_plainly_positive_definite() of every lane; A is used up.
  template <int N>
  [[gnu::always_inline]] static void is_plainly_positive_definite(Table<Doubles, N, N>& A, List<Doubles, N>& least,
                                                                  Verdict& plainly) {
    constexpr double kShare = detail::kPlainShare<double>;
    if constexpr (N == 1) {
      plainly.is_less(least[0], A[0][0]);
      plainly.is_finite(A[0][0]);
    } else {
      const Doubles whole = A[0][0] * A[1][1], det = whole - A[1][0] * A[1][0];
      plainly.is_less(least[0], A[0][0]);
      plainly.is_less(least[1], A[1][1]);
      plainly.is_less(kShare * whole, det);
      plainly.is_finite(det);
      if constexpr (N > 2) {
        Table<Doubles, N - 2, N - 2> rest;
        List<Doubles, N - 2> rest_least;
        for (int j = 2; j < N; ++j) {
          const Doubles u = A[1][1] * A[j][0] - A[1][0] * A[j][1], v = A[0][0] * A[j][1] - A[1][0] * A[j][0];
          for (int i = j; i < N; ++i) rest[i - 2][j - 2] = det * A[i][j] - (u * A[i][0] + v * A[i][1]);
          rest_least[j - 2] = det * (kShare * A[j][j] + least[j]);
        }
        is_plainly_positive_definite<N - 2>(rest, rest_least, plainly);
      }
    }
  }

  template <int N>
  [[gnu::always_inline]] static void judge(const List<Doubles, N>& x, const Table<Doubles, N, N>& P, int first,
                                           ModeMask& good) {
    Table<Doubles, N, N> A;
    List<Doubles, N> least;
    Verdict verdict;
    for (int i = 0; i < N; ++i) {
      verdict.is_finite(x[i]);
      least[i] = Doubles{};
      for (int j = 0; j <= i; ++j) A[i][j] = P[i][j];
    }
    is_plainly_positive_definite<N>(A, least, verdict);
    verdict.store(first, good);
  }

  // Of all modes, in one order whatever the width: first those of a block that stand four apart.
  struct Total {
    List<Doubles, kBlock / kWidth> parts;

    [[gnu::always_inline]] void begin() {
      for (Doubles& part : parts) part = Doubles{};
    }
    [[gnu::always_inline]] void add(int first, const Doubles& value) {
      parts[first / kWidth % (kBlock / kWidth)] += value;
    }
    [[gnu::always_inline]] double sum() const {
      typename VectorOf<4>::Doubles four;
      if constexpr (kWidth == 4) {
        four = parts[0] + parts[1];
      } else {
        const Doubles& all = parts[0];
        four = __builtin_shufflevector(all, all, 0, 1, 2, 3) + __builtin_shufflevector(all, all, 4, 5, 6, 7);
      }
      return (four[0] + four[2]) + (four[1] + four[3]);
    }
  };
};

template <int N>
struct Mixing {
  // Coefficient i of mode m stands i kBlock further: x, then P by rows.
  [[gnu::always_inline]] static const double* of_mode(const ModeBlock<N>* modes, int m) {
    return modes[m / kBlock].x[0].lane + m % kBlock;
  }

  template <int kWidth>
  [[gnu::always_inline]] static inline void mix_loops(const ModeBlock<N>* modes, int count, const OfModes* weights,
                                                      ModeBlock<N>* mixed) {
    using Some = Registers<kWidth>;
    using Doubles = typename Some::Doubles;
    if constexpr (kWidth > 4)
      if (count <= 4) return mix_loops<4>(modes, count, weights, mixed);
    const int blocks = blocks_of(count);
    for (int first = 0; first < count; first += kWidth) {
      List<Doubles, N> mean;
      Table<Doubles, N, N> P;
      Doubles weight;
      for (int i = 0; i < N; ++i) {
        mean[i] = Doubles{};
        for (int j = 0; j <= i; ++j) P[i][j] = Doubles{};
      }
      for (int m = 0; m < count; ++m) {
        Some::load(weights[m * blocks + first / kBlock], first, weight);
        const double* x = of_mode(modes, m);
        for (int i = 0; i < N; ++i) mean[i] += weight * x[i * kBlock];
      }
      for (int m = 0; m < count; ++m) {
        Some::load(weights[m * blocks + first / kBlock], first, weight);
        const double* x = of_mode(modes, m);
        List<Doubles, N> d;
        for (int i = 0; i < N; ++i) d[i] = x[i * kBlock] - mean[i];
        for (int i = 0; i < N; ++i)
          for (int j = 0; j <= i; ++j) P[i][j] += weight * (x[(N + i * N + j) * kBlock] + d[i] * d[j]);
      }
      Some::store(mean, P, first, mixed[first / kBlock]);
    }
  }
  TRUEBEARING_FOR_WIDEST(mix, (const ModeBlock<N>* modes, int count, const OfModes* weights, ModeBlock<N>* mixed),
                         (modes, count, weights, mixed))

  template <int kWidth>
  [[gnu::always_inline]] static inline void to_one_loops(const ModeBlock<N>* modes, int count, const OfModes* weights,
                                                         double* x, double* P) {
    using Some = Registers<kWidth>;
    using Doubles = typename Some::Doubles;
    if constexpr (kWidth > 4)
      if (count <= 4) return to_one_loops<4>(modes, count, weights, x, P);
    List<typename Some::Total, N> means;
    Table<typename Some::Total, N, N> squares;
    for (int i = 0; i < N; ++i) {
      means[i].begin();
      for (int j = 0; j <= i; ++j) squares[i][j].begin();
    }
    for (int first = 0; first < count; first += kWidth) {
      Doubles weight, value;
      Some::load(weights[first / kBlock], first, weight);
      for (int i = 0; i < N; ++i) {
        Some::load(modes[first / kBlock].x[i], first, value);
        means[i].add(first, weight * value);
      }
    }
    for (int i = 0; i < N; ++i) x[i] = means[i].sum();
    for (int first = 0; first < count; first += kWidth) {
      Doubles weight, value;
      List<Doubles, N> d;
      Some::load(weights[first / kBlock], first, weight);
      for (int i = 0; i < N; ++i) {
        Some::load(modes[first / kBlock].x[i], first, d[i]);
        d[i] -= x[i];
      }
      for (int i = 0; i < N; ++i)
        for (int j = 0; j <= i; ++j) {
          Some::load(modes[first / kBlock].P[i][j], first, value);
          squares[i][j].add(first, weight * (value + d[i] * d[j]));
        }
    }
    for (int i = 0; i < N; ++i)
      for (int j = 0; j <= i; ++j) P[i + j * N] = P[j + i * N] = squares[i][j].sum();
  }
  TRUEBEARING_FOR_WIDEST(to_one, (const ModeBlock<N>* modes, int count, const OfModes* weights, double* x, double* P),
                         (modes, count, weights, x, P))

  template <int kWidth>
  [[gnu::always_inline]] static inline void predict_loops(const TransitionBlock<N>* transitions, int count,
                                                          ModeBlock<N>* modes, ModeMask* good) {
    using Some = Registers<kWidth>;
    using Doubles = typename Some::Doubles;
    if constexpr (kWidth > 4)
      if (count <= 4) return predict_loops<4>(transitions, count, modes, good);
    for (int first = 0; first < count; first += kWidth) {
      const TransitionBlock<N>& transition = transitions[first / kBlock];
      List<Doubles, N> x, moved;
      Table<Doubles, N, N> P, F, FP;
      Some::load(modes[first / kBlock], first, x, P);
      for (int i = 0; i < N; ++i)
        for (int k = 0; k < N; ++k) Some::load(transition.F[i][k], first, F[i][k]);
      for (int i = 0; i < N; ++i) {
        moved[i] = F[i][0] * x[0];
        for (int k = 1; k < N; ++k) moved[i] += F[i][k] * x[k];
      }
      for (int i = 0; i < N; ++i)
        for (int j = 0; j < N; ++j) {
          FP[i][j] = F[i][0] * P[0][j];
          for (int k = 1; k < N; ++k) FP[i][j] += F[i][k] * P[k][j];
        }
      for (int i = 0; i < N; ++i)
        for (int j = 0; j <= i; ++j) {
          Some::load(transition.Q[i][j], first, P[i][j]);
          for (int k = 0; k < N; ++k) P[i][j] += FP[i][k] * F[j][k];
        }
      Some::store(moved, P, first, modes[first / kBlock]);
      Some::template judge<N>(moved, P, first, good[first / kBlock]);
    }
  }
  TRUEBEARING_FOR_WIDEST(predict,
                         (const TransitionBlock<N>* transitions, int count, ModeBlock<N>* modes, ModeMask* good),
                         (transitions, count, modes, good))
};

template <int N, int M, bool kPosition>
struct Taking {
  // P H' of a P that need not be symmetric.
  template <typename Doubles>
  [[gnu::always_inline]] static inline void times_H(const Table<Doubles, N, N>& P, const Table<Doubles, M, N>& H,
                                                    Table<Doubles, N, M>& PHt) {
    for (int i = 0; i < N; ++i)
      for (int m = 0; m < M; ++m) {
        if constexpr (kPosition) {
          PHt[i][m] = P[i][m];
        } else {
          PHt[i][m] = P[i][0] * H[m][0];
          for (int k = 1; k < N; ++k) PHt[i][m] += P[i][k] * H[m][k];
        }
      }
  }

  // CovarianceForm::gain(), and the likelihood.
  template <int kWidth>
  [[gnu::always_inline]] static inline void gain(const Table<typename Registers<kWidth>::Doubles, N, N>& P,
                                                 const Table<typename Registers<kWidth>::Doubles, M, N>& H,
                                                 const double* R,
                                                 const Table<typename Registers<kWidth>::Doubles, N, M>& PHt,
                                                 const List<typename Registers<kWidth>::Doubles, M>& nu, int first,
                                                 UpdateBlock<N>& update,
                                                 Table<typename Registers<kWidth>::Doubles, N, M>& K) {
    using Some = Registers<kWidth>;
    using Doubles = typename Some::Doubles;
    constexpr double kLeastPivot = std::numeric_limits<double>::epsilon() / (2 * detail::kTrustedError);
    Table<Doubles, M, M> L;
    List<Doubles, M> inverse_D;
    Doubles nis, determinant = Doubles{} + 1.0;
    typename Some::Verdict verdict;
    for (int m = 0; m < M; ++m)
      for (int l = 0; l <= m; ++l) {
        L[m][l] = Doubles{} + R[m + l * M];
        if constexpr (kPosition)
          L[m][l] += PHt[m][l];
        else
          for (int k = 0; k < N; ++k) L[m][l] += H[m][k] * PHt[k][l];
        Some::store(L[m][l], first, update.S[m][l]);
        if (l < m) Some::store(L[m][l], first, update.S[l][m]);
      }
    for (int k = 0; k < M; ++k) {
      Doubles t = Doubles{} + R[k + k * M];
      if constexpr (kPosition)
        t += P[k][k];
      else
        for (int j = 0; j < N; ++j) t += H[k][j] * H[k][j] * P[j][j];
      verdict.is_not_less(L[k][k], kLeastPivot * t + std::numeric_limits<double>::min());
      verdict.is_finite(L[k][k]);
      determinant *= L[k][k];
      inverse_D[k] = 1.0 / L[k][k];
      for (int i = k + 1; i < M; ++i) {
        const Doubles factor = L[i][k] * inverse_D[k];
        for (int j = k + 1; j <= i; ++j) L[i][j] -= factor * L[j][k];
      }
      for (int i = k + 1; i < M; ++i) L[i][k] *= inverse_D[k];
    }
    for (int row = 0; row <= N; ++row) {  // the rows of K, and last nu
      List<Doubles, M> b;
      for (int i = 0; i < M; ++i) b[i] = row < N ? PHt[row][i] : nu[i];
      for (int i = 1; i < M; ++i)
        for (int j = 0; j < i; ++j) b[i] -= L[i][j] * b[j];
      for (int i = 0; i < M; ++i) b[i] *= inverse_D[i];
      for (int i = M - 2; i >= 0; --i)
        for (int j = i + 1; j < M; ++j) b[i] -= L[j][i] * b[j];
      if (row < N) {
        for (int i = 0; i < M; ++i) Some::store(K[row][i] = b[i], first, update.K[row][i]);
      } else {
        nis = nu[0] * b[0];
        for (int i = 1; i < M; ++i) nis += nu[i] * b[i];
      }
    }
    verdict.is_not_less(determinant, Doubles{} + std::numeric_limits<double>::min());
    verdict.is_finite(determinant);
    logarithm<kWidth>(determinant);
    const Doubles gained = -0.5 * (nis + determinant + M * kLogTwoPi);
    verdict.is_finite(gained);
    Some::store(gained, first, update.log_likelihood);
    verdict.store(first, update.has_gain);
  }

  // Joseph::update(), and x = x + K nu.
  template <int kWidth>
  [[gnu::always_inline]] static inline void take_loops(const double* z, const double* R, int count,
                                                       const ModeBlock<N>* modes, UpdateBlock<N>* updates,
                                                       ModeBlock<N>* updated, ModeMask* good) {
    using Some = Registers<kWidth>;
    using Doubles = typename Some::Doubles;
    if constexpr (kWidth > 4)
      if (count <= 4) return take_loops<4>(z, R, count, modes, updates, updated, good);
    for (int first = 0; first < count; first += kWidth) {
      UpdateBlock<N>& update = updates[first / kBlock];
      List<Doubles, N> x;
      Table<Doubles, N, N> P;
      List<Doubles, M> nu;
      Table<Doubles, M, N> H;
      Table<Doubles, N, M> PHt, K;
      Some::load(modes[first / kBlock], first, x, P);
      for (int m = 0; m < M; ++m) {
        if constexpr (kPosition) {
          nu[m] = z[m] - x[m];
          Some::store(nu[m], first, update.nu[m]);
        } else {
          Some::load(update.nu[m], first, nu[m]);
          for (int i = 0; i < N; ++i) Some::load(update.H[m][i], first, H[m][i]);
        }
      }
      times_H<Doubles>(P, H, PHt);
      gain<kWidth>(P, H, R, PHt, nu, first, update, K);
      for (int i = 0; i < N; ++i)
        for (int m = 0; m < M; ++m) x[i] += K[i][m] * nu[m];
      for (int i = 0; i < N; ++i)
        for (int j = 0; j < N; ++j)
          for (int m = 0; m < M; ++m) P[i][j] -= K[i][m] * PHt[j][m];
      times_H<Doubles>(P, H, PHt);
      for (int i = 0; i < N; ++i)
        for (int m = 0; m < M; ++m)
          for (int l = 0; l < M; ++l) PHt[i][m] -= K[i][l] * R[l + m * M];
      for (int i = 0; i < N; ++i)
        for (int j = 0; j <= i; ++j)
          for (int m = 0; m < M; ++m) P[i][j] -= PHt[i][m] * K[j][m];
      Some::store(x, P, first, updated[first / kBlock]);
      Some::template judge<N>(x, P, first, good[first / kBlock]);
    }
  }
  TRUEBEARING_FOR_WIDEST(take,
                         (const double* z, const double* R, int count, const ModeBlock<N>* modes,
                          UpdateBlock<N>* updates, ModeBlock<N>* updated, ModeMask* good),
                         (z, R, count, modes, updates, updated, good))
};

// What the modes expected, by weights.
template <int N, int M>
struct Combining {
  template <int kWidth>
  [[gnu::always_inline]] static inline void innovations_loops(const UpdateBlock<N>* updates, int count,
                                                              const OfModes* weights, double* nu, double* S) {
    using Some = Registers<kWidth>;
    using Doubles = typename Some::Doubles;
    if constexpr (kWidth > 4)
      if (count <= 4) return innovations_loops<4>(updates, count, weights, nu, S);
    List<typename Some::Total, M> means;
    Table<typename Some::Total, M, M> squares;
    for (int m = 0; m < M; ++m) {
      means[m].begin();
      for (int l = 0; l <= m; ++l) squares[m][l].begin();
    }
    for (int first = 0; first < count; first += kWidth) {
      Doubles weight, value;
      Some::load(weights[first / kBlock], first, weight);
      for (int m = 0; m < M; ++m) {
        Some::load(updates[first / kBlock].nu[m], first, value);
        means[m].add(first, weight * value);
      }
    }
    for (int m = 0; m < M; ++m) nu[m] = means[m].sum();
    for (int first = 0; first < count; first += kWidth) {
      Doubles weight, value;
      List<Doubles, M> d;
      Some::load(weights[first / kBlock], first, weight);
      for (int m = 0; m < M; ++m) {
        Some::load(updates[first / kBlock].nu[m], first, d[m]);
        d[m] -= nu[m];
      }
      for (int m = 0; m < M; ++m)
        for (int l = 0; l <= m; ++l) {
          Some::load(updates[first / kBlock].S[m][l], first, value);
          value += d[m] * d[l];
          squares[m][l].add(first, weight * value);
        }
    }
    for (int m = 0; m < M; ++m)
      for (int l = 0; l <= m; ++l) S[m + l * M] = S[l + m * M] = squares[m][l].sum();
  }
  TRUEBEARING_FOR_WIDEST(innovations,
                         (const UpdateBlock<N>* updates, int count, const OfModes* weights, double* nu, double* S),
                         (updates, count, weights, nu, S))

  template <int kWidth>
  [[gnu::always_inline]] static inline void gains_loops(const UpdateBlock<N>* updates, int count,
                                                        const OfModes* weights, double* K) {
    using Some = Registers<kWidth>;
    using Doubles = typename Some::Doubles;
    if constexpr (kWidth > 4)
      if (count <= 4) return gains_loops<4>(updates, count, weights, K);
    Table<typename Some::Total, N, M> totals;
    for (int i = 0; i < N; ++i)
      for (int m = 0; m < M; ++m) totals[i][m].begin();
    for (int first = 0; first < count; first += kWidth) {
      Doubles weight, value;
      Some::load(weights[first / kBlock], first, weight);
      for (int i = 0; i < N; ++i)
        for (int m = 0; m < M; ++m) {
          Some::load(updates[first / kBlock].K[i][m], first, value);
          totals[i][m].add(first, weight * value);
        }
    }
    for (int i = 0; i < N; ++i)
      for (int m = 0; m < M; ++m) K[i + m * N] = totals[i][m].sum();
  }
  TRUEBEARING_FOR_WIDEST(gains, (const UpdateBlock<N>* updates, int count, const OfModes* weights, double* K),
                         (updates, count, weights, K))
};

}  // namespace

template <int N>
void mix_modes(const ModeBlock<N>* modes, int count, const OfModes* weights, ModeBlock<N>* mixed) {
  Mixing<N>().mix(modes, count, weights, mixed);
}

template <int N>
void predict_modes(const TransitionBlock<N>* transitions, int count, ModeBlock<N>* modes, ModeMask* good) {
  Mixing<N>().predict(transitions, count, modes, good);
}

template <int N, int M, bool kPosition>
void update_modes(const double* z, const double* R, int count, const ModeBlock<N>* modes, UpdateBlock<N>* updates,
                  ModeBlock<N>* updated, ModeMask* good) {
  Taking<N, M, kPosition>().take(z, R, count, modes, updates, updated, good);
}

template <int N>
void mix_to_one(const ModeBlock<N>* modes, int count, const OfModes* weights, double* x, double* P) {
  Mixing<N>().to_one(modes, count, weights, x, P);
}

template <int N, int M>
void mix_innovations(const UpdateBlock<N>* updates, int count, const OfModes* weights, double* nu, double* S) {
  Combining<N, M>().innovations(updates, count, weights, nu, S);
}

template <int N, int M>
void mix_gains(const UpdateBlock<N>* updates, int count, const OfModes* weights, double* K) {
  Combining<N, M>().gains(updates, count, weights, K);
}

#define TRUEBEARING_PACKED_UPDATE(N, M)                                                                            \
  template void update_modes<N, M, true>(const double*, const double*, int, const ModeBlock<N>*, UpdateBlock<N>*,  \
                                         ModeBlock<N>*, ModeMask*);                                                \
  template void update_modes<N, M, false>(const double*, const double*, int, const ModeBlock<N>*, UpdateBlock<N>*, \
                                          ModeBlock<N>*, ModeMask*);                                               \
  template void mix_innovations<N, M>(const UpdateBlock<N>*, int, const OfModes*, double*, double*);               \
  template void mix_gains<N, M>(const UpdateBlock<N>*, int, const OfModes*, double*)
#define TRUEBEARING_PACKED_MODES(N)                                                         \
  template void mix_modes<N>(const ModeBlock<N>*, int, const OfModes*, ModeBlock<N>*);      \
  template void predict_modes<N>(const TransitionBlock<N>*, int, ModeBlock<N>*, ModeMask*); \
  template void mix_to_one<N>(const ModeBlock<N>*, int, const OfModes*, double*, double*);  \
  TRUEBEARING_PACKED_UPDATE(N, 1)
TRUEBEARING_PACKED_MODES(2);
TRUEBEARING_PACKED_UPDATE(2, 2);
TRUEBEARING_PACKED_MODES(4);
TRUEBEARING_PACKED_UPDATE(4, 2);
TRUEBEARING_PACKED_UPDATE(4, 3);
TRUEBEARING_PACKED_MODES(6);
TRUEBEARING_PACKED_UPDATE(6, 2);
TRUEBEARING_PACKED_UPDATE(6, 3);
TRUEBEARING_PACKED_UPDATE(6, 4);

}  // namespace truebearing::kernels
