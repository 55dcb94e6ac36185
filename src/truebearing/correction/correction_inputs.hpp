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
/// standard deviations there. Of states of n components, in vectors of any type that has a size.
class OutputUnits {
 public:
  /// base: its record of the step; it outlives this.
  OutputUnits(const FrameRotation& rotation, const StepRecord& base, bool in_sigma)
      : rotation_(rotation), base_(base), in_sigma_(in_sigma) {}

  /// Makes of a network's output y (n) the difference of states that it stands for: T' D y.
  template <typename Vector>
  void to_state(Vector& y) const {
    if (in_sigma_) y = y.cwiseProduct(scale());
    rotation_.turn(y);
  }
  BoundedVector state(BoundedVector y) const {
    to_state(y);
    return y;
  }
  /// The way back: D^-1 T d.
  BoundedVector output(const BoundedVector& d) const { return inverse().cwiseProduct(rotation_.vector(d)); }
  /// A covariance of states (n x n) in the frame, and in the units of the output.
  BoundedMatrix in_frame(const BoundedMatrix& P) const { return rotation_.covariance(P); }
  BoundedMatrix output_covariance(const BoundedMatrix& P) const {
    return inverse().asDiagonal() * in_frame(P) * inverse().asDiagonal();
  }

  /// Makes of the covariance P of `covariance_of` (n x n) the correction's own: NetworkAnswer::make_own(), turned back.
  template <typename Matrix>
  void own_covariance(const NetworkAnswer& answer, Matrix& P) const {
    answer.make_own(P, [&] { return rotation_.variances(P).cwiseSqrt().eval(); });
    if (answer.moments.size() > 0) rotation_.turn_covariance(P);
  }
  const FrameRotation& rotation() const { return rotation_; }

 private:
  BoundedVector scale() const {  // D (n)
    if (!in_sigma_) return BoundedVector::Ones(base_.x.size());
    return rotation_.variances(base_.P).cwiseSqrt();
  }
  BoundedVector inverse() const { return scale().cwiseInverse(); }

  const FrameRotation& rotation_;
  const StepRecord& base_;
  bool in_sigma_;
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
