// SPDX-License-Identifier: Apache-2.0
// The sensor of an own ship that listens: it measures the bearing of a target and, of a source, the frequency that is
// heard with its Doppler shift (bearing_frequency.hpp). Noise is Gaussian, with dropouts and outliers where asked for;
// while own ship turns, measurements may be missing. The table [sensor] of scenarios of bearings.
#pragma once

#include "truebearing/core/random.hpp"
#include "truebearing/io/table_reader.hpp"
#include "truebearing/measurement/bearing_frequency.hpp"
#include "truebearing/measurement/measurement.hpp"
#include "truebearing/simulation/vessel.hpp"

namespace truebearing {

struct Sonar {
  double sigma_rad = 0.0;
  double dropout_share = 0.0;    ///< probability that a measurement is missing
  double outlier_share = 0.0;    ///< probability that a bearing's noise is
  double outlier_factor = 1.0;   ///< that many times as large
  bool masked_in_turns = false;  ///< is a measurement missing while own ship turns?
  bool reported = true;          ///< does a measurement carry its standard deviations?
  double frequency_sigma_hz = 0.0;
  double frequency_dropout_share = 0.0;  ///< probability that the frequency alone is missing
  double sound_mps = kSoundInWater_mps;  ///< speed of sound

  /// What it measures without noise from there: the bearing, and the frequency where the target is a source.
  BearingFrequency<> model(const SensorState& own_ship, bool of_source) const;

  /// The measurement of a target in state [east, north, v_east, v_north]: z = [bearing]; of a source, whose state ends
  /// in its frequency, z = [bearing, frequency]. What an unknown component of the state leaves unknown is missing.
  Measurement measure(double time_s, const VesselPath::State& own_ship, const BoundedVector& target,
                      RandomStream& noise) const;
};

Sonar read_sonar(TableReader table, bool of_source);

}  // namespace truebearing
