// SPDX-License-Identifier: Apache-2.0
// A scripted flight in the East-North plane: legs at constant velocity, constant turn rate or constant acceleration,
// one after the other, the same in every run; the noise differs. For published scenarios. Sampled at 0, period, ... to
// the end of the last leg.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "truebearing/simulation/planar_sensor.hpp"
#include "truebearing/simulation/scenario.hpp"

namespace truebearing {

struct PlanarLeg {
  double duration_s = 0.0;
  double turn_rate_radps = 0.0;                                 ///< clockwise, to starboard
  Eigen::Vector2d acceleration_mps2 = Eigen::Vector2d::Zero();  ///< East, North
  int phase = 0;                                                ///< place in PlanarLegsParameters::phases
};

struct PlanarLegsParameters {
  double period_s = 1.0;
  Eigen::Vector4d start = Eigen::Vector4d::Zero();  ///< [east_m, north_m, east_mps, north_mps]
  std::vector<PlanarLeg> legs;
  std::vector<std::string> phases;  ///< names that legs are reported under; empty where they have none
  PlanarSensor sensor;
};

class PlanarLegsScenario final : public Scenario {
 public:
  explicit PlanarLegsScenario(PlanarLegsParameters parameters) : parameters_(std::move(parameters)) {}
  Recording simulate(const RunKey& key) const override;
  const StateSpace& truth_space() const override { return plane_space(); }
  std::optional<Measured> measured() const override { return parameters_.sensor.measured(); }
  bool reports_sigma() const override { return parameters_.sensor.reported; }

 private:
  PlanarLegsParameters parameters_;
};

std::unique_ptr<Scenario> read_planar_legs_scenario(TableReader& table);

}  // namespace truebearing
