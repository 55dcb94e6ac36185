// SPDX-License-Identifier: Apache-2.0
#include "truebearing/measurement/range_bearing_points.hpp"

#include <cmath>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/arctangent.hpp"
#include "truebearing/core/simd_width.hpp"

namespace truebearing {
namespace {

struct Points {
  int count;
  double east[kMostPoints], north[kMostPoints];  // from the site
  double bearing[kMostPoints];
};

template <int kWidth>
[[gnu::always_inline]] inline void see_loops(const double* z_0, Points& points) {
  using Vector = VectorOf<kWidth>;
  using Doubles = typename Vector::Doubles;
  for (int first = 0; first < points.count; first += kWidth) {
    Doubles east, north, bearing;
    Vector::load(points.east + first, east);
    Vector::load(points.north + first, north);
    arctangent<Doubles>(east, north, bearing);
    bearing -= z_0[1];
    bearing = bearing > kPi ? bearing - 2.0 * kPi : bearing;
    bearing = bearing < -kPi ? bearing + 2.0 * kPi : bearing;
    Vector::store(bearing, points.bearing + first);
  }
}
TRUEBEARING_FOR_WIDEST(see, (const double* z_0, Points& points), (z_0, points))

}  // namespace

void range_bearing_residuals(const double* X, int stride, int count, const double* site_m, const double* z_0,
                             double* residuals) {
  Points points;
  points.count = count;
  for (int i = 0; i < kMostPoints; ++i) {
    points.east[i] = i < count ? X[i * stride] - site_m[0] : 0.0;
    points.north[i] = i < count ? X[i * stride + 1] - site_m[1] : 1.0;
  }
  for (int i = 0; i < count; ++i) {
    const double squared = points.east[i] * points.east[i] + points.north[i] * points.north[i];
    residuals[2 * i] = std::sqrt(squared) - z_0[0];
    if (squared == 0.0) points.north[i] = 1.0;  // std::atan2(0, 0) is 0
  }
  see(z_0, points);
  for (int i = 0; i < count; ++i) residuals[2 * i + 1] = points.bearing[i];
}

}  // namespace truebearing
