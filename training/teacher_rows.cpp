// SPDX-License-Identifier: Apache-2.0
#include "training/teacher_rows.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "truebearing/core/chi_square.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/core/suggestion.hpp"
#include "truebearing/correction/correction_inputs.hpp"
#include "truebearing/evaluation/scorer.hpp"
#include "truebearing/evaluation/step_through.hpp"
#include "truebearing/evaluation/target_record.hpp"
#include "truebearing/tracker/smoother.hpp"

namespace truebearing {
namespace {

Eigen::Index row_size(Eigen::Index features, Eigen::Index state) {
  return features + 2 * state + 2 * state * state + 3 + 3 + state;
}

void append(const auto& values, TeacherRows& rows) {
  for (Eigen::Index i = 0; i < values.size(); ++i) rows.push_back(values.reshaped()[i]);
}

}  // namespace

// What makes the rows of a run.
class TeacherRowMakers::Maker {
 public:
  Maker(const Ensemble& ensemble, const CorrectionSpec& correction, const StateSpace& truth_space,
        std::vector<int> truth_index, bool whole_tracks)
      : whole_tracks_(whole_tracks),
        ensemble_(ensemble.fresh()),
        teacher_(ensemble_.index(correction.training.teacher)),
        from_step_(correction.training.from_step),
        every_s_(correction.training.every_s),
        truth_index_(std::move(truth_index)),
        inputs_(correction.design, ensemble_.tracker(ensemble_.index(correction.design.base)).space(), ensemble_),
        scorer_(truth_space, ensemble_.tracker(inputs_.base()).space()) {
    for (const auto& [name, threshold] : correction.training.leave_out_beyond)
      limits_.emplace_back(quantity(name), threshold);
  }

  Ensemble& ensemble() { return ensemble_; }

  /// A run, whose steps the ensemble then takes one by one. The recording must outlive it.
  void begin(const Recording& recording, const RunKey& key) {
    recording_ = &recording;
    random_.emplace(key, StreamId::learning);
    ensemble_.reset();
    ensemble_.foresee(recording.measurements);
    const std::size_t targets = teacher_ >= 0 ? 1 : recording.truth.size();
    tracks_.assign(targets, {inputs_.extractor()});
    parts_.assign(whole_tracks_ ? targets : 1, {});
  }

  /// After the ensemble's step of that number.
  void take(std::size_t step) {
    if (teacher_ >= 0)
      take_by_smoother(step);
    else
      take_by_truth(step);
  }

  void end(TeacherRows& rows) const {
    for (const TeacherRows& part : parts_) rows.insert(rows.end(), part.begin(), part.end());
  }

 private:
  // One target's: features remember their track.
  struct Track {
    FeatureExtractor extractor;
    double next_s = -std::numeric_limits<double>::infinity();  // time of the next step to be taught
    int last = -1;                                             // number of the track that its last row was of
  };

  // What a step is taught.
  struct Lesson {
    BoundedVector whole;   // state that the limits are of
    BoundedVector x;       // the base's components of it
    BoundedVector unsure;  // a draw of its error
  };

  Lesson lesson_of(const BoundedVector& true_state) const {
    return {true_state, true_state(truth_index_), BoundedVector::Zero(static_cast<Eigen::Index>(truth_index_.size()))};
  }

  void take_by_truth(std::size_t step) {
    for (std::size_t target = 0; target < tracks_.size(); ++target)
      if (const StepRecord* base = target_record(*recording_, target, ensemble_.records(inputs_.base())))
        take(*base, lesson_of(recording_->truth[target].x[step]), static_cast<int>(step) + 1 >= from_step_,
             tracks_[target], parts_[whole_tracks_ ? target : 0]);
  }

