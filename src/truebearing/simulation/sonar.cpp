// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/sonar.hpp"

#include <cmath>

#include "truebearing/core/angle.hpp"

namespace truebearing {

BearingFrequency<> Sonar::model(const SensorState& own_ship, bool of_source) const {
  return {own_ship.position_m, own_ship.velocity_mps, sigma_rad, frequency_sigma_hz, sound_mps, true, of_source};
}

Measurement Sonar::measure(double time_s, const VesselPath::State& own_ship, const BoundedVector& target,
                           RandomStream& noise) const {
  const Eigen::Vector2d offset_m = target.head<2>() - own_ship.state.position_m;
  Measurement taken;
  taken.time_s = time_s;
  taken.sensor = own_ship.state;
  if (reported) taken.sigma = BoundedVector::Constant(1, sigma_rad);
  // Drawn for missing values too: the noise of step k depends on k alone.
  const double error = sigma_rad * noise.normal();
  const bool outlier = noise.uniform() < outlier_share, dropped = noise.uniform() < dropout_share;
  const double bearing = std::atan2(offset_m.x(), offset_m.y()) + (outlier ? outlier_factor : 1.0) * error;
  const bool missing = dropped || (own_ship.turning && masked_in_turns) || !offset_m.allFinite();
  taken.z = BoundedVector::Constant(1, missing ? std::nan("") : wrap_pi(bearing));
  if (const bool of_source = target.size() == 5) {
    const double heard_hz =
        model(own_ship.state, of_source).h(target.head<5>())(1) + frequency_sigma_hz * noise.normal();
    const bool unheard = noise.uniform() < frequency_dropout_share;
    taken.z.conservativeResize(2);
    taken.z[1] = missing || unheard ? std::nan("") : heard_hz;
    if (reported) taken.sigma = Eigen::Vector2d(sigma_rad, frequency_sigma_hz);
  }
  return taken;
}

Sonar read_sonar(TableReader table, bool of_source) {
  constexpr Range kShare{0.0, 1.0};
  Sonar sonar;
  sonar.sigma_rad = radians(table.number("bearing_sigma_deg", {0.0, 90.0, true}));
  sonar.dropout_share = table.number_or("dropout_share", 0.0, kShare);
  sonar.outlier_share = table.number_or("outlier_share", 0.0, kShare);
  sonar.outlier_factor = table.number_or("outlier_factor", 1.0, kPositive);
  sonar.masked_in_turns = table.boolean_or("masked_in_turns", false);
  sonar.reported = table.boolean_or("reported", true);
  if (of_source) {
    sonar.frequency_sigma_hz = table.number("frequency_sigma_hz", kPositive);
    sonar.frequency_dropout_share = table.number_or("frequency_dropout_share", 0.0, kShare);
    sonar.sound_mps = table.number_or("sound_mps", kSoundInWater_mps, kPositive);
  }
  table.finish();
  return sonar;
}

}  // namespace truebearing
