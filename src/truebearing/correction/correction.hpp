// SPDX-License-Identifier: Apache-2.0
// Correction: a function of the records of an ensemble,
//
//     x_corrected = x_reference + G d,  d = limit_kappa(x_base + T' D network(features) - x_reference)
//     P_corrected = A P_c A + B P_reference B + s s',  A = G^(1/2), B = (1 - G)^(1/2), s = A B d
//
// with T the rotation into the correction's frame, D its output scale (1, or the base's standard deviations there), P_c
// the covariance that the model's covariance head gives (correction_model.hpp), and G = g diag(w) the weights of what
// the network says: g of the box gate, w of the referee, one for positions and one for velocities. It is open loop:
// nothing is written back into any tracker.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "truebearing/correction/correction_bounds.hpp"
#include "truebearing/correction/correction_inputs.hpp"
#include "truebearing/correction/correction_model.hpp"
#include "truebearing/tracker/ensemble.hpp"

namespace truebearing {

/// What a network was asked at a step and who stopped what it said, beside the outcome in the record: for reports.
struct CorrectionAccount {
  NetworkInputs features;      ///< (d); empty where it was not asked
  double box = 0.0;            ///< g of the box gate; 1 where there is none
  Referee::Weights referee{};  ///< w of the referee; 1 where there is none
  Intervals intervals{};       ///< at which the base used measurements, as the gate sees them
  double disagreement = 0.0;   ///< of the network and what was trusted, likewise; 0 where there is no gate
  double wanted_sigmas = 0.0;  ///< how long the correction was before kappa; NaN where that has no value
  bool asked() const { return features.size() > 0; }
};

class Correction {
 public:
  /// Binds the model to the members of an ensemble by their names. Throws InputError where a member is missing, has
  /// another state space or lacks what a feature or the referee reads, or where model or bounds are invalid.
  Correction(std::shared_ptr<const CorrectionModel> model, const Ensemble& ensemble, CorrectionBounds bounds = {});

  /// One corrected record per track of the reference, from the ensemble's last step: an estimate, its covariance and
  /// the outcome of the correction, without a prediction, innovation or gain. Call it once per step. Valid until the
  /// next call. Allocates only when a track appears.
  std::span<const StepRecord> correct(const Ensemble& ensemble);
  void reset();

  /// How each of the records that correct() gave last came about. Valid until its next call.
  std::span<const CorrectionAccount> accounts() const { return {accounts_.data(), given_}; }

  const CorrectionModel& model() const { return *model_; }
  const std::shared_ptr<const CorrectionModel>& shared_model() const { return model_; }
  const CorrectionBounds& bounds() const { return bounds_; }
  /// The gate in force: the model's, within the bounds; nothing where these say so.
  const std::optional<BoxGate>& gate() const { return gate_; }

 private:
  struct Track {
    int id;
    bool seen;
    FeatureExtractor extractor;
    NetworkMemory memory;
    Referee referee;   // of the corrected estimate and the one that is trusted
    Referee handover;  // of the reference and the fallback
  };

  Track& track_of(int id);
  const StepRecord& trusted(const StepRecord& base, const StepRecord& reference, const StepRecord* fallback,
                            Track& track);
  void correct_record(const CorrectionInputs::Records& step, Track& track, StepRecord& corrected,
                      CorrectionAccount& account);
  template <int N>
  bool correct_state(const CorrectionInputs::Records& step, Track& track, StepRecord& corrected,
                     CorrectionAccount& account);

  std::shared_ptr<const CorrectionModel> model_;
  CorrectionBounds bounds_;
  std::optional<BoxGate> gate_;
  CorrectionInputs inputs_;
  int fallback_ = -1;  // its index in the ensemble; -1 where there is none
  std::vector<Track> tracks_;
  std::vector<StepRecord> records_;
  std::vector<CorrectionAccount> accounts_;
  std::size_t given_ = 0;  // of records_ and accounts_, by the last step
  // Work space of one step.
  StepRecord trusted_;
  double handed_over_ = 0.0;
  CorrectionInputs::Features features_;
  NetworkMemory memory_;
  NetworkAnswer answer_;
};

}  // namespace truebearing
