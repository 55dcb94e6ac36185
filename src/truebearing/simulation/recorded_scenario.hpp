// A recorded track as a scenario: the truth is the recording's own, and every run measures it afresh with Gaussian
// noise of the recording's sigma. What the recording did not measure stays missing.
#pragma once

#include <optional>
#include <vector>

#include "truebearing/simulation/scenario.hpp"

namespace truebearing {

class RecordedScenario final : public Scenario {
 public:
  /// `sigma`, in the unit of the measured columns, stands in where the recording carries none. Throws InputError where
  /// the recording has no truth, a measured column is no component of it, or a sigma is missing.
  explicit RecordedScenario(Recording recorded, std::optional<double> sigma = std::nullopt);

  Recording simulate(const RunKey& key) const override;
  const StateSpace& truth_space() const override { return *recorded_.truth_space; }

 private:
  Recording recorded_;
  std::vector<Eigen::Index> components_;  // of the truth, by component of z
  std::optional<double> sigma_;
};

}  // namespace truebearing
