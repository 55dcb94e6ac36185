// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/recorder_jitter.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace truebearing {
namespace {

double laplace(double sigma, RandomStream& stream) {
  const double side = stream.uniform() < 0.5 ? -1.0 : 1.0;
  return -side * sigma / std::numbers::sqrt2 * std::log(1.0 - stream.uniform());
}

Eigen::Index draw_spacing(const std::vector<double>& probabilities, RandomStream& stream) {
  double u = stream.uniform();
  Eigen::Index spacing = 1;
  for (std::size_t i = 0; i + 1 < probabilities.size() && u >= probabilities[i]; ++i) {
    u -= probabilities[i];
    ++spacing;
  }
  return spacing;
}

}  // namespace

Eigen::Matrix2Xd RecorderJitter::record(const Eigen::Matrix4Xd& track, RandomStream& stream) const {
  const double sigma_s = time_sigma_s.draw(stream);
  const auto knot = [&](Eigen::Index k) -> Eigen::Vector2d {
    return track.col(k).head<2>() + laplace(sigma_s, stream) * track.col(k).tail<2>();
  };
  const Eigen::Index last = track.cols() - 1;
  Eigen::Matrix2Xd recorded(2, track.cols());
  recorded.col(0) = knot(0);
  for (Eigen::Index begin = 0; begin < last;) {
    const Eigen::Index end = std::min(begin + draw_spacing(knots, stream), last);
    recorded.col(end) = knot(end);
    for (Eigen::Index k = begin + 1; k < end; ++k) {
      const double part = static_cast<double>(k - begin) / static_cast<double>(end - begin);
      recorded.col(k) = (1.0 - part) * recorded.col(begin) + part * recorded.col(end);
    }
    begin = end;
  }
  return recorded;
}

}  // namespace truebearing
