#include "training/teacher.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "truebearing/core/error.hpp"
#include "truebearing/correction/feature_extractor.hpp"

namespace truebearing {
namespace {

struct Row {
  FeatureExtractor::Features features;
  BoundedVector label;
  BoundedVector reference;
  BoundedMatrix covariance_factor;
  BoundedMatrix reference_factor;
};

// What one worker needs to make the rows of a run.
class RowMaker {
 public:
  RowMaker(const Ensemble& ensemble, const CorrectionSpec& correction, std::vector<int> truth_index)
      : ensemble_(ensemble.clone()),
        from_step_(correction.training.from_step),
        every_s_(correction.training.every_s),
        base_(ensemble_.index(correction.base)),
        reference_(ensemble_.index(correction.reference)),
        source_(ensemble_.index(correction.covariance_of)),
        output_in_sigma_(correction.output_in_sigma),
        truth_index_(std::move(truth_index)),
        extractor_(correction.features, ensemble_.tracker(base_).space(), correction.frame,
                   [&](const std::string& name) {
                     return ensemble_.tracker(name.empty() ? base_ : ensemble_.index(name)).blocks();
                   }) {
    for (const std::string& name : extractor_.companions()) companions_.push_back(ensemble_.index(name));
    companion_records_.resize(companions_.size());
  }

  std::vector<Row> rows(const Recording& recording) {
    std::vector<Row> rows;
    double next_s = -std::numeric_limits<double>::infinity();
    ensemble_.reset();
    extractor_.reset();
    for (std::size_t step = 0; step < recording.measurements.size(); ++step) {
      ensemble_.step(recording.measurements[step]);
      if (ensemble_.records(base_).empty()) continue;
      const StepRecord& base = ensemble_.records(base_).front();
      for (std::size_t c = 0; c < companions_.size(); ++c)
        companion_records_[c] = ensemble_.record(companions_[c], base.track);
      Row row;
      extractor_.extract(base, companion_records_, row.features);  // every step, for the averages
      const StepRecord* reference = ensemble_.record(reference_, base.track);
      const StepRecord* source = ensemble_.record(source_, base.track);
      if (static_cast<int>(step) + 1 < from_step_ || base.time_s < next_s || !reference || !source ||
          base.status == StepStatus::failed)
        continue;
      // The first step in every interval, so that steps of another period do not drift through it.
      if (every_s_ > 0.0) next_s = every_s_ * (std::floor(base.time_s / every_s_) + 1.0);
      // T into the frame, then 1 / D.
      const FrameRotation& rotation = extractor_.rotation();
      BoundedVector scale = BoundedVector::Ones(base.x.size());
      if (output_in_sigma_) scale = rotation.covariance(base.P).diagonal().cwiseSqrt().cwiseInverse();
      const BoundedVector truth = recording.truth.front().x[step](truth_index_);
      row.label = scale.cwiseProduct(rotation.vector(truth - base.x));
      row.reference = scale.cwiseProduct(rotation.vector(reference->x - base.x));
      const auto scaled = [&](const BoundedMatrix& P) -> BoundedMatrix {
        return scale.asDiagonal() * rotation.covariance(P) * scale.asDiagonal();
      };
      const Eigen::LLT<BoundedMatrix> covariance(scaled(source->P)), reference_covariance(scaled(reference->P));
      if (!row.features.allFinite() || !row.label.allFinite() || covariance.info() != Eigen::Success ||
          reference_covariance.info() != Eigen::Success)
        continue;
      row.covariance_factor = covariance.matrixL();
      row.reference_factor = reference_covariance.matrixL();
      rows.push_back(row);
    }
    return rows;
  }

 private:
  Ensemble ensemble_;
  int from_step_;
  double every_s_;
  int base_;
  int reference_;
  int source_;
  bool output_in_sigma_;
  std::vector<int> truth_index_;  // of each component of the base's state
  FeatureExtractor extractor_;
  std::vector<int> companions_;
  std::vector<const StepRecord*> companion_records_;
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
  const StateSpace& space = ensemble.tracker(ensemble.index(correction.base)).space();
  std::vector<int> truth_index;
  for (const std::string& component : space.components) {
    truth_index.push_back(scenario.truth_space().component_index(component));
    if (truth_index.back() < 0)
      throw InputError("training",
                       "the scenario's truth is " + scenario.truth_space().name + ", the base's state " + space.name,
                       "a truth that has every component of the state");
  }
  const std::size_t runs = correction.training.runs;
  std::vector<std::vector<Row>> by_run(runs);
  std::vector<std::optional<RowMaker>> makers(worker_count(options.threads));
  monte_carlo(
      runs, options.threads,
      [&](std::size_t run, std::size_t worker) {
        if (!makers[worker]) makers[worker].emplace(ensemble, correction, truth_index);
        by_run[run] = makers[worker]->rows(scenario.simulate({options.seed, options.role, run}));
      },
      options.progress);

  Eigen::Index total = 0;
  for (const std::vector<Row>& rows : by_run) total += static_cast<Eigen::Index>(rows.size());
  if (total == 0)
    throw InputError("training", "no step of the training runs can be taught", "records, truth and finite features");
  const Eigen::Index d = static_cast<Eigen::Index>(correction.features.size());
  const Eigen::Index n = space.size();
  TeacherSet set{correction.features,       Eigen::MatrixXd(total, d),     Eigen::MatrixXd(total, n),
                 Eigen::MatrixXd(total, n), Eigen::MatrixXd(total, n * n), Eigen::MatrixXd(total, n * n)};
  Eigen::Index next = 0;
  for (const std::vector<Row>& rows : by_run)
    for (const Row& row : rows) {
      set.X.row(next) = row.features.transpose();
      set.Y.row(next) = row.label.transpose();
      set.reference.row(next) = row.reference.transpose();
      set.covariance_factors.row(next) = row.covariance_factor.reshaped().transpose();
      set.reference_factors.row(next) = row.reference_factor.reshaped().transpose();
      ++next;
    }
  return set;
}

}  // namespace truebearing
