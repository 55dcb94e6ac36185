// SPDX-License-Identifier: Apache-2.0
// The filter alone, without a study: fixed sizes, no heap, no virtual call. A target at 200 m/s is measured every
// second with a standard deviation of 50 m.
#include <cstdio>

#include "truebearing/core/random.hpp"
#include "truebearing/filter/kalman.hpp"
#include "truebearing/measurement/position.hpp"
#include "truebearing/motion/constant_velocity.hpp"

using namespace truebearing;

int main() {
  const ConstantVelocity<1, DiscreteWhiteNoise> motion{.noise = {.sigma_a = 0.1}};
  const Position<1> sensor{.sigma_m = Position<1>::Vector(50.0)};
  KalmanFilter<2> filter(Eigen::Vector2d::Zero(), Eigen::Vector2d(1e6, 1e5).asDiagonal());

  RandomStream noise({.seed = 1}, StreamId::measurement);
  for (int k = 1; k <= 20; ++k) {
    const double position_m = 200.0 * k;
    const Position<1>::Vector z(noise.normal() * 50.0 + position_m);
    filter.predict(motion, 1.0);
    const auto update = filter.update(sensor, z);
    if (update.status != StepStatus::ok) return 1;
    std::printf("%2d s  measured %+7.1f m  estimated %+6.1f m from the truth, at %5.1f m/s  NIS %.2f\n", k,
                z[0] - position_m, filter.x()[0] - position_m, filter.x()[1], update.nis);
  }
}