  void take_by_smoother(std::size_t step) {
    const auto& smoother = dynamic_cast<const Smoother&>(ensemble_.tracker(teacher_));
    const auto bases = ensemble_.records(inputs_.base()), smoothed = ensemble_.records(teacher_);
    if (bases.empty()) return;
    const StepRecord* known = smoothed.empty() ? nullptr : &smoothed.front();
    const bool is_taught = random_->uniform() < (known ? weight(*known, *smoother.account()) : 0.0) &&
                           known->time_s == bases.front().time_s && static_cast<int>(step) + 1 >= from_step_;
    Lesson lesson = lesson_of(known ? known->x : BoundedVector::Zero(smoother.space().size()));
    if (is_taught) {
      const BoundedMatrix P = known->P(truth_index_, truth_index_);
      BoundedVector unit(P.rows());
      for (double& value : unit) value = random_->normal();
      lesson.unsure = Eigen::LLT<BoundedMatrix>(P).matrixL() * unit;
    }
    take(bases.front(), lesson, is_taught, tracks_.front(), parts_.front());
  }

  // How much more the smoother knows than its filter, in [0, 1].
  static double weight(const StepRecord& known, const SmoothingAccount& account) {
    if (!account.looked_back || known.status == StepStatus::failed) return 0.0;
    if (account.measured > 0 && account.nis > chi_square_quantile(kSurprise, account.measured)) return 0.0;
    return std::clamp(1.0 - (known.P.diagonal().array() / account.filter_variance.array()).mean(), 0.0, 1.0);
  }

  std::size_t quantity(const std::string& name) const {
    if (const auto found = scorer_.quantity(name)) return *found;
    throw InputError("training.leave_out_beyond", "names no quantity of the truth and the base: \"" + name + "\"",
                     suggestion(name, scorer_.quantities()));
  }

  bool is_beyond(const BoundedVector& truth, const StepRecord& base) const {
    return std::any_of(limits_.begin(), limits_.end(),
                       [&](const auto& limit) { return !(scorer_.error(limit.first, truth, base.x) <= limit.second); });
  }

  void take(const StepRecord& base, const Lesson& lesson, bool is_taught, Track& track, TeacherRows& rows) {
    const CorrectionInputs::Records step = inputs_.records(ensemble_, base.track);
    if (!step.complete()) return;  // features of which a correction does not hear either
    CorrectionInputs::Features features;
    inputs_.extract(ensemble_, base, track.extractor, features);  // every step, for the averages
    is_taught = is_taught && base.time_s >= track.next_s;
    if (whole_tracks_ ? !step.agree() || !features.allFinite() : !is_taught) return;
    // The first step in every interval, so that steps of another period do not drift through it.
    if (is_taught && every_s_ > 0.0) track.next_s = every_s_ * (std::floor(base.time_s / every_s_) + 1.0);
    const OutputUnits units = inputs_.units(track.extractor, base);
    const BoundedVector label = units.output(lesson.x - base.x);
    const Eigen::LLT<BoundedMatrix> covariance(units.output_covariance(step.source->P)),
        reference_covariance(units.output_covariance(step.reference->P));
    if (!features.allFinite() || !label.allFinite() || covariance.info() != Eigen::Success ||
        reference_covariance.info() != Eigen::Success || is_beyond(lesson.whole, base))
      is_taught = false;
    if (!is_taught && !whole_tracks_) return;
    const bool begins = base.track != track.last;
    track.last = base.track;
    append(features, rows);
    if (!is_taught) {
      rows.insert(rows.end(), static_cast<std::size_t>(2 * label.size() * (1 + label.size())), 0.0);
      append(Eigen::Vector3d(kNaN, kNaN, kNaN), rows);
      append(Eigen::Vector3d(begins, 0.0, base.status == StepStatus::ok), rows);
      append(BoundedVector::Zero(label.size()), rows);
      return;
    }
    append(label, rows);
    append(units.output(step.reference->x - base.x), rows);
    append(BoundedMatrix(covariance.matrixL()), rows);
    append(BoundedMatrix(reference_covariance.matrixL()), rows);
    const Intervals& intervals = track.extractor.intervals();
    append(Eigen::Vector3d(intervals.shortest_s, intervals.longest_s, intervals.coast_s), rows);
    append(Eigen::Vector3d(begins, 1.0, base.status == StepStatus::ok), rows);
    append(units.output(lesson.unsure), rows);
  }

