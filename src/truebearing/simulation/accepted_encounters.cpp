// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/accepted_encounters.hpp"

#include <cmath>

#include "truebearing/measurement/bearing.hpp"
#include "truebearing/measurement/posterior_information.hpp"
#include "truebearing/motion/constant_velocity.hpp"

namespace truebearing {

BoundedVector Encounter::target_at(double time_s) const {
  const SensorState vessel = target.at(time_s).state;
  BoundedVector x(tone ? 5 : 4);
  x.head<2>() = vessel.position_m;
  x.segment<2>(2) = vessel.velocity_mps;
  if (tone) x[4] = tone->at(time_s);
  return x;
}

bool AcceptedEncounters::accepts(const Encounter& encounter, const Sonar& sensor) const {
  const ConstantVelocity<2, ContinuousWhiteNoise> steady{};
  PosteriorInformation<4> information;
  const Eigen::Vector4d x0 = encounter.target_at(0.0).head<4>();
  Eigen::Vector2d last_m = Eigen::Vector2d::Zero();
  for (int k = 0; k < encounter.steps; ++k) {
    const double time_s = k * encounter.period_s;
    const auto [own_ship, turning] = encounter.own_ship.at(time_s);
    last_m = encounter.target.at(time_s).state.position_m - own_ship.position_m;
    if (last_m.norm() < closest_m) return false;
    if (!range_bound_percent) continue;
    if (k > 0) information.predict(steady.F(encounter.period_s), steady.Q(encounter.period_s));
    if (turning && sensor.masked_in_turns) continue;
    information.update(Bearing<>{own_ship.position_m, own_ship.velocity_mps, sensor.sigma_rad},
                       Eigen::Vector4d(steady.F(time_s) * x0));
  }
  if (!determines_position(encounter, sensor)) return false;
  if (!range_bound_percent) return true;
  const std::optional<Eigen::Matrix4d> P = information.covariance();
  if (!P) return false;
  const Eigen::Vector2d u = last_m.normalized();
  const double sigma_m = std::sqrt(u.dot(P->topLeftCorner<2, 2>() * u));
  return 100.0 * sigma_m < *range_bound_percent * last_m.norm();
}

bool AcceptedEncounters::determines_position(const Encounter& encounter, const Sonar& sensor) const {
  if (!position_bound) return true;
  const auto [most_m, at_s] = *position_bound;
  const bool of_source = encounter.tone.has_value();
  const Eigen::Vector4d x0 = encounter.target_at(0.0).head<4>();
  const double frequency_hz = of_source ? encounter.tone->at(0.0) : 0.0;
  const ConstantVelocity<2, ContinuousWhiteNoise> steady{};
  // About the state at at_s, without the frequency where there is none.
  PosteriorInformation<Eigen::Dynamic> information(of_source ? 5 : 4);
  for (int k = 0; k < encounter.steps && k * encounter.period_s <= at_s; ++k) {
    const double time_s = k * encounter.period_s;
    const auto [own_ship, turning] = encounter.own_ship.at(time_s);
    if (turning && sensor.masked_in_turns) continue;
    Eigen::Matrix<double, 5, 1> x;
    x << steady.F(time_s) * x0, frequency_hz;
    Eigen::Matrix<double, 5, Eigen::Dynamic> Phi =
        Eigen::Matrix<double, 5, 5>::Identity().leftCols(information.J().cols());
    Phi.topLeftCorner<4, 4>() = steady.F(time_s - at_s);
    information.update(sensor.model(own_ship, of_source), x, Phi);
  }
  const std::optional<Eigen::MatrixXd> P = information.covariance();
  return P && std::sqrt(P->topLeftCorner<2, 2>().trace()) < most_m;
}

AcceptedEncounters read_accepted_encounters(TableReader table, double duration_s) {
  AcceptedEncounters accepted;
  accepted.closest_m = table.number_or("closest_m", 0.0, kNonNegative);
  if (table.has("range_bound_percent")) accepted.range_bound_percent = table.number("range_bound_percent", kPositive);
  if (table.has("position_bound_m") || table.has("position_bound_at_s"))
    accepted.position_bound = {table.number("position_bound_m", kPositive),
                               table.number("position_bound_at_s", {0.0, duration_s})};
  table.finish();
  return accepted;
}

}  // namespace truebearing
