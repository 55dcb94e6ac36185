// SPDX-License-Identifier: Apache-2.0
// The one table from names of motions in study files to motion models, on the line, in the plane, in space, and with the
// frequency of a source behind the velocities.
#pragma once

#include <memory>
#include <vector>

#include "truebearing/filter/filter_kinds.hpp"
#include "truebearing/io/table_reader.hpp"
#include "truebearing/motion/any_motion.hpp"

namespace truebearing {

/// What the state of a motion is to have.
struct MotionLayout {
  int dimensions = 1;                 ///< 1, 2 or 3
  bool has_frequency = false;         ///< of a source, behind the velocities; in the plane only
  double frequency_q_hz2ps = 0.0;     ///< its random walk
  double process_noise_factor = 1.0;  ///< of the motion's process noise covariance, as hypotheses of a bank have it
  bool is_lorenz = false;             ///< the Lorenz attractor's, which has neither positions nor velocities
};

/// { model, ... }: asks for all keys of `motion` and finishes it. Throws InputError.
std::shared_ptr<const AnyMotion> read_motion(TableReader motion, const MotionLayout& layout);

/// Of a multiple model.
struct ModeChoice {
  std::shared_ptr<const AnyMotion> motion;
  double sigma_factor = 1.0;  ///< of the standard deviations of what is measured
};

/// [[modes]]: motions, one each, or with turn_rates_degps one for each rate, with a sigma_factor; 2 to kMaxModes of them.
/// Throws InputError also where two of them have no state that both begin.
std::vector<ModeChoice> read_modes(TableReader& tracker, const MotionLayout& layout);

}  // namespace truebearing