  bool whole_tracks_;
  Ensemble ensemble_;
  int teacher_;  // the member that stands for the truth, -1: the truth
  int from_step_;
  double every_s_;
  std::vector<int> truth_index_;  // in the truth, of each component of the base's state
  CorrectionInputs inputs_;
  Scorer scorer_;                                       // of the base
  std::vector<std::pair<std::size_t, double>> limits_;  // of its errors, by quantity
  // Of the run.
  const Recording* recording_ = nullptr;
  std::optional<RandomStream> random_;
  std::vector<Track> tracks_;       // [target]
  std::vector<TeacherRows> parts_;  // of each target, where tracks are whole
};

TeacherRowMakers::TeacherRowMakers(std::size_t count, const Ensemble& ensemble, const CorrectionSpec& correction,
                                   const StateSpace& truth_space, const std::vector<int>& truth_index,
                                   bool whole_tracks) {
  std::vector<Ensemble*> ensembles;
  for (std::size_t i = 0; i < count; ++i) {
    makers_.push_back(std::make_unique<Maker>(ensemble, correction, truth_space, truth_index, whole_tracks));
    ensembles.push_back(&makers_.back()->ensemble());
  }
  ensembles_ = std::make_unique<EnsemblePack>(std::move(ensembles));
}

TeacherRowMakers::~TeacherRowMakers() = default;

TeacherRows TeacherRowMakers::rows(const Scenario& scenario, std::span<const RunKey> keys) {
  TeacherRows all;
  for (; keys.size() > makers_.size(); keys = keys.subspan(makers_.size()))
    add(scenario, keys.first(makers_.size()), all);
  add(scenario, keys, all);
  return all;
}

void TeacherRowMakers::add(const Scenario& scenario, std::span<const RunKey> keys, TeacherRows& rows) {
  std::vector<Recording> recordings;
  for (const RunKey& key : keys) recordings.push_back(scenario.simulate(key));
  std::vector<const Recording*> all_recordings;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    makers_[i]->begin(recordings[i], keys[i]);
    all_recordings.push_back(&recordings[i]);
  }
  step_through(*ensembles_, all_recordings, [&](std::size_t i, std::size_t step) { makers_[i]->take(step); });
  for (std::size_t i = 0; i < keys.size(); ++i) makers_[i]->end(rows);
}

TeacherSet teacher_set_of(const std::vector<TeacherRows>& rows, const std::vector<FeatureSpec>& features,
                          Eigen::Index n, bool whole_tracks, bool by_smoother) {
  const auto d = static_cast<Eigen::Index>(features.size());
  Eigen::Index total = 0, taught = 0;
  for (const TeacherRows& some : rows) total += static_cast<Eigen::Index>(some.size()) / row_size(d, n);
  TeacherSet set{features,
                 Eigen::MatrixXd(total, d),
                 Eigen::MatrixXd(total, n),
                 Eigen::MatrixXd(total, n),
                 Eigen::MatrixXd(total, n * n),
                 Eigen::MatrixXd(total, n * n),
                 Eigen::MatrixXd(total, 3),
                 {},
                 {},
                 {},
                 Eigen::MatrixXd(by_smoother ? total : 0, n)};
  Eigen::Index next = 0;
  for (const TeacherRows& some : rows) {
    const Eigen::Index count = static_cast<Eigen::Index>(some.size()) / row_size(d, n);
    const Eigen::Map<const Eigen::MatrixXd> columns(some.data(), row_size(d, n), count);  // a row to a column
    Eigen::Index part = 0;
    for (Eigen::MatrixXd* matrix :
         {&set.X, &set.Y, &set.reference, &set.covariance_factors, &set.reference_factors, &set.intervals}) {
      matrix->middleRows(next, count) = columns.middleRows(part, matrix->cols()).transpose();
      part += matrix->cols();
    }
    if (whole_tracks) {
      for (Eigen::Index row = 0; row < count; ++row) {
        set.begins.push_back(columns(part, row) != 0.0);
        set.taught.push_back(columns(part + 1, row) != 0.0);
        set.used.push_back(columns(part + 2, row) != 0.0);
      }
    }
    if (by_smoother) set.unsure.middleRows(next, count) = columns.middleRows(part + 3, n).transpose();
    taught += (columns.row(part + 1).array() != 0.0).count();
    next += count;
  }
  if (taught == 0)
    throw InputError("training", "no step of the training runs can be taught", "records, truth and finite features");
  return set;
}

}  // namespace truebearing
