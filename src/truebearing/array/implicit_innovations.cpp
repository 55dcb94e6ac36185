// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/implicit_innovations.hpp"

#include <algorithm>

#include "truebearing/array/implicit_innovations_kernel.hpp"
#include "truebearing/core/simd_width.hpp"

namespace truebearing {

void ImplicitInnovations::find(const LineArray& array, std::span<const double> live, std::span<const double> angles_rad,
                               const SplitMatrix<double>& W) {
  const std::size_t N = angles_rad.size(), M = live.size();
  const auto lanes = static_cast<std::size_t>(padded_to_widest(static_cast<int>(N)));
  const auto hold = [](std::size_t count, auto&... rooms) {
    (..., (rooms.size() < count ? rooms.resize(count) : void()));
  };
  hold(lanes, theta_, angle_, curvature_, b2_);
  hold(lanes * M, a_re_, a_im_);
  hold(lanes * N, ya_re_, ya_im_, yb_re_, yb_im_);
  hold(N * N, L_re_, L_im_);
  std::fill(std::copy(angles_rad.begin(), angles_rad.end(), theta_.begin()), theta_.end(), 0.0);
  kernels::implicit_innovations({static_cast<int>(M),
                                 static_cast<int>(N),
                                 static_cast<int>(lanes),
                                 2.0 * kPi * array.spacing_wavelengths,
                                 live.data(),
                                 W.re.data(),
                                 W.im.data(),
                                 static_cast<int>(W.rows()),
                                 theta_.data(),
                                 a_re_.data(),
                                 a_im_.data(),
                                 ya_re_.data(),
                                 ya_im_.data(),
                                 yb_re_.data(),
                                 yb_im_.data(),
                                 L_re_.data(),
                                 L_im_.data(),
                                 angle_.data(),
                                 curvature_.data(),
                                 b2_.data()});
}

}  // namespace truebearing
