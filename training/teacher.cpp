// SPDX-License-Identifier: Apache-2.0
#include "training/teacher.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <limits>
#include <memory>
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

// What is taught of the steps of one run: the numbers of a TeacherSet's rows (features, label, reference, the two
// factors, intervals, first of its track, taught, used, error of the label), one row after another.
using Rows = std::vector<double>;

Eigen::Index row_size(Eigen::Index features, Eigen::Index state) {
  return features + 2 * state + 2 * state * state + 3 + 3 + state;
}

// As machines of one kind have them.
std::string bytes_of(const Rows& rows) {
  return {reinterpret_cast<const char*>(rows.data()), rows.size() * sizeof(double)};
}

Rows rows_of(const std::string& bytes) {
  Rows rows(bytes.size() / sizeof(double));
  if (!rows.empty()) std::memcpy(rows.data(), bytes.data(), rows.size() * sizeof(double));
  return rows;
}

void append(const auto& values, Rows& rows) {
  for (Eigen::Index i = 0; i < values.size(); ++i) rows.push_back(values.reshaped()[i]);
}

// What makes the rows of a run.
class RowMaker {
 public:
  RowMaker(const Ensemble& ensemble, const CorrectionSpec& correction, const StateSpace& truth_space,
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

  Rows end() {
    for (std::size_t part = 1; part < parts_.size(); ++part)
      parts_[0].insert(parts_[0].end(), parts_[part].begin(), parts_[part].end());
    return std::move(parts_[0]);
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

  void take(const StepRecord& base, const Lesson& lesson, bool is_taught, Track& track, Rows& rows) {
    CorrectionInputs::Features features;
    inputs_.extract(ensemble_, base, track.extractor, features);  // every step, for the averages
    const CorrectionInputs::Records step = inputs_.records(ensemble_, base.track);
    is_taught = is_taught && base.time_s >= track.next_s;
    if (!step.complete() || (whole_tracks_ ? !step.agree() || !features.allFinite() : !is_taught)) return;
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
  std::vector<Track> tracks_;  // [target]
  std::vector<Rows> parts_;    // of each target, where tracks are whole
};

// Makes the rows of several runs together (EnsemblePack).
class RowMakers {
 public:
  template <typename Make>
  RowMakers(std::size_t count, const Make& make) : makers_(made(count, make)), ensembles_(ensembles_of(makers_)) {}

  // One run after another.
  Rows rows(const Scenario& scenario, const std::vector<RunKey>& keys) {
    std::vector<Recording> recordings;
    for (const RunKey& key : keys) recordings.push_back(scenario.simulate(key));
    std::vector<const Recording*> all_recordings;
    for (std::size_t i = 0; i < keys.size(); ++i) {
      makers_[i]->begin(recordings[i], keys[i]);
      all_recordings.push_back(&recordings[i]);
    }
    step_through(ensembles_, all_recordings, [&](std::size_t i, std::size_t step) { makers_[i]->take(step); });
    Rows all;
    for (std::size_t i = 0; i < keys.size(); ++i) {
      const Rows of_run = makers_[i]->end();
      all.insert(all.end(), of_run.begin(), of_run.end());
    }
    return all;
  }

 private:
  using Makers = std::vector<std::unique_ptr<RowMaker>>;

  template <typename Make>
  static Makers made(std::size_t count, const Make& make) {
    Makers makers;
    for (std::size_t i = 0; i < count; ++i) makers.push_back(make());
    return makers;
  }
  static std::vector<Ensemble*> ensembles_of(const Makers& makers) {
    std::vector<Ensemble*> ensembles;
    for (const auto& maker : makers) ensembles.push_back(&maker->ensemble());
    return ensembles;
  }

  Makers makers_;
  EnsemblePack ensembles_;
};

}  // namespace

Eigen::VectorXd mahalanobis_lengths(const Eigen::MatrixXd& errors, const Eigen::MatrixXd& factors) {
  const Eigen::Index n = errors.cols();
  Eigen::VectorXd lengths(errors.rows());
  for (Eigen::Index row = 0; row < errors.rows(); ++row) {
    const BoundedVector e = errors.row(row).transpose();
    const BoundedMatrix factor = factors.row(row).reshaped(n, n);
    lengths[row] = factor.triangularView<Eigen::Lower>().solve(e).norm();
  }
  return lengths;
}

TeacherSet collect_teacher_set(const Ensemble& ensemble, const CorrectionSpec& correction, const Scenario& scenario,
                               const TeacherOptions& options) {
  const StateSpace& space = ensemble.tracker(ensemble.index(correction.design.base)).space();
  const int teacher = ensemble.index(correction.training.teacher);
  const StateSpace& truth_space = teacher < 0 ? scenario.truth_space() : ensemble.tracker(teacher).space();
  std::vector<int> truth_index;
  for (const std::string& component : space.components) {
    truth_index.push_back(truth_space.component_index(component));
    if (truth_index.back() < 0)
      throw InputError("training",
                       fmt::format("the {} is {}, the base's state {}",
                                   teacher < 0 ? "scenario's truth" : "teacher's state", truth_space.name, space.name),
                       "a truth that has every component of the state");
  }
  const std::size_t runs = correction.training.runs;
  // All ranks have to cut the runs alike, whatever machines they are on.
  const std::size_t wanted =
      options.ranks ? runs_together(runs / options.ranks->size(), 1) : runs_together(runs, options.threads);
  const std::size_t together = ensemble.gains_together() ? wanted : 1;
  std::vector<Rows> by_group((runs + together - 1) / together);
  std::vector<std::optional<RowMakers>> makers(worker_count(options.threads));
  const auto make = [&](std::size_t first, std::size_t count, std::size_t worker) {
    if (!makers[worker])
      makers[worker].emplace(together, [&] {
        return std::make_unique<RowMaker>(ensemble, correction, truth_space, truth_index, options.whole_tracks);
      });
    std::vector<RunKey> keys;
    for (std::size_t run = first; run < first + count; ++run) keys.push_back({options.seed, options.role, run});
    return makers[worker]->rows(scenario, keys);
  };
  if (options.ranks)
    share_work(
        *options.ranks, by_group.size(), options.threads,
        [&](std::size_t group, std::size_t worker) {
          return bytes_of(make(group * together, std::min(together, runs - group * together), worker));
        },
        [&](std::size_t group, const std::string& bytes) { by_group[group] = rows_of(bytes); },
        options.progress
            ? Progress([&](std::size_t done, std::size_t) { options.progress(std::min(done * together, runs), runs); })
            : Progress());
  else
    monte_carlo_together(
        runs, together, options.threads,
        [&](std::size_t first, std::size_t count, std::size_t worker) {
          by_group[first / together] = make(first, count, worker);
        },
        options.progress);
  if (!is_first(options.ranks)) return {};

  const Eigen::Index d = static_cast<Eigen::Index>(correction.design.features.size());
  const Eigen::Index n = space.size();
  Eigen::Index total = 0;
  for (const Rows& rows : by_group) total += static_cast<Eigen::Index>(rows.size()) / row_size(d, n);
  if (total == 0)
    throw InputError("training", "no step of the training runs can be taught", "records, truth and finite features");
  TeacherSet set{correction.design.features,
                 Eigen::MatrixXd(total, d),
                 Eigen::MatrixXd(total, n),
                 Eigen::MatrixXd(total, n),
                 Eigen::MatrixXd(total, n * n),
                 Eigen::MatrixXd(total, n * n),
                 Eigen::MatrixXd(total, 3),
                 {},
                 {},
                 {},
                 Eigen::MatrixXd(teacher < 0 ? 0 : total, n)};
  Eigen::Index next = 0;
  for (const Rows& rows : by_group) {
    const Eigen::Index count = static_cast<Eigen::Index>(rows.size()) / row_size(d, n);
    const Eigen::Map<const Eigen::MatrixXd> columns(rows.data(), row_size(d, n), count);  // a row to a column
    Eigen::Index part = 0;
    for (Eigen::MatrixXd* matrix :
         {&set.X, &set.Y, &set.reference, &set.covariance_factors, &set.reference_factors, &set.intervals}) {
      matrix->middleRows(next, count) = columns.middleRows(part, matrix->cols()).transpose();
      part += matrix->cols();
    }
    if (options.whole_tracks) {
      for (Eigen::Index row = 0; row < count; ++row) {
        set.begins.push_back(columns(part, row) != 0.0);
        set.taught.push_back(columns(part + 1, row) != 0.0);
        set.used.push_back(columns(part + 2, row) != 0.0);
      }
    }
    if (teacher >= 0) set.unsure.middleRows(next, count) = columns.middleRows(part + 3, n).transpose();
    next += count;
  }
  return set;
}

}  // namespace truebearing
