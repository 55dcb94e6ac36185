// SPDX-License-Identifier: Apache-2.0
// CorrectionInputs: what the network of a correction is told of an ensemble's step, and in which units it answers.
// Training and tracking share this one class, so that a network meets what it was taught on.
#pragma once

#include <vector>

#include "truebearing/correction/correction_design.hpp"
#include "truebearing/correction/feature_extractor.hpp"
#include "truebearing/tracker/ensemble.hpp"

namespace truebearing {

/// The frame and the units of a network's output at one step: T, the rotation into the frame, and D, 1 or the base's
/// standard deviations there.
class OutputUnits {
 public:
  /// base: its record of the step.
  OutputUnits(const FrameRotation& rotation, const StepRecord& base, bool in_sigma);

  /// Differences of states (n) that the network's output (n) stands for: T' D y.
  BoundedVector state(const BoundedVector& output) const { return rotation_.vector(scale_.cwiseProduct(output)); }
  /// The way back: D^-1 T d.
  BoundedVector output(const BoundedVector& d) const { return inverse().cwiseProduct(rotation_.vector(d)); }
  /// A covariance of states (n x n) in the frame, and in the units of the output.
  BoundedMatrix in_frame(const BoundedMatrix& P) const { return rotation_.covariance(P); }
  BoundedMatrix output_covariance(const BoundedMatrix& P) const {
    return inverse().asDiagonal() * in_frame(P) * inverse().asDiagonal();
  }

 private:
  BoundedVector inverse() const { return scale_.cwiseInverse(); }

  const FrameRotation& rotation_;
  BoundedVector scale_;  // D (n)
};

/// Index of the member of that name; throws InputError where there is none, or one of another state space.
int member_index(const Ensemble& ensemble, const std::string& name, const StateSpace& space);

class CorrectionInputs {
 public:
  using Features = FeatureExtractor::Features;

  /// What the members of a design say of one track at a step; null where one says nothing.
  struct Records {
    const StepRecord* base;
    const StepRecord* reference;
    const StepRecord* source;  ///< of the covariance

    /// Whether there is something to correct.
    bool complete() const { return base && reference && source && base->status != StepStatus::failed; }
    /// Whether they did the same with the measurement: where one of them coasts alone, nothing was taught.
    bool agree() const { return base->status == reference->status && base->status == source->status; }
  };

  /// Binds the design to the members of an ensemble by their names. `space`: of the state that is corrected. Throws
  /// InputError where a member is missing, has another state space or lacks what a feature reads.
  CorrectionInputs(const CorrectionDesign& design, const StateSpace& space, const Ensemble& ensemble);

  int base() const { return base_; }
  int reference() const { return reference_; }

  /// Of the ensemble's last step. Valid until the next one.
  Records records(const Ensemble& ensemble, int track) const;

  /// Features remember their track: each begins with a copy of this.
  const FeatureExtractor& extractor() const { return prototype_; }
  /// The network's inputs (d) at the ensemble's last step, from the base's record of a track. Every step of the track
  /// once, for the averages. No allocation.
  void extract(const Ensemble& ensemble, const StepRecord& base, FeatureExtractor& extractor, Features& features);
  /// Of that step; valid until the next.
  OutputUnits units(const FeatureExtractor& extractor, const StepRecord& base) const {
    return {extractor.rotation(), base, output_in_sigma_};
  }

 private:
  int base_;
  int reference_;
  int source_;
  bool output_in_sigma_;
  FeatureExtractor prototype_;
  std::vector<int> companions_;
  std::vector<const StepRecord*> companion_records_;
};

}  // namespace truebearing
