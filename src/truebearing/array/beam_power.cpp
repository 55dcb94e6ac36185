// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/beam_power.hpp"

#include <complex>

namespace truebearing {

std::vector<double> beam_power(const LineArray& array, const Eigen::MatrixXcd& R,
                               const std::vector<double>& angles_rad) {
  std::vector<double> power;
  Eigen::VectorXcd a(array.sensors);
  for (const double angle_rad : angles_rad) {
    for (int m = 0; m < array.sensors; ++m) a[m] = std::polar(1.0, m * array.phase_step(angle_rad));
    power.push_back(a.dot(R * a).real() / (static_cast<double>(array.sensors) * array.sensors));
  }
  return power;
}

}  // namespace truebearing
