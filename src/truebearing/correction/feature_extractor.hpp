// SPDX-License-Identifier: Apache-2.0
// FeatureExtractor: from the records of a base tracker and its companions to the inputs of a network. Training and
// tracking share this one class, so that both see the same numbers.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "truebearing/correction/feature.hpp"
#include "truebearing/correction/fuzzy_network.hpp"
#include "truebearing/correction/interval_memory.hpp"
#include "truebearing/tracker/step_record.hpp"

namespace truebearing {

class FeatureExtractor {
 public:
  using Features = FuzzyNetwork::Inputs;

  FeatureExtractor() = default;
  /// The blocks in the records of a tracker, by its name; of the base for an empty name.
  using BlocksOf = std::function<RecordBlocks(const std::string&)>;

  /// space: of the base's state; frame: that the features' components are of. Throws InputError where a feature names a
  /// component that the space has not, a constant is out of range, a block that it reads is not in its tracker's
  /// records, or there are more features than a network takes.
  FeatureExtractor(std::vector<FeatureSpec> features, const StateSpace& space, Frame frame, const BlocksOf& blocks_of);

  const std::vector<FeatureSpec>& features() const { return features_; }
  int size() const { return static_cast<int>(features_.size()); }
  /// Names of the companions, each once; extract() wants their records in this order.
  const std::vector<std::string>& companions() const { return companions_; }

  /// The features (d) of this step. Averages advance with every step in which the base used its measurement and hold in
  /// between; a new track starts them afresh. A companion without a record gives NaN. No allocation.
  void extract(const StepRecord& base, std::span<const StepRecord* const> companions, Features& features);
  void reset();
  /// Of the base's track, up to the last step.
  const Intervals& intervals() const { return interval_memory_.intervals(); }
  /// The rotation into the frame for the base's estimate of the last step.
  const FrameRotation& rotation() const { return rotation_; }

 private:
  // What only a used measurement gives, or an average of it; features that ask for the same share one.
  struct Memory {
    FeatureKind kind;
    int companion;  // -1: none
    double alpha;
    int mode;
    BoundedVector value = BoundedVector::Zero(1);     // a number, or a vector in the state's own frame
    double used = 0.0;                                // steps in which the measurement was used
    std::array<double, kMaxDimension> in_frame = {};  // of a vector; zero before the first used measurement
    Eigen::Index framed = 0;                          // how many of these say something; -1: none is a number
  };
  // A component of what is remembered, and nothing else.
  struct RememberedTerm {
    Eigen::Index place;  // among the features
    std::size_t memory;
    int component;
    double deviation;  // of an average, if what is averaged is white; else 1
  };
  struct Term {
    Eigen::Index place;
    FeatureKind kind;
    int component;
    int companion;       // -1: none
    std::size_t memory;  // its place in memories_, where the kind has one
    double offset, scale;
    bool scale_is_sigma;
    int mode;
    int sensor;
  };

  std::size_t memory_of(FeatureKind kind, int companion, double alpha, int mode);
  void begin_track(const StepRecord& base);
  void remember(Memory& memory, const StepRecord& record);
  void turn(Memory& memory, bool is_known) const;
  const BoundedVector& normalised_innovation(const StepRecord& record);
  double value(const Term& term, const StepRecord& base, const StepRecord* companion) const;

  Frame frame_ = Frame::state;
  std::vector<FeatureSpec> features_;
  std::vector<std::string> companions_;
  std::vector<RememberedTerm> remembered_;
  std::vector<Term> terms_;  // the others
  std::vector<Memory> memories_;
  bool wants_sigma_ = false;
  bool wants_gain_ = false;
  FrameRotation rotation_;  // of this step
  BoundedVector sigma_;     // the base's standard deviations in the frame, where a feature wants them
  BoundedMatrix gain_;      // of the last used measurement
  // Of this step the innovation that was normalised last, and whose: several features in turn ask for that of one.
  const StepRecord* normalised_of_ = nullptr;
  BoundedVector normalised_;
  IntervalMemory interval_memory_;
  int track_ = -1;
  double began_s_ = 0.0;
  double log_first_range_ = 0.0;
  double steps_ = 0.0;
};

}  // namespace truebearing
