// SPDX-License-Identifier: Apache-2.0
// The loops of the angular innovations of all targets at once (implicit_innovations.hpp, whose letters these are), in
// SIMD instructions where the processor has them. Targets are lanes: `lanes` numbers for each of what they have.
#pragma once

namespace truebearing::kernels {

struct ImplicitInnovations {
  int M, N, lanes;
  double wave;                ///< 2 pi d / lambda
  const double* live;         ///< (M)
  const double *W_re, *W_im;  ///< (M x N), columns `W_stride` apart
  int W_stride;
  const double* theta;                    ///< (lanes)
  double *a_re, *a_im;                    ///< (lanes x M)
  double *ya_re, *ya_im, *yb_re, *yb_im;  ///< (lanes x N)
  double *L_re, *L_im;                    ///< (N x N)
  double *angle, *curvature, *b2;         ///< (lanes)
};
void implicit_innovations(const ImplicitInnovations& s);

}  // namespace truebearing::kernels
