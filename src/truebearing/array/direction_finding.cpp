// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/direction_finding.hpp"

#include <algorithm>
#include <cmath>

#include "truebearing/core/linear_algebra.hpp"

namespace truebearing {
namespace {

// So much of a steering vector has to lie in the subspace for a peak to be a signal's; of a sidelobe's, which is a peak
// as well, a tenth or two does.
constexpr double kLeastShare = 0.5;

// |P_perp a|^2 / M at that sine: the square of the steering vector's distance from the subspace.
double distance_from(const LineArray& array, const Eigen::MatrixXcd& E, double sine) {
  Eigen::VectorXcd a(array.sensors);
  const double step = 2.0 * kPi * array.spacing_wavelengths * sine;
  for (int m = 0; m < array.sensors; ++m) a[m] = std::polar(1.0, step * m);
  return 1.0 - (E.adjoint() * a).squaredNorm() / array.sensors;
}

double angle_of(double sine) {
  return std::asin(std::clamp(sine, -1.0, 1.0));
}

}  // namespace

std::vector<double> music_angles(const LineArray& array, const Eigen::MatrixXcd& E, int grid) {
  const double step = 2.0 / (grid - 1);
  std::vector<double> distance(static_cast<std::size_t>(grid));
  for (int i = 0; i < grid; ++i) distance[static_cast<std::size_t>(i)] = distance_from(array, E, -1.0 + i * step);
  struct Peak {
    double distance, sine;
  };
  std::vector<Peak> peaks;
  const double live = static_cast<double>((E.rowwise().squaredNorm().array() > 1e-20).count());
  const double farthest = 1.0 - kLeastShare * live / array.sensors;
  for (int i = 1; i + 1 < grid; ++i) {
    const std::size_t at = static_cast<std::size_t>(i);
    if (!(distance[at] <= distance[at - 1] && distance[at] < distance[at + 1])) continue;
    double low = -1.0 + (i - 1) * step, high = -1.0 + (i + 1) * step;  // golden section between the neighbours
    constexpr double kGolden = 0.6180339887498949;
    double first = high - kGolden * (high - low), second = low + kGolden * (high - low);
    double f_first = distance_from(array, E, first), f_second = distance_from(array, E, second);
    for (int n = 0; n < 40; ++n) {
      if (f_first < f_second) {
        high = second;
        second = first;
        f_second = f_first;
        first = high - kGolden * (high - low);
        f_first = distance_from(array, E, first);
      } else {
        low = first;
        first = second;
        f_first = f_second;
        second = low + kGolden * (high - low);
        f_second = distance_from(array, E, second);
      }
    }
    if (std::min(f_first, f_second) > farthest) continue;
    peaks.push_back({std::min(f_first, f_second), 0.5 * (low + high)});
  }
  std::sort(peaks.begin(), peaks.end(), [](const Peak& a, const Peak& b) { return a.distance < b.distance; });
  std::vector<double> angles;
  for (const Peak& peak : peaks)
    if (angles.size() < static_cast<std::size_t>(E.cols())) angles.push_back(angle_of(peak.sine));
  std::sort(angles.begin(), angles.end());
  return angles;
}

std::vector<double> esprit_angles(const LineArray& array, const Eigen::MatrixXcd& E) {
  if (E.cols() == 0) return {};
  const Eigen::Index M = E.rows();
  const Eigen::MatrixXcd rotation = least_squares(Eigen::MatrixXcd(E.topRows(M - 1)), E.bottomRows(M - 1));
  const Eigen::VectorXcd values = eigenvalues(rotation);
  std::vector<double> angles;
  for (const std::complex<double> value : values)
    angles.push_back(angle_of(std::arg(value) / (2.0 * kPi * array.spacing_wavelengths)));
  std::sort(angles.begin(), angles.end());
  return angles;
}

std::vector<double> signal_angles(const LineArray& array, const Eigen::MatrixXcd& E) {
  std::vector<double> angles = music_angles(array, E);
  return static_cast<Eigen::Index>(angles.size()) == E.cols() ? angles : esprit_angles(array, E);
}

}  // namespace truebearing
