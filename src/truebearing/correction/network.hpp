// SPDX-License-Identifier: Apache-2.0
// The network of a correction: features in, a correction and its covariance out. A kind of network is a value with
//
//     int inputs() const, outputs() const
//     int memory() const                 how many numbers it remembers of a track; 0 where each step stands alone
//     const Parameters& parameters() const    what was learned, with the normalisation of inputs and outputs
//     void answer(inputs, memory, answer) const    one step of a track; no allocation
//     void check(const CorrectionDesign&, int state) const        throws InputError where its parts disagree
//
// and a row of the variant below; teacher, gate, referee, bound and model file know no more of it.
#pragma once

#include <string>
#include <variant>

#include "truebearing/correction/gated_recurrent.hpp"
#include "truebearing/correction/network_answer.hpp"
#include "truebearing/correction/rule_base.hpp"

namespace truebearing {

using Network = std::variant<RuleBase, GatedRecurrent>;

/// What `network` says of a step whose track it remembers in `memory` (network_answer.hpp). No allocation.
inline void answer(const Network& network, const NetworkInputs& inputs, NetworkMemory& memory, NetworkAnswer& answer) {
  std::visit([&](const auto& kind) { kind.answer(inputs, memory, answer); }, network);
}

/// The memory of a track that begins.
inline NetworkMemory first_memory(const Network& network) {
  return NetworkMemory::Zero(std::visit([](const auto& kind) { return kind.memory(); }, network));
}

/// How an input is standardised before the network sees it: clip((value - mean) / scale).
struct InputScale {
  double mean, scale, clip;
};
InputScale input_scale(const Network& network, Eigen::Index input);

/// "48 rules", "48 units".
std::string describe(const Network& network);

}  // namespace truebearing
