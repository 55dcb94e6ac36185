// SPDX-License-Identifier: Apache-2.0
#include "truebearing/filter/packed_modes_kernel.hpp"

#include <limits>

#include "truebearing/core/simd_dispatch.hpp"
#include "truebearing/filter/factorization.hpp"
#include "truebearing/filter/covariance_form.hpp"

namespace truebearing::kernels {
namespace {

constexpr double kMax = std::numeric_limits<double>::max();

// detail::is_plainly_positive_definite() of every lane; A is used up.
template <int N>
[[gnu::always_inline]] inline void is_plainly_positive_definite(LaneMatrix<N, N>& A, LaneVector<N>& least,
                                                                LaneMask& plainly) {
  constexpr double kShare = detail::kPlainShare<double>;
  if constexpr (N == 1) {
    plainly &= (A[0][0] > least[0]) & (A[0][0] <= kMax);
  } else {
    const Lanes whole = A[0][0] * A[1][1], det = whole - A[1][0] * A[1][0];
    plainly &= (A[0][0] > least[0]) & (A[1][1] > least[1]) & (det > kShare * whole) & (det <= kMax);
    if constexpr (N > 2) {
      LaneMatrix<N - 2, N - 2> rest;
      LaneVector<N - 2> rest_least;
      for (int j = 2; j < N; ++j) {
        const Lanes u = A[1][1] * A[j][0] - A[1][0] * A[j][1], v = A[0][0] * A[j][1] - A[1][0] * A[j][0];
        for (int i = j; i < N; ++i) rest[i - 2][j - 2] = det * A[i][j] - (u * A[i][0] + v * A[i][1]);
        rest_least[j - 2] = det * (kShare * A[j][j] + least[j]);
      }
      is_plainly_positive_definite<N - 2>(rest, rest_least, plainly);
    }
  }
}

template <int N>
[[gnu::always_inline]] inline void judge(const LaneMatrix<N, N>& P, LaneMask& plainly) {
  LaneMatrix<N, N> A;
  LaneVector<N> least{};
  for (int i = 0; i < N; ++i)
    for (int j = 0; j <= i; ++j) A[i][j] = P[i][j];
  plainly = ~LaneMask{};
  is_plainly_positive_definite<N>(A, least, plainly);
}

template <int N>
[[gnu::always_inline]] inline void mirror(LaneMatrix<N, N>& P) {
  for (int j = 1; j < N; ++j)
    for (int i = 0; i < j; ++i) P[i][j] = P[j][i];
}

template <int N>
struct Mixing {
  // Coefficient i of mode m: x, then P by rows.
  [[gnu::always_inline]] static const double* of_mode(const ModeBlock<N>* modes, int m) {
    return reinterpret_cast<const double*>(modes + m / kLanes) + m % kLanes;
  }

  [[gnu::always_inline]] static inline void mix_loops(const ModeBlock<N>* modes, int count, const LaneWeights* weights,
                                                      int blocks, ModeBlock<N>* mixed) {
    for (int b = 0; b < blocks; ++b) {
      LaneVector<N> mean{};
      LaneMatrix<N, N> P{};
      for (int m = 0; m < count; ++m) {
        const Lanes weight = weights[m * blocks + b].of_mode;
        const double* x = of_mode(modes, m);
        for (int i = 0; i < N; ++i) mean[i] += weight * x[i * kLanes];
      }
      for (int m = 0; m < count; ++m) {
        const Lanes weight = weights[m * blocks + b].of_mode;
        const double* x = of_mode(modes, m);
        LaneVector<N> d;
        for (int i = 0; i < N; ++i) d[i] = x[i * kLanes] - mean[i];
        for (int i = 0; i < N; ++i)
          for (int j = 0; j <= i; ++j) P[i][j] += weight * (x[(N + i * N + j) * kLanes] + d[i] * d[j]);
      }
      mirror<N>(P);
      for (int i = 0; i < N; ++i) {
        mixed[b].x[i] = mean[i];
        for (int j = 0; j < N; ++j) mixed[b].P[i][j] = P[i][j];
      }
    }
  }
  TRUEBEARING_FOR_AVX2(mix,
                       (const ModeBlock<N>* modes, int count, const LaneWeights* weights, int blocks,
                        ModeBlock<N>* mixed),
                       (modes, count, weights, blocks, mixed))

