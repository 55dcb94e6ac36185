// SPDX-License-Identifier: Apache-2.0
// Snapshots into their real and imaginary parts (interval.hpp), in SIMD instructions where the processor has them.
#pragma once

namespace truebearing::kernels {

struct Snapshots {
  int sensors, count;
  const double* values;             ///< (2 sensors x count): real part, imaginary part of one sensor after the other
  int rows;                         ///< of what follows
  double *re, *im;                  ///< (rows x count)
  double *sum_re, *sum_im, *power;  ///< over the snapshots (sensors)
};
void part(const Snapshots& s);

}  // namespace truebearing::kernels
