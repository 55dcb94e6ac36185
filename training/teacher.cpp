#include "training/teacher.hpp"

#include <Eigen/Cholesky>
#include <optional>

#include "truebearing/core/error.hpp"
#include "truebearing/correction/feature_extractor.hpp"

namespace truebearing {
namespace {

struct Row {
  FeatureExtractor::Features features;
  BoundedVector label;
  BoundedMatrix factor;
};

// What one worker needs to make the rows of a run.
class RowMaker {
 public:
  RowMaker(const Ensemble& ensemble, const CorrectionSpec& correction)
      : ensemble_(ensemble.clone()),
        from_step_(correction.training.from_step),
        base_(ensemble_.index(correction.base)),
        source_(ensemble_.index(correction.covariance_of)),
        extractor_(correction.features, ensemble_.tracker(base_).space(), [&](const std::string& name) {
          return ensemble_.tracker(name.empty() ? base_ : ensemble_.index(name)).blocks();
        }) {
    for (const std::string& name : extractor_.companions()) companions_.push_back(ensemble_.index(name));
    companion_records_.resize(companions_.size());
  }

  std::vector<Row> rows(const Recording& recording) {
    std::vector<Row> rows;
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
      const StepRecord* source = ensemble_.record(source_, base.track);
      if (static_cast<int>(step) + 1 < from_step_ || !source || base.status == StepStatus::failed) continue;
      row.label = recording.truth.front().x[step] - base.x;
      const Eigen::LLT<BoundedMatrix> cholesky(source->P);
      if (!row.features.allFinite() || !row.label.allFinite() || cholesky.info() != Eigen::Success) continue;
      row.factor = cholesky.matrixL();
      rows.push_back(row);
    }
    return rows;
  }

 private:
  Ensemble ensemble_;
  int from_step_;
  int base_;
  int source_;
  FeatureExtractor extractor_;
  std::vector<int> companions_;
  std::vector<const StepRecord*> companion_records_;
};

}  // namespace

TeacherSet collect_teacher_set(const Ensemble& ensemble, const CorrectionSpec& correction, const Scenario& scenario,
                               const TeacherOptions& options) {
  const StateSpace& space = ensemble.tracker(ensemble.index(correction.base)).space();
  if (space != scenario.truth_space())
    throw InputError("training", "the scenario's truth is " + scenario.truth_space().name + ", the base's state " + space.name,
                     "the same state space");
  const std::size_t runs = correction.training.runs;
  std::vector<std::vector<Row>> by_run(runs);
  std::vector<std::optional<RowMaker>> makers(worker_count(options.threads));
  monte_carlo(
      runs, options.threads,
      [&](std::size_t run, std::size_t worker) {
        if (!makers[worker]) makers[worker].emplace(ensemble, correction);
        by_run[run] = makers[worker]->rows(scenario.simulate({options.seed, options.role, run}));
      },
      options.progress);

  Eigen::Index total = 0;
  for (const std::vector<Row>& rows : by_run) total += static_cast<Eigen::Index>(rows.size());
  if (total == 0) throw InputError("training", "no step of the training runs can be taught", "records, truth and finite features");
  const Eigen::Index d = static_cast<Eigen::Index>(correction.features.size());
  const Eigen::Index n = space.size();
  TeacherSet set{correction.features, Eigen::MatrixXd(total, d), Eigen::MatrixXd(total, n), Eigen::MatrixXd(total, n * n)};
  Eigen::Index next = 0;
  for (const std::vector<Row>& rows : by_run)
    for (const Row& row : rows) {
      set.X.row(next) = row.features.transpose();
      set.Y.row(next) = row.label.transpose();
      set.covariance_factors.row(next) = row.factor.reshaped().transpose();
      ++next;
    }
  return set;
}

}  // namespace truebearing
