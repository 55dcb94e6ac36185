// SPDX-License-Identifier: Apache-2.0
// The Lorenz attractor (motion/lorenz.hpp), measured once per period:
//   x_k = f(x_{k-1}) + w_k, w_k ~ N(0, process_sigma^2 I),  z_k = U x_k + v_k, v_k ~ N(0, sigma^2 I),  k = 1..steps
// with f by pieces much finer than the period, and U a rotation that a filter may not know of. Over gaps of another length
// (simulation/look_schedule.hpp) the variance of w grows with the time. The keys of kind = "lorenz" are the fields below.
#pragma once

#include <array>
#include <memory>
#include <utility>
#include <variant>
#include <vector>

#include "truebearing/motion/lorenz.hpp"
#include "truebearing/simulation/distribution.hpp"
#include "truebearing/simulation/look_schedule.hpp"
#include "truebearing/simulation/scenario.hpp"

namespace truebearing {

using AnyLorenzMotion = std::variant<LorenzMotion<LorenzTaylor>, LorenzMotion<LorenzRungeKutta>>;

struct LorenzParameters {
  double period_s = 0.02;
  int steps = 1;
  AnyLorenzMotion truth = LorenzMotion<LorenzTaylor>{{}, 1e-5};  ///< [truth] model, terms, step_s
  double process_sigma = 0.0;                                    ///< per period and component
  std::array<Distribution, 3> start{1.0, 1.0, 1.0};              ///< [start] x, y, z,
  double burn_in_s = 0.0;    ///< and how long before time 0 that was: the attractor forgets it
  Distribution sigma = 1.0;  ///< [sensor]
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< U; rotation_deg about x, then y, then z
  bool reported = false;                                   ///< does a measurement carry its sigma?
  /// The truth beside a measurement is the state so many measurements later, as where the next one is to be predicted.
  int lead_steps = 0;
  LookSchedule looks;  ///< [looks]
};

class LorenzScenario final : public Scenario {
 public:
  explicit LorenzScenario(LorenzParameters parameters) : parameters_(std::move(parameters)) {}
  Recording simulate(const RunKey& key) const override;
  const StateSpace& truth_space() const override { return lorenz_space(); }
  std::optional<Measured> measured() const override { return Measured::lorenz(); }
  bool reports_sigma() const override { return parameters_.reported; }

 private:
  LorenzParameters parameters_;
};

std::unique_ptr<Scenario> read_lorenz_scenario(TableReader& table);

/// model = "lorenz_taylor" with `terms`, or "lorenz_rk4"; step_s. Does not finish the table.
AnyLorenzMotion read_lorenz_motion(TableReader& table, double sigma);

/// Rz Ry Rx of angles (roll about x, pitch about y, yaw about z) in degrees.
Eigen::Matrix3d rotation_of(const std::vector<double>& roll_pitch_yaw_deg);

}  // namespace truebearing
