// SPDX-License-Identifier: Apache-2.0
#include "truebearing/filter/packed_filters_kernel.hpp"

#include <limits>

#include "truebearing/core/simd_logarithm.hpp"
#include "truebearing/filter/covariance_form.hpp"
#include "truebearing/filter/packed_registers.hpp"

namespace truebearing::kernels {
namespace {

template <int N>
struct Predicting {
  template <int kWidth>
  [[gnu::always_inline]] static inline void predict_loops(const TransitionBlock<N>* transitions, int count,
                                                          const FilterBlock<N>* filters, FilterBlock<N>* moved_filters,
                                                          FilterMask* good) {
    using Some = Registers<kWidth>;
    using Doubles = typename Some::Doubles;
    if constexpr (kWidth > 4)
      if (lanes_of(count) <= 4) return predict_loops<4>(transitions, count, filters, moved_filters, good);
    for (int first = 0; first < count; first += kWidth) {
      const TransitionBlock<N>& transition = transitions[first / kBlock];
      List<Doubles, N> x, moved;
      Table<Doubles, N, N> P, F, FP;
      Some::load(filters[first / kBlock], first, x, P);
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
      Some::store(moved, P, first, moved_filters[first / kBlock]);
      Some::template judge<N>(moved, P, first, good[first / kBlock]);
    }
  }
  TRUEBEARING_FOR_WIDEST(predict,
                         (const TransitionBlock<N>* transitions, int count, const FilterBlock<N>* filters,
                          FilterBlock<N>* moved, FilterMask* good),
                         (transitions, count, filters, moved, good))
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
                                                 const Table<typename Registers<kWidth>::Doubles, M, M>& R,
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
        L[m][l] = R[m][l];
        if constexpr (kPosition)
          L[m][l] += PHt[m][l];
        else
          for (int k = 0; k < N; ++k) L[m][l] += H[m][k] * PHt[k][l];
        Some::store(L[m][l], first, update.S[m][l]);
        if (l < m) Some::store(L[m][l], first, update.S[l][m]);
      }
    for (int k = 0; k < M; ++k) {
      Doubles t = R[k][k];
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
    Some::store(nis, first, update.nis);
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
  [[gnu::always_inline]] static inline void take_loops(int count, const FilterBlock<N>* filters,
                                                       UpdateBlock<N>* updates, FilterBlock<N>* updated,
                                                       FilterMask* good) {
    using Some = Registers<kWidth>;
    using Doubles = typename Some::Doubles;
    if constexpr (kWidth > 4)
      if (lanes_of(count) <= 4) return take_loops<4>(count, filters, updates, updated, good);
    for (int first = 0; first < count; first += kWidth) {
      UpdateBlock<N>& update = updates[first / kBlock];
      List<Doubles, N> x;
      Table<Doubles, N, N> P;
      List<Doubles, M> nu;
      Table<Doubles, M, M> R;
      Table<Doubles, M, N> H;
      Table<Doubles, N, M> PHt, K;
      Some::load(filters[first / kBlock], first, x, P);
      for (int m = 0; m < M; ++m) {
        Some::load(update.nu[m], first, nu[m]);
        for (int l = 0; l < M; ++l) Some::load(update.R[m][l], first, R[m][l]);
        if constexpr (kPosition) {
          nu[m] -= x[m];
          Some::store(nu[m], first, update.nu[m]);
        } else {
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
          for (int l = 0; l < M; ++l) PHt[i][m] -= K[i][l] * R[l][m];
      for (int i = 0; i < N; ++i)
        for (int j = 0; j <= i; ++j)
          for (int m = 0; m < M; ++m) P[i][j] -= PHt[i][m] * K[j][m];
      Some::store(x, P, first, updated[first / kBlock]);
      Some::template judge<N>(x, P, first, good[first / kBlock]);
    }
  }
  TRUEBEARING_FOR_WIDEST(take,
                         (int count, const FilterBlock<N>* filters, UpdateBlock<N>* updates, FilterBlock<N>* updated,
                          FilterMask* good),
                         (count, filters, updates, updated, good))
};

template <int N>
struct Bounding {
  template <int kWidth>
  [[gnu::always_inline]] static inline void within_loops(const FilterBlock<N>& filters, int positions, double farthest,
                                                         FilterMask& within) {
    using Some = Registers<kWidth>;
    using Doubles = typename Some::Doubles;
    const Doubles most = Doubles{} + farthest;
    for (int first = 0; first < kBlock; first += kWidth) {
      typename Some::Verdict verdict;
      for (int i = 0; i < N; ++i) {
        Doubles x, variance;
        Some::load(filters.x[i], first, x);
        Some::load(filters.P[i][i], first, variance);
        verdict.is_finite(x);
        verdict.is_finite(variance);
        if (i >= positions) continue;
        verdict.is_not_less(x, -most);
        verdict.is_not_less(most, x);
        verdict.is_not_less(most * most, variance);
      }
      verdict.store(first, within);
    }
  }
  TRUEBEARING_FOR_WIDEST(within, (const FilterBlock<N>& filters, int positions, double farthest, FilterMask& within),
                         (filters, positions, farthest, within))
};

}  // namespace

template <int N>
void predict_filters(const TransitionBlock<N>* transitions, int count, const FilterBlock<N>* filters,
                     FilterBlock<N>* moved, FilterMask* good) {
  Predicting<N>().predict(transitions, count, filters, moved, good);
}

template <int N, int M, bool kPosition>
void update_filters(int count, const FilterBlock<N>* filters, UpdateBlock<N>* updates, FilterBlock<N>* updated,
                    FilterMask* good) {
  Taking<N, M, kPosition>().take(count, filters, updates, updated, good);
}

template <int N>
void find_within(const FilterBlock<N>& filters, int positions, double farthest, FilterMask& within) {
  Bounding<N>().within(filters, positions, farthest, within);
}

#define TRUEBEARING_PACKED_UPDATE(N, M)                                                                                \
  template void update_filters<N, M, true>(int, const FilterBlock<N>*, UpdateBlock<N>*, FilterBlock<N>*, FilterMask*); \
  template void update_filters<N, M, false>(int, const FilterBlock<N>*, UpdateBlock<N>*, FilterBlock<N>*, FilterMask*)
#define TRUEBEARING_PACKED_FILTERS(N)                                                                      \
  template void find_within<N>(const FilterBlock<N>&, int, double, FilterMask&);                           \
  template void predict_filters<N>(const TransitionBlock<N>*, int, const FilterBlock<N>*, FilterBlock<N>*, \
                                   FilterMask*);                                                           \
  TRUEBEARING_PACKED_UPDATE(N, 1)
TRUEBEARING_PACKED_FILTERS(2);
TRUEBEARING_PACKED_UPDATE(2, 2);
TRUEBEARING_PACKED_FILTERS(3);
TRUEBEARING_PACKED_FILTERS(4);
TRUEBEARING_PACKED_UPDATE(4, 2);
TRUEBEARING_PACKED_UPDATE(4, 3);
TRUEBEARING_PACKED_FILTERS(5);
TRUEBEARING_PACKED_UPDATE(5, 2);
TRUEBEARING_PACKED_FILTERS(6);
TRUEBEARING_PACKED_UPDATE(6, 2);
TRUEBEARING_PACKED_UPDATE(6, 3);
TRUEBEARING_PACKED_UPDATE(6, 4);

}  // namespace truebearing::kernels
