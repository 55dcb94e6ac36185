// SPDX-License-Identifier: Apache-2.0
#include "training/learned_motion_training.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <toml++/toml.h>
#include <vector>

#include "training/variable_projection.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/core/with_count.hpp"
#include "truebearing/evaluation/monte_carlo.hpp"
#include "truebearing/study/configuration_text.hpp"
#include "truebearing/study/filter_configuration.hpp"

namespace truebearing {
namespace {

// f_0 of the tracker, and the place in the truth of each component of its state.
struct Around {
  std::shared_ptr<const AnyMotion> motion;
  std::vector<int> truth_index;
};

Around read_around(const Study& study, const TrackerSpec& spec, const Scenario& scenario) {
  TableReader reader = tracker_reader(spec, spec.configuration, study.path().string());
  const MeasurementChoice measurement = read_measurement(reader);
  const MotionLayout layout = read_layout(reader, measurement);
  TableReader motion = reader.table("motion");
  Around around{read_motion(motion.table("around"), layout), {}};
  for (const std::string& component : measurement.space->components)
    around.truth_index.push_back(scenario.truth_space().component_index(component));
  const auto missing = std::find(around.truth_index.begin(), around.truth_index.end(), -1);
  if (around.motion->states() != measurement.space->size() || missing != around.truth_index.end())
    throw motion.error("around",
                       fmt::format("has a state of {} components, and the truth is {}", around.motion->states(),
                                   scenario.truth_space().name),
                       "a motion whose whole state is in the scenario's truth");
  return around;
}

BoundedVector predicted(const AnyMotion& motion, const BoundedVector& x, double dt_s) {
  BoundedVector next;
  with_count(motion.states(), [&]<int N>(std::integral_constant<int, N>) {
    if constexpr (N >= 2) next = static_cast<const SizedMotion<N>&>(motion).f(x, dt_s);
  });
  return next;
}

double median_interval(const std::vector<Recording>& recordings) {
  std::vector<double> intervals_s;
  for (const Recording& recording : recordings)
    for (std::size_t k = 1; k < recording.measurements.size(); ++k)
      intervals_s.push_back(recording.measurements[k].time_s - recording.measurements[k - 1].time_s);
  if (intervals_s.empty()) throw InputError("training", "no run has two measurements", "runs with more");
  const auto middle = intervals_s.begin() + static_cast<std::ptrdiff_t>(intervals_s.size() / 2);
  std::nth_element(intervals_s.begin(), middle, intervals_s.end());
  return *middle;
}

double root_mean_square(const Eigen::MatrixXd& values, const Eigen::VectorXd& scale) {
  return std::sqrt((values * scale.cwiseInverse().asDiagonal()).squaredNorm() / static_cast<double>(values.size()));
}

}  // namespace

MotionResidual train_learned_motion(const Study& study, const std::string& name, const TrainOptions& options,
                                    LearnedMotionReport* report) {
  const TrackerSpec& spec = study.tracker(name);
  const LearnedMotionSpec& learned = spec.learned.value();
  const std::unique_ptr<Scenario> taught = learned.scenario ? study.scenario(*learned.scenario) : nullptr;
  const Scenario& scenario = taught ? *taught : study.scenario();
  const Around around = read_around(study, spec, scenario);

  std::vector<Recording> recordings(learned.runs);
  monte_carlo(
      learned.runs, options.threads,
      [&](std::size_t run, std::size_t) {
        recordings[run] = scenario.simulate({options.seed, Role::training, run});
      },
      options.teacher_progress);
  const double period_s = median_interval(recordings);
  constexpr double kSame = 1e-6;  // periods
  std::vector<double> inputs, labels;
  for (const Recording& recording : recordings)
    for (const Truth& truth : recording.truth)
      for (std::size_t k = 1; k < truth.x.size(); ++k) {
        const double dt_s = recording.measurements[k].time_s - recording.measurements[k - 1].time_s;
        if (std::abs(dt_s - period_s) > kSame * period_s) continue;
        const BoundedVector x = truth.x[k - 1](around.truth_index), next = truth.x[k](around.truth_index);
        const BoundedVector label = next - predicted(*around.motion, x, period_s);
        if (!label.allFinite()) continue;
        inputs.insert(inputs.end(), x.begin(), x.end());
        labels.insert(labels.end(), label.begin(), label.end());
      }
  const Eigen::Index n = around.motion->states(), rows = static_cast<Eigen::Index>(inputs.size()) / n;
  const FuzzyTrainingData data{Eigen::Map<const Eigen::MatrixXd>(inputs.data(), n, rows).transpose(),
                               Eigen::Map<const Eigen::MatrixXd>(labels.data(), n, rows).transpose(),
                               {},
                               {},
                               {},
                               false};

  VariableProjectionOptions fit;
  fit.rules = learned.rules;
  fit.iterations = learned.iterations;
  fit.learning_rate = learned.learning_rate;
  fit.ridge = learned.ridge;
  fit.seed = options.seed;
  fit.threads = options.threads;
  const auto begin = std::chrono::steady_clock::now();
  MotionResidual residual;
  residual.network = FuzzyNetwork(train_variable_projection(data, fit, options.training_progress).parameters);
  residual.period_s = period_s;
  residual.provenance = {{"study", study.name()},
                         {"tracker", name},
                         {"seed", fmt::format("{}", options.seed)},
                         {"training_runs", fmt::format("{}", learned.runs)},
                         {"training_rows", fmt::format("{}", rows)},
                         {"motion", configuration_text(*spec.configuration)}};
  if (!report) return residual;
  report->training_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  report->rows = rows;
  Eigen::MatrixXd left = data.labels;
  FuzzyNetwork::Strengths phi;
  for (Eigen::Index row = 0; row < rows; ++row) {
    residual.network.strengths(data.features.row(row).transpose(), phi);
    left.row(row) -= residual.network.output(phi).transpose();
  }
  const Eigen::VectorXd& scale = residual.network.parameters().output_scale;
  report->remaining = root_mean_square(left, scale) / root_mean_square(data.labels, scale);
  return residual;
}

}  // namespace truebearing
