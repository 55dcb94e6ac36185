// SPDX-License-Identifier: Apache-2.0
#include "training/train_correction.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <memory>
#include <optional>
#include <toml++/toml.h>
#include <vector>

#include "training/back_propagation.hpp"
#include "training/covariance_inflation.hpp"
#include "training/covariance_moments.hpp"
#include "training/variable_projection.hpp"
#include "truebearing/study/configuration_text.hpp"

namespace truebearing {
namespace {

FuzzyTrainingData training_data(const TeacherSet& teacher, const CorrectionSpec& spec, const StateSpace& space) {
  FuzzyTrainingData data{teacher.X, teacher.Y, {}, {}, {}, false};
  if (spec.training.mirror == TrainingSpec::Mirror::none) return data;
  for (const FeatureSpec& feature : teacher.features)
    data.parity.push_back(mirror_parity(feature, spec.design.frame, space));
  for (int i = 0; i < space.size(); ++i) data.output_parity.push_back(component_parity(spec.design.frame, i));
  data.paired_rules = spec.training.mirror == TrainingSpec::Mirror::pairs;
  return data;
}

TrainedFuzzyNetwork train_network(const FuzzyTrainingData& data, const TrainingSpec& spec,
                                  const TrainOptions& options) {
  if (spec.method == TrainingSpec::Method::back_propagation) {
    BackPropagationOptions back_propagation;
    back_propagation.terms_per_input = spec.terms_per_input;
    back_propagation.epochs = spec.epochs;
    back_propagation.learning_rate = spec.learning_rate;
    back_propagation.momentum = spec.momentum;
    back_propagation.seed = options.seed;
    return train_back_propagation(data, back_propagation, options.training_progress).network;
  }
  VariableProjectionOptions variable_projection;
  variable_projection.rules = spec.rules;
  variable_projection.iterations = spec.iterations;
  variable_projection.learning_rate = spec.learning_rate;
  variable_projection.ridge = spec.ridge;
  variable_projection.seed = options.seed;
  return train_variable_projection(data, variable_projection, options.training_progress);
}

double quantile_of(std::vector<double> values, double quantile) {
  const auto rank = static_cast<std::ptrdiff_t>(quantile * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

// What the network says on the rows of the teacher set (N x n).
Eigen::MatrixXd outputs(const TeacherSet& teacher, const FuzzyNetwork& network) {
  Eigen::MatrixXd Y(teacher.Y.rows(), teacher.Y.cols());
  FuzzyNetwork::Strengths phi;
  for (Eigen::Index row = 0; row < Y.rows(); ++row) {
    network.strengths(FuzzyNetwork::Inputs(teacher.X.row(row).transpose()), phi);
    Y.row(row) = network.output(phi).transpose();
  }
  return Y;
}

// The box of the training data; symmetric in the features that a mirrored target mirrors, where mirror images were
// taught. The disagreement has no low side, and no limit where `disagreements` is empty.
BoxGate box_gate(const FuzzyTrainingData& data, const Eigen::VectorXd& disagreements, const BoxSpec& spec) {
  const Eigen::Index d = data.features.cols();
  BoxGate gate;
  gate.low.resize(d);
  gate.high.resize(d);
  gate.edge_fraction = spec.edge_fraction;
  gate.disagreement_edge_fraction = spec.disagreement_edge_fraction;
  for (Eigen::Index i = 0; i < d; ++i) {
    std::vector<double> values(data.features.col(i).begin(), data.features.col(i).end());
    if (data.mirrored() && data.parity[static_cast<std::size_t>(i)] < 0)
      for (std::size_t row = 0, rows = values.size(); row < rows; ++row) values.push_back(-values[row]);
    gate.low[i] = quantile_of(values, spec.quantile);
    gate.high[i] = quantile_of(std::move(values), 1.0 - spec.quantile);
  }
  if (disagreements.size() > 0)
    gate.largest_disagreement =
        quantile_of({disagreements.begin(), disagreements.end()}, 1.0 - spec.disagreement_quantile);
  return gate;
}

// The intervals of the training data. Those of a single period differ by rounding, which the edge forgives.
IntervalBox interval_box(const Eigen::MatrixXd& intervals, const BoxSpec& spec) {
  const auto known = [&](Eigen::Index column) {
    std::vector<double> values;
    for (const double value : intervals.col(column))
      if (!std::isnan(value)) values.push_back(value);
    return values;
  };
  IntervalBox box;
  if (known(0).empty()) return box;  // no track has used two measurements
  box.low_s = quantile_of(known(0), spec.quantile);
  box.high_s = std::min(quantile_of(known(1), 1.0 - spec.quantile), spec.longest_interval_s);
  box.longest_coast_s = quantile_of(known(2), 1.0 - spec.quantile);
  return box;
}

Eigen::VectorXd disagreements(const TeacherSet& teacher, const Eigen::MatrixXd& corrections,
                              const CorrectionModel& model) {
  const Eigen::Index n = teacher.Y.cols();
  Eigen::VectorXd values(teacher.X.rows());
  FuzzyNetwork::Strengths phi;
  for (Eigen::Index row = 0; row < values.size(); ++row) {
    model.network.strengths(FuzzyNetwork::Inputs(teacher.X.row(row).transpose()), phi);
    const BoundedMatrix source = teacher.covariance_factors.row(row).reshaped(n, n);
    const BoundedMatrix reference = teacher.reference_factors.row(row).reshaped(n, n);
    values[row] =
        disagreement((corrections.row(row) - teacher.reference.row(row)).transpose(),
                     model.head_covariance(phi, source * source.transpose()), reference * reference.transpose());
  }
  return values;
}

// The name of the file, the changes on one line.
std::string provenance_of(const ChangedScenario& changed) {
  const std::string file = changed.file.filename().string(), changes = configuration_text(*changed.changes);
  if (changed.changes->empty()) return file;
  return file.empty() ? changes : fmt::format("{} {}", file, changes);
}

}  // namespace

// The covariance head, from rows of what the correction will meet.
void fit_covariance(const TeacherSet& teacher, const Eigen::MatrixXd& corrections, const CorrectionSpec& spec,
                    CorrectionModel& model) {
  const Eigen::Index n = teacher.Y.cols();
  const Eigen::MatrixXd errors = teacher.Y - corrections;
  if (!spec.design.covariance_moments) {
    const Eigen::VectorXd lengths = mahalanobis_lengths(errors, teacher.covariance_factors);
    model.inflation = covariance_inflation(model.network, teacher.X, lengths.cwiseAbs2() / static_cast<double>(n));
    return;
  }
  // In standard deviations of the covariance's source: the rows of L are as long as those.
  Eigen::MatrixXd normalised = errors;
  for (Eigen::Index row = 0; row < errors.rows(); ++row)
    normalised.row(row).array() /=
        teacher.covariance_factors.row(row).reshaped(n, n).rowwise().norm().transpose().array();
  std::vector<int> output_parity;
  if (spec.training.mirror == TrainingSpec::Mirror::pairs)
    for (int i = 0; i < static_cast<int>(n); ++i) output_parity.push_back(component_parity(spec.design.frame, i));
  model.moments = covariance_moments(model.network, teacher.X, normalised, output_parity);
}

CorrectionModel train_correction(const Study& study, const std::string& name, const TrainOptions& options,
                                 TrainReport* report) {
  const CorrectionSpec& spec = study.tracker(name).correction.value();
  const Ensemble ensemble = study.make_ensemble(spec.design.members());
  const StateSpace& space = ensemble.tracker(ensemble.index(spec.design.base)).space();
  const TeacherOptions teacher_options{options.seed, Role::training, options.threads, options.teacher_progress};
  const std::unique_ptr<Scenario> taught = spec.training.scenario ? study.scenario(*spec.training.scenario) : nullptr;
  const TeacherSet teacher = collect_teacher_set(ensemble, spec, taught ? *taught : study.scenario(), teacher_options);
  const FuzzyTrainingData data = training_data(teacher, spec, space);
  const auto begin = std::chrono::steady_clock::now();
  TrainedFuzzyNetwork trained = train_network(data, spec.training, options);
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;

  CorrectionModel model;
  model.space = &space;
  model.design = spec.design;
  for (const std::string& member : spec.design.members()) model.trackers[member] = study.configuration_line(member);
  model.network = FuzzyNetwork(std::move(trained.parameters));

  // Covariance and gate from the wider family, where there is one.
  std::optional<TeacherSet> wider;
  if (spec.training.covariance_scenario)
    wider = collect_teacher_set(ensemble, spec, *study.scenario(*spec.training.covariance_scenario), teacher_options);
  const TeacherSet& met = wider ? *wider : teacher;
  const Eigen::MatrixXd corrections = outputs(met, model.network);
  fit_covariance(met, corrections, spec, model);
  const bool trusts_another = spec.design.reference != spec.design.base;
  model.gate = box_gate(training_data(met, spec, space),
                        trusts_another ? disagreements(met, corrections, model) : Eigen::VectorXd(), spec.box);
  model.gate->intervals = interval_box(met.intervals, spec.box);
  model.usage = trained.usage;
  model.local_mean = trained.local_mean;
  model.provenance = {{"study", study.name()},
                      {"tracker", name},
                      {"seed", fmt::format("{}", options.seed)},
                      {"training_runs", fmt::format("{}", spec.training.runs)},
                      {"training_rows", fmt::format("{}", teacher.X.rows())},
                      {"bounds", describe(spec.bounds)}};
  if (taught) model.provenance["scenario"] = provenance_of(*spec.training.scenario);
  if (wider) model.provenance["covariance_scenario"] = provenance_of(*spec.training.covariance_scenario);
  model.validate();
  if (report) *report = {teacher.X.rows(), trained.cost, elapsed.count()};
  return model;
}

}  // namespace truebearing
