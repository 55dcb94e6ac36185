// SPDX-License-Identifier: Apache-2.0
// The loops of the stochastic likelihood (angle_likelihood.hpp, whose letters these are), in SIMD instructions where
// the processor has them. Signals are lanes: no sum goes across a register, and what is computed for one signal is
// computed for all of them at once.
//     (M x N)  row by row, `lanes` numbers each: a row holds what one sensor hears of the N signals
//     (N x N)  column by column, `lanes` numbers each
//     (N)      `lanes` numbers
// `lanes` is N, padded to whole registers (core/simd_width.hpp); behind the N numbers stands anything finite.
#pragma once

namespace truebearing::kernels {

/// The real steering vectors of N angles and their derivatives (real_covariance.hpp).
struct Steering {
  int N, lanes;
  int pairs;
  bool middle;
  double wave;          ///< 2 pi d / lambda
  const double* live;   ///< (M)
  const double* theta;  ///< (N)
  double *A, *D;        ///< (M x N)
};
void steer_signals(const Steering& s);

/// A'A, D'A, D'D, and C = (sigma^2 P^-1 + A'A)^-1 with log det of its inverse; false where that is not positive
/// definite.
struct Coupling {
  int N, lanes, M;
  double noise;
  const double *A, *D;  ///< (M x N)
  const double* p;      ///< (N)
  double *AA, *DA, *DD, *C;
  double* log_det;
  bool* is_positive_definite;
};
void couple(const Coupling& s);

/// R^-1 A = A C P^-1 and R^-1 D = (D - A E) / sigma^2, E = C A'D, and all that the scores need of them:
///     aRa = A' R^-1 A,  dRa = D' R^-1 A,  dRd = D' R^-1 D  (N x N)
///     found_a, found_d, explained: of every signal a' R^-1 R_hat R^-1 a, d' R^-1 R_hat R^-1 a, a' R_hat R^-1 a (N)
struct Scores {
  int N, lanes, M;
  double inverse_noise;
  const double *A, *D;  // (M x N)
  const double* R;      // R_hat (M x M), columns `R_stride` apart
  int R_stride;
  const double *AA, *DA, *DD, *C, *p;
  double *W, *V, *RW;  // R^-1 A, R^-1 D, R_hat R^-1 A (M x N)
  double* Et;          // E' (N x N)
  double *aRa, *dRa, *dRd;
  double *found_a, *found_d, *explained;
};
void score_signals(const Scores& s);

/// Adds a block of Ns snapshots to the information: 2 Ns pp [dRa dRa' + dRd aRa], 2 Ns pp dRa aRa, Ns pp aRa^2,
/// products taken element by element, pp = p p' (N x N each).
struct Information {
  int N, lanes;
  double Ns;
  const double *p, *aRa, *dRa, *dRd;
  double *angles, *angle_power, *powers;
};
void add_information(const Information& s);

/// J (2N x 2N, by columns) of its parts (N x N each), [angles angle_power; angle_power' powers], and whether all of it
/// is finite.
struct Assembly {
  int N, lanes;
  const double *angles, *angle_power, *powers;
  double* J;
  bool* is_finite;
};
void assemble_information(const Assembly& s);

}  // namespace truebearing::kernels
