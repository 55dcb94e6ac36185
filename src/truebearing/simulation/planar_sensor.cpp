// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/planar_sensor.hpp"

#include <cmath>
#include <stdexcept>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/linear_algebra.hpp"
#include "truebearing/measurement/range_rate.hpp"

namespace truebearing {

namespace {

double bearing_of(const Eigen::Vector4d& state) {
  return std::atan2(state.x(), state.y());
}

double range_rate_of(const Eigen::Vector4d& state) {
  return state.tail<2>().dot(state.head<2>().stableNormalized());
}

const std::vector<PlanarOutput>& table() {
  static const std::vector<PlanarOutput> the_table{
      {"plane",
       Measured::position(2),
       [](const Eigen::Vector4d& state) -> BoundedVector { return state.head<2>(); },
       {}},
      {"range",
       Measured::position(1),
       [](const Eigen::Vector4d& state) -> BoundedVector { return BoundedVector::Constant(1, state.head<2>().norm()); },
       {}},
      {"range_bearing",
       Measured::range_bearing(),
       [](const Eigen::Vector4d& state) -> BoundedVector {
         return Eigen::Vector2d(state.head<2>().norm(), bearing_of(state));
       },
       {"bearing_sigma_deg"},
       1},
      {"range_bearing_rate",
       RangeBearingRate<>::measured(),
       [](const Eigen::Vector4d& state) -> BoundedVector {
         return Eigen::Vector3d(state.head<2>().norm(), bearing_of(state), range_rate_of(state));
       },
       {"bearing_sigma_deg", "range_rate_sigma_mps"},
       1},
      {"range_range_rate",
       RangeAndRate::measured(),
       [](const Eigen::Vector4d& state) -> BoundedVector {
         return Eigen::Vector2d(state.head<2>().norm(), range_rate_of(state));
       },
       {"range_rate_sigma_mps"}},
      {"range_rate",
       RangeRate::measured(),
       [](const Eigen::Vector4d& state) -> BoundedVector { return BoundedVector::Constant(1, range_rate_of(state)); },
       {"range_rate_sigma_mps"}},
  };
  return the_table;
}

// In radians or as it stands, by the unit in the key's name.
double read_sigma(TableReader& sensor, const std::string& key) {
  if (key.ends_with("_deg")) return radians(sensor.number(key, {0.0, 90.0, true}));
  return sensor.number(key, kPositive);
}

}  // namespace

const PlanarOutput& planar_output(const std::string& name) {
  for (const PlanarOutput& output : table())
    if (output.name == name) return output;
  throw std::out_of_range("no output of a sensor in the plane: " + name);
}

std::vector<std::string> planar_outputs() {
  std::vector<std::string> names;
  for (const PlanarOutput& output : table()) names.push_back(output.name);
  return names;
}

Measurement PlanarSensor::measure(double time_s, const Eigen::Vector4d& state, double drawn_sigma_m,
                                  RandomStream& stream) const {
  Measurement taken;
  taken.time_s = time_s;
  Eigen::Vector4d seen = state;
  if (false_share > 0.0 && stream.uniform() < false_share) {
    const double distance_m = false_radius_m * std::sqrt(stream.uniform()), course_rad = stream.uniform(-kPi, kPi);
    seen.head<2>() += distance_m * Eigen::Vector2d(std::sin(course_rad), std::cos(course_rad));
  }
  taken.z = output->h(seen);
  BoundedVector sigma = BoundedVector::Constant(taken.z.size(), drawn_sigma_m);
  sigma.tail(further_sigma.size()) = further_sigma;
  BoundedVector noise(sigma.size());
  for (double& value : noise) value = stream.normal();
  if (const double rho = range_rate_correlation; rho != 0.0)
    noise.tail<1>()[0] = rho * noise[0] + std::sqrt(1.0 - rho * rho) * noise.tail<1>()[0];
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
  if (output->bearing >= 0) taken.z[output->bearing] = wrap_pi(taken.z[output->bearing]);
  if (reported) taken.sigma = sigma;
  return taken;
}

PlanarSensor read_planar_sensor(TableReader table, const std::string& output) {
  constexpr double kNearlyOne = 0.999;
  PlanarSensor sensor;
  sensor.output = &planar_output(output);
  const std::vector<std::string>& further = sensor.output->sigma_keys;
  sensor.further_sigma.resize(static_cast<Eigen::Index>(further.size()));
  if (!further.empty()) {
    if (further.size() < sensor.output->measured.components.size())
      sensor.sigma_m = read_distribution(table, "range_sigma_m", kPositive);
    for (std::size_t i = 0; i < further.size(); ++i)
      sensor.further_sigma[static_cast<Eigen::Index>(i)] = read_sigma(table, further[i]);
  } else if (output == "plane" && table.has("position_covariance_m2")) {
    const std::vector<double> R = table.numbers("position_covariance_m2", 4);
    sensor.R_m2 = Eigen::Map<const Eigen::Matrix2d>(R.data());
    Eigen::Matrix2d L;
    if (R[1] != R[2] || !cholesky(*sensor.R_m2, L))
      throw table.error("position_covariance_m2", "is no covariance", "a symmetric positive definite 2 x 2 matrix");
  } else {
    sensor.sigma_m = read_distribution(table, "position_sigma_m", kPositive);
  }
  if (further.size() < sensor.output->measured.components.size() && !further.empty() &&
      further.back() == "range_rate_sigma_mps")
    sensor.range_rate_correlation = table.number_or("range_rate_correlation", 0.0, {-kNearlyOne, kNearlyOne});
  sensor.outlier_share = table.number_or("outlier_share", 0.0, {0.0, 1.0});
  sensor.outlier_factor = table.number_or("outlier_factor", 1.0, kPositive);
  sensor.false_share = table.number_or("false_share", 0.0, {0.0, 1.0});
  if (sensor.false_share > 0.0 || table.has("false_radius_m"))
    sensor.false_radius_m = table.number("false_radius_m", kPositive);
  sensor.reported = table.boolean_or("reported", false);
  table.finish();
  return sensor;
}

}  // namespace truebearing
