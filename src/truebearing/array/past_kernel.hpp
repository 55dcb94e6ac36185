// SPDX-License-Identifier: Apache-2.0
// One pass of projection approximation subspace tracking over snapshots (projection_approximation.hpp, whose letters
// these are), in SIMD instructions where the processor has them.
#pragma once

namespace truebearing::kernels {

struct Past {
  int rows, columns;  // of W, rows padded
  double beta;
  int snapshots;
  const double *x_re, *x_im;          // (rows x snapshots)
  double *W_re, *W_im, *P_re, *P_im;  // rows of P, y, g and h padded as well
  double *y_re, *y_im, *g_re, *g_im, *h_re, *h_im;
};
void past(const Past& s);

}  // namespace truebearing::kernels
