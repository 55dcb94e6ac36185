// SPDX-License-Identifier: Apache-2.0
// CorrectionModel: all that a trained correction is made of, as it stands in a model file. Immutable while it runs.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "truebearing/core/state_space.hpp"
#include "truebearing/correction/box_gate.hpp"
#include "truebearing/correction/correction_design.hpp"
#include "truebearing/correction/network.hpp"

namespace truebearing {

struct CorrectionModel {
  const StateSpace* space = nullptr;  ///< of the base's and the reference's state, and of the correction

  CorrectionDesign design;
  /// Configuration of every tracker that takes part, as the study spelt it: a correction belongs to these.
  std::map<std::string, std::string> trackers;

  Network network;
  std::optional<BoxGate> gate;  ///< the box that the training data filled; absent: always open

  std::map<std::string, std::string> provenance;  ///< where it comes from: study, seed, runs, version, scores

  /// The rules, where the network has these; throws std::bad_variant_access where it has none.
  const RuleBase& rules() const { return std::get<RuleBase>(network); }
  RuleBase& rules() { return std::get<RuleBase>(network); }

  /// Throws InputError where parts disagree in shape, are not finite or out of range.
  void validate() const;
};

}  // namespace truebearing