  [[gnu::always_inline]] static inline void to_one_loops(const ModeBlock<N>* modes, const LaneWeights* weights,
                                                         int blocks, double* x, double* P) {
    LaneMatrix<N, kMaxModes / kLanes + 1> d;
    for (int i = 0; i < N; ++i) {
      Lanes total{};
      for (int b = 0; b < blocks; ++b) total += weights[b].of_mode * modes[b].x[i];
      x[i] = sum(total);
      for (int b = 0; b < blocks; ++b) d[i][b] = modes[b].x[i] - x[i];
    }
    for (int i = 0; i < N; ++i)
      for (int j = 0; j <= i; ++j) {
        Lanes total{};
        for (int b = 0; b < blocks; ++b) total += weights[b].of_mode * (modes[b].P[i][j] + d[i][b] * d[j][b]);
        P[i + j * N] = P[j + i * N] = sum(total);
      }
  }
  TRUEBEARING_FOR_AVX2(to_one,
                       (const ModeBlock<N>* modes, const LaneWeights* weights, int blocks, double* x, double* P),
                       (modes, weights, blocks, x, P))

  [[gnu::always_inline]] static inline void predict_loops(const TransitionBlock<N>* transitions, int blocks,
                                                          ModeBlock<N>* modes, LaneVerdicts* verdicts) {
    for (int b = 0; b < blocks; ++b) {
      const auto& F = transitions[b].F;
      ModeBlock<N>& mode = modes[b];
      LaneVector<N> x;
      LaneMatrix<N, N> FP;
      for (int i = 0; i < N; ++i) {
        x[i] = F[i][0] * mode.x[0];
        for (int k = 1; k < N; ++k) x[i] += F[i][k] * mode.x[k];
      }
      for (int i = 0; i < N; ++i) mode.x[i] = x[i];
      for (int i = 0; i < N; ++i)
        for (int j = 0; j < N; ++j) {
          FP[i][j] = F[i][0] * mode.P[0][j];
          for (int k = 1; k < N; ++k) FP[i][j] += F[i][k] * mode.P[k][j];
        }
      for (int i = 0; i < N; ++i)
        for (int j = 0; j <= i; ++j) {
          Lanes P = transitions[b].Q[i][j];
          for (int k = 0; k < N; ++k) P += FP[i][k] * F[j][k];
          mode.P[i][j] = P;
        }
      mirror<N>(mode.P);
      judge<N>(mode.P, verdicts[b].plainly);
    }
  }
  TRUEBEARING_FOR_AVX2(predict,
                       (const TransitionBlock<N>* transitions, int blocks, ModeBlock<N>* modes, LaneVerdicts* verdicts),
                       (transitions, blocks, modes, verdicts))
};

template <int N, int M, bool kPosition>
struct Taking {
  // P H' of a P that need not be symmetric.
  [[gnu::always_inline]] static inline void times_H(const LaneMatrix<N, N>& P, const UpdateBlock<N>& update,
                                                    LaneMatrix<N, M>& PHt) {
    for (int i = 0; i < N; ++i)
      for (int m = 0; m < M; ++m) {
        if constexpr (kPosition) {
          PHt[i][m] = P[i][m];
        } else {
          PHt[i][m] = P[i][0] * update.H[m][0];
          for (int k = 1; k < N; ++k) PHt[i][m] += P[i][k] * update.H[m][k];
        }
      }
  }

  // CovarianceForm::gain().
  [[gnu::always_inline]] static inline void gain(const LaneMatrix<N, N>& P, const double* R,
                                                 const LaneMatrix<N, M>& PHt, UpdateBlock<N>& update) {
    constexpr double kLeastPivot = std::numeric_limits<double>::epsilon() / (2 * detail::kTrustedError);
    LaneMatrix<M, M> L;
    LaneVector<M> inverse_D;
    LaneMask valid = ~LaneMask{};
    for (int m = 0; m < M; ++m)
      for (int l = 0; l <= m; ++l) {
        L[m][l] = Lanes{} + R[m + l * M];
        if constexpr (kPosition)
          L[m][l] += PHt[m][l];
        else
          for (int k = 0; k < N; ++k) L[m][l] += update.H[m][k] * PHt[k][l];
        update.S[m][l] = update.S[l][m] = L[m][l];
      }
    update.determinant = Lanes{} + 1.0;
    for (int k = 0; k < M; ++k) {
      Lanes t = Lanes{} + R[k + k * M];
      if constexpr (kPosition)
        t += P[k][k];
      else
        for (int j = 0; j < N; ++j) t += update.H[k][j] * update.H[k][j] * P[j][j];
      valid &= (L[k][k] >= kLeastPivot * t + std::numeric_limits<double>::min()) & (L[k][k] <= kMax);
      update.determinant *= L[k][k];
      inverse_D[k] = 1.0 / L[k][k];
      for (int i = k + 1; i < M; ++i) {
        const Lanes factor = L[i][k] * inverse_D[k];
        for (int j = k + 1; j <= i; ++j) L[i][j] -= factor * L[j][k];
      }
      for (int i = k + 1; i < M; ++i) L[i][k] *= inverse_D[k];
    }
    for (int row = 0; row <= N; ++row) {  // the rows of K, and last nu
      LaneVector<M> b;
      for (int i = 0; i < M; ++i) b[i] = row < N ? PHt[row][i] : update.nu[i];
      for (int i = 1; i < M; ++i)
        for (int j = 0; j < i; ++j) b[i] -= L[i][j] * b[j];
      for (int i = 0; i < M; ++i) b[i] *= inverse_D[i];
      for (int i = M - 2; i >= 0; --i)
        for (int j = i + 1; j < M; ++j) b[i] -= L[j][i] * b[j];
      if (row < N) {
        for (int i = 0; i < M; ++i) update.K[row][i] = b[i];
      } else {
        update.nis = update.nu[0] * b[0];
        for (int i = 1; i < M; ++i) update.nis += update.nu[i] * b[i];
      }
    }
    update.has_gain = valid;
  }

