// SPDX-License-Identifier: Apache-2.0
// A target on a line at constant velocity, with white process noise, whose position a sensor measures once per period:
//   x_k = F x_{k-1} + w_k, w_k ~ N(0, scale diag(process_noise_variance)),  z_k = position_k + v_k,  k = 1..steps.
// With velocity_sigma_mps it measures the velocity too. Over gaps of another length (simulation/look_schedule.hpp) the variance of w grows with the time.
// The radar of Lee et al.; the keys of kind = "line" are the fields below.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "truebearing/simulation/distribution.hpp"
#include "truebearing/simulation/look_schedule.hpp"
#include "truebearing/simulation/scenario.hpp"

namespace truebearing {

/// Noise that is Gaussian of one variance or another, drawn for each measurement.
struct NoiseMixture {
  std::vector<double> shares;            ///< probabilities
  std::vector<double> variance_factors;  ///< of the sensor's variance, one for each
};

struct LineParameters {
  double period_s = 1.0;
  int steps = 1;
  Distribution position_m = 0.0;                                     ///< [target] at k = 0
  Distribution velocity_mps = 0.0;                                   ///< [target] at k = 0
  Eigen::Vector2d process_noise_variance = Eigen::Vector2d::Zero();  ///< per period: m^2, (m/s)^2
  Distribution process_noise_scale = 1.0;
  Distribution noise = 1.0;                        ///< [sensor] position_sigma_m, or
  bool noise_is_variance = false;                  ///< position_variance_m2
  std::optional<Distribution> velocity_sigma_mps;  ///< [sensor] where it measures the velocity too
  std::optional<NoiseMixture> mixture;             ///< [sensor]
  bool reported = false;  ///< [sensor] does a measurement carry its sigma, of a mixture the drawn one?
  LookSchedule looks;     ///< [looks]
};

class LineScenario final : public Scenario {
 public:
  explicit LineScenario(LineParameters parameters) : parameters_(std::move(parameters)) {}
  Recording simulate(const RunKey& key) const override;
  const StateSpace& truth_space() const override { return line_space(); }
  std::optional<Measured> measured() const override;
  bool reports_sigma() const override { return parameters_.reported; }

 private:
  LineParameters parameters_;
};

std::unique_ptr<Scenario> read_line_scenario(TableReader& table);

}  // namespace truebearing
