#include "training/train_correction.hpp"

#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <vector>

#include "training/back_propagation.hpp"
#include "training/covariance_inflation.hpp"
#include "training/variable_projection.hpp"

namespace truebearing {
namespace {

FuzzyTrainingData training_data(const TeacherSet& teacher, bool mirror) {
  FuzzyTrainingData data{teacher.X, teacher.Y, {}, {}};
  if (mirror)
    for (const FeatureSpec& feature : teacher.features) data.parity.push_back(mirror_parity(feature.kind));
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
BoxGate box_gate(const FuzzyTrainingData& data, const Eigen::VectorXd& disagreements, const GateSpec& spec) {
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
                     phi.dot(model.inflation) * source * source.transpose(), reference * reference.transpose());
  }
  return values;
}

}  // namespace

CorrectionModel train_correction(const Study& study, const std::string& name, const TrainOptions& options,
                                 TrainReport* report) {
  const CorrectionSpec& spec = study.tracker(name).correction.value();
  const Ensemble ensemble = study.make_ensemble(spec.members());
  const TeacherSet teacher = collect_teacher_set(
      ensemble, spec, study.scenario(), {options.seed, Role::training, options.threads, options.teacher_progress});
  const FuzzyTrainingData data = training_data(teacher, spec.training.mirror);
  const auto begin = std::chrono::steady_clock::now();
  TrainedFuzzyNetwork trained = train_network(data, spec.training, options);
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;

  CorrectionModel model;
  model.space = &ensemble.tracker(ensemble.index(spec.base)).space();
  model.base = spec.base;
  model.reference = spec.reference;
  model.covariance_of = spec.covariance_of;
  for (const std::string& member : spec.members()) model.trackers[member] = study.configuration_line(member);
  model.features = spec.features;
  model.network = FuzzyNetwork(std::move(trained.parameters));
  const Eigen::MatrixXd corrections = outputs(teacher, model.network);
  model.kappa = spec.kappa;
  const Eigen::VectorXd lengths = mahalanobis_lengths(teacher.Y - corrections, teacher.covariance_factors);
  model.inflation = covariance_inflation(model.network, teacher.X, lengths.cwiseAbs2() / model.space->size());
  if (spec.gate) {
    const bool trusts_another = spec.reference != spec.base;
    model.gate =
        box_gate(data, trusts_another ? disagreements(teacher, corrections, model) : Eigen::VectorXd(), *spec.gate);
  }
  model.usage = trained.usage;
  model.local_mean = trained.local_mean;
  model.provenance = {{"study", study.name()},
                      {"tracker", name},
                      {"seed", fmt::format("{}", options.seed)},
                      {"training_runs", fmt::format("{}", spec.training.runs)},
                      {"training_rows", fmt::format("{}", teacher.X.rows())}};
  model.validate();
  if (report) *report = {teacher.X.rows(), trained.cost, elapsed.count()};
  return model;
}

}  // namespace truebearing
