// SPDX-License-Identifier: Apache-2.0
// What plots need of a correction beside its figures: who held it back at each step, which of its rules fired, and what
// its features were beside what it was taught on. Kept only where a comparison is asked for it.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "truebearing/core/constants.hpp"
#include "truebearing/correction/correction.hpp"
#include "truebearing/evaluation/tally_stream.hpp"

namespace truebearing {

struct CorrectionDetails {
  std::shared_ptr<const CorrectionModel> model;
  double kappa = kInfinity;
  std::string bounds;  ///< "kappa 3, gate, no referee"

  /// [step], means over runs and tracks; NaN where nothing was corrected.
  std::vector<double> gate;           ///< of the weight of what the network says: the box's times the referee's
  std::vector<double> box, referee;   ///< each by itself, where the network was asked
  std::vector<double> limited;        ///< share of the steps in which kappa limited
  std::vector<double> handed_over;    ///< the fallback's share of what was trusted
  std::vector<double> wanted_sigmas;  ///< length of the correction before kappa, and of what was published
  std::vector<double> moved_sigmas;

  double steps = 0.0, asked = 0.0;  ///< how many were corrected; in how many of them the network was asked

  struct Rule {
    double fired = 0.0;      ///< mean normalised strength, in [0, 1]
    double strongest = 0.0;  ///< share of the steps in which no other was stronger
  };
  std::vector<Rule> rules;  ///< [rule], over the steps in which the network was asked; empty where it has none

  struct Feature {
    double mean = kNaN, deviation = kNaN, least = kNaN, greatest = kNaN;
    double outside =
        0.0;  ///< share of the steps outside the box of the model's gate, in force or not; 0 where there is none
    std::vector<double> counted;  ///< steps in each of kBins bins over mean -+ clip scale of the network's input
  };
  static constexpr std::size_t kBins = 80;
  std::vector<Feature> features;                               ///< [feature]
  double outside_intervals = 0.0, outside_disagreement = 0.0;  ///< shares likewise
};

/// Takes the steps of one correction, run by run.
class CorrectionTally {
 public:
  explicit CorrectionTally(const Correction& correction);

  /// What correct() gave at one step of a run, counted from 0.
  void take(std::size_t step, std::span<const StepRecord> records, std::span<const CorrectionAccount> accounts);
  /// Another run of the same correction.
  void add(const CorrectionTally& run);
  void exchange(TallyStream& stream);
  CorrectionDetails details() const;

 private:
  struct Step {
    double corrected = 0.0, asked = 0.0, measured = 0.0;  // how many; with a length
    double gate = 0.0, box = 0.0, referee = 0.0, limited = 0.0, handed_over = 0.0, wanted = 0.0, moved = 0.0;
  };
  static constexpr std::array kSums{&Step::corrected, &Step::asked,   &Step::measured,    &Step::gate,   &Step::box,
                                    &Step::referee,   &Step::limited, &Step::handed_over, &Step::wanted, &Step::moved};
  struct Feature {
    double sum = 0.0, squares = 0.0, least = kInfinity, greatest = -kInfinity, outside = 0.0;
    std::vector<double> counted = std::vector<double>(CorrectionDetails::kBins);
  };
  void take_features(const CorrectionAccount& account);
  void take_rules(const CorrectionAccount& account);

  std::shared_ptr<const CorrectionModel> model_;
  double kappa_;
  std::optional<BoxGate> gate_;
  std::string bounds_;
  std::vector<Step> steps_;
  std::vector<CorrectionDetails::Rule> rules_;  // sums
  std::vector<Feature> features_;
  double outside_intervals_ = 0.0, outside_disagreement_ = 0.0;
};

}  // namespace truebearing
