#include "truebearing/simulation/planar_sensor.hpp"

#include <cmath>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/linear_algebra.hpp"

namespace truebearing {

Measured PlanarSensor::measured() const {
  switch (output) {
    case Output::range:
      return Measured::position(1);
    case Output::range_bearing:
      return Measured::range_bearing();
    case Output::position:
      break;
  }
  return Measured::position(2);
}

Measurement PlanarSensor::measure(double time_s, const Eigen::Vector2d& position_m, double drawn_sigma_m,
                                  RandomStream& stream) const {
  Measurement taken;
  taken.time_s = time_s;
  BoundedVector sigma = BoundedVector::Constant(output == Output::range ? 1 : 2, drawn_sigma_m);
  switch (output) {
    case Output::position:
      taken.z = position_m;
      break;
    case Output::range:
      taken.z = BoundedVector::Constant(1, position_m.norm());
      break;
    case Output::range_bearing:
      taken.z = Eigen::Vector2d(position_m.norm(), std::atan2(position_m.x(), position_m.y()));
      sigma[1] = bearing_sigma_rad;
      break;
  }
  BoundedVector noise(sigma.size());
  for (double& value : noise) value = stream.normal();
  if (R_m2) {
    Eigen::Matrix2d L;
    cholesky(*R_m2, L);
    noise = L * Eigen::Vector2d(noise);
    sigma = R_m2->diagonal().cwiseSqrt();
  } else {
    noise.array() *= sigma.array();
  }
  if (outlier_share > 0.0 && stream.uniform() < outlier_share) noise *= outlier_factor;
  taken.z += noise;
  if (output == Output::range_bearing) taken.z[1] = wrap_pi(taken.z[1]);
  if (reported) taken.sigma = sigma;
  return taken;
}

PlanarSensor read_planar_sensor(TableReader table, PlanarSensor::Output output) {
  PlanarSensor sensor;
  sensor.output = output;
  if (output == PlanarSensor::Output::range_bearing) {
    sensor.sigma_m = read_distribution(table, "range_sigma_m", kPositive);
    sensor.bearing_sigma_rad = radians(table.number("bearing_sigma_deg", {0.0, 90.0, true}));
  } else if (output == PlanarSensor::Output::position && table.has("position_covariance_m2")) {
    const std::vector<double> R = table.numbers("position_covariance_m2", 4);
    sensor.R_m2 = Eigen::Map<const Eigen::Matrix2d>(R.data());
    Eigen::Matrix2d L;
    if (R[1] != R[2] || !cholesky(*sensor.R_m2, L))
      throw table.error("position_covariance_m2", "is no covariance", "a symmetric positive definite 2 x 2 matrix");
  } else {
    sensor.sigma_m = read_distribution(table, "position_sigma_m", kPositive);
  }
  sensor.outlier_share = table.number_or("outlier_share", 0.0, {0.0, 1.0});
  sensor.outlier_factor = table.number_or("outlier_factor", 1.0, kPositive);
  sensor.reported = table.boolean_or("reported", false);
  table.finish();
  return sensor;
}

}  // namespace truebearing