  // Joseph::update(), and x = x + K nu.
  [[gnu::always_inline]] static inline void take_loops(const double* R, int blocks, ModeBlock<N>* modes,
                                                       UpdateBlock<N>* updates, LaneVerdicts* verdicts) {
    for (int b = 0; b < blocks; ++b) {
      ModeBlock<N>& mode = modes[b];
      UpdateBlock<N>& update = updates[b];
      LaneMatrix<N, M> PHt;
      LaneMatrix<N, N> P;
      times_H(mode.P, update, PHt);
      gain(mode.P, R, PHt, update);
      for (int i = 0; i < N; ++i)
        for (int m = 0; m < M; ++m) mode.x[i] += update.K[i][m] * update.nu[m];
      for (int i = 0; i < N; ++i)
        for (int j = 0; j < N; ++j) {
          P[i][j] = mode.P[i][j];
          for (int m = 0; m < M; ++m) P[i][j] -= update.K[i][m] * PHt[j][m];
        }
      times_H(P, update, PHt);
      for (int i = 0; i < N; ++i)
        for (int m = 0; m < M; ++m)
          for (int l = 0; l < M; ++l) PHt[i][m] -= update.K[i][l] * R[l + m * M];
      for (int i = 0; i < N; ++i)
        for (int j = 0; j <= i; ++j) {
          for (int m = 0; m < M; ++m) P[i][j] -= PHt[i][m] * update.K[j][m];
          mode.P[i][j] = P[i][j];
        }
      mirror<N>(mode.P);
      judge<N>(mode.P, verdicts[b].plainly);
    }
  }
  TRUEBEARING_FOR_AVX2(take,
                       (const double* R, int blocks, ModeBlock<N>* modes, UpdateBlock<N>* updates,
                        LaneVerdicts* verdicts),
                       (R, blocks, modes, updates, verdicts))
};

}  // namespace

template <int N>
void mix_modes(const ModeBlock<N>* modes, int count, const LaneWeights* weights, int blocks, ModeBlock<N>* mixed) {
  Mixing<N>().mix(modes, count, weights, blocks, mixed);
}

template <int N>
void predict_modes(const TransitionBlock<N>* transitions, int blocks, ModeBlock<N>* modes, LaneVerdicts* verdicts) {
  Mixing<N>().predict(transitions, blocks, modes, verdicts);
}

template <int N, int M, bool kPosition>
void update_modes(const double* R, int blocks, ModeBlock<N>* modes, UpdateBlock<N>* updates, LaneVerdicts* verdicts) {
  Taking<N, M, kPosition>().take(R, blocks, modes, updates, verdicts);
}

template <int N>
void mix_to_one(const ModeBlock<N>* modes, const LaneWeights* weights, int blocks, double* x, double* P) {
  Mixing<N>().to_one(modes, weights, blocks, x, P);
}

#define TRUEBEARING_PACKED_UPDATE(N, M)                                                                      \
  template void update_modes<N, M, true>(const double*, int, ModeBlock<N>*, UpdateBlock<N>*, LaneVerdicts*); \
  template void update_modes<N, M, false>(const double*, int, ModeBlock<N>*, UpdateBlock<N>*, LaneVerdicts*)
#define TRUEBEARING_PACKED_MODES(N)                                                             \
  template void mix_modes<N>(const ModeBlock<N>*, int, const LaneWeights*, int, ModeBlock<N>*); \
  template void predict_modes<N>(const TransitionBlock<N>*, int, ModeBlock<N>*, LaneVerdicts*); \
  template void mix_to_one<N>(const ModeBlock<N>*, const LaneWeights*, int, double*, double*);  \
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
