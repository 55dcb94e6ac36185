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
#include "training/recurrent_checkpoint.hpp"
#include "training/recurrent_training.hpp"
#include "training/variable_projection.hpp"
#include "truebearing/correction/model_file.hpp"
#include "truebearing/study/configuration_text.hpp"

namespace truebearing {
namespace {

constexpr double kInputClip = 4.0;                 // of a recurrent network, in standard deviations
constexpr double kLeastScale = 1e-9;               // of an output that never errs
constexpr std::size_t kTrainingPerValidation = 8;  // runs

FuzzyTrainingData training_data(const TeacherSet& teacher, const CorrectionSpec& spec, const StateSpace& space) {
  FuzzyTrainingData data{teacher.X, teacher.Y, {}, {}, {}, false};
  if (spec.training.mirror == TrainingSpec::Mirror::none) return data;
  for (const FeatureSpec& feature : teacher.features)
    data.parity.push_back(mirror_parity(feature, spec.design.frame, space));
  for (int i = 0; i < space.size(); ++i) data.output_parity.push_back(component_parity(spec.design.frame, space, i));
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
  variable_projection.threads = options.threads;
  return train_variable_projection(data, variable_projection, options.training_progress);
}

double quantile_of(std::vector<double> values, double quantile) {
  const auto rank = static_cast<std::ptrdiff_t>(quantile * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

// take(row, answer) for every row of the teacher set, of what the network says there.
void for_each_answer(const TeacherSet& teacher, const Network& network, const auto& take) {
  NetworkMemory kept = first_memory(network), memory;
  NetworkAnswer said;
  for (Eigen::Index row = 0; row < teacher.rows(); ++row) {
    const auto i = static_cast<std::size_t>(row);
    if (!teacher.begins.empty() && teacher.begins[i]) kept = first_memory(network);
    memory = kept;
    answer(network, NetworkInputs(teacher.X.row(row).transpose()), memory, said);
    if (teacher.used.empty() || teacher.used[i]) kept = memory;
    take(row, said);
  }
}

// (N x n)
Eigen::MatrixXd outputs(const TeacherSet& teacher, const Network& network) {
  Eigen::MatrixXd Y(teacher.Y.rows(), teacher.Y.cols());
  for_each_answer(teacher, network,
                  [&](Eigen::Index row, const NetworkAnswer& said) { Y.row(row) = said.y.transpose(); });
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
  box.high_s = quantile_of(known(1), 1.0 - spec.quantile);
  box.longest_coast_s = quantile_of(known(2), 1.0 - spec.quantile);
  return box;
}

// Of the taught rows.
Eigen::VectorXd disagreements(const TeacherSet& teacher, const Network& network) {
  const Eigen::Index n = teacher.Y.cols();
  std::vector<double> values;
  for_each_answer(teacher, network, [&](Eigen::Index row, const NetworkAnswer& said) {
    if (!teacher.is_taught(row)) return;
    const BoundedMatrix source = teacher.covariance_factors.row(row).reshaped(n, n);
    const BoundedMatrix reference = teacher.reference_factors.row(row).reshaped(n, n);
    values.push_back(disagreement(said.y - teacher.reference.row(row).transpose(),
                                  said.covariance(source * source.transpose()), reference * reference.transpose()));
  });
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

// e (N x n), each in the standard deviation that the covariance's source has of it; the rows of L are as long as those.
Eigen::MatrixXd in_sigmas(const Eigen::MatrixXd& errors, const Eigen::MatrixXd& factors) {
  const Eigen::Index n = errors.cols();
  Eigen::MatrixXd normalised = errors;
  for (Eigen::Index row = 0; row < errors.rows(); ++row)
    normalised.row(row).array() /= factors.row(row).reshaped(n, n).rowwise().norm().transpose().array();
  return normalised;
}

// The name of the file, the changes on one line.
std::string provenance_of(const ChangedScenario& changed) {
  const std::string file = changed.file.filename().string(), changes = configuration_text(*changed.changes);
  if (changed.changes->empty()) return file;
  return file.empty() ? changes : fmt::format("{} {}", file, changes);
}

// The covariance head of rules, from rows of what the correction will meet.
void fit_covariance(const TeacherSet& met, const CorrectionSpec& spec, const StateSpace& space, RuleBase& rules) {
  const Eigen::Index n = met.Y.cols();
  rules.inflation = Eigen::VectorXd::Ones(rules.network.rules());  // until it is known
  const Eigen::MatrixXd errors = met.errors(outputs(met, rules));
  if (!spec.design.covariance_moments) {
    const Eigen::VectorXd lengths = mahalanobis_lengths(errors, met.covariance_factors);
    rules.inflation = covariance_inflation(rules.network, met.X, lengths.cwiseAbs2() / static_cast<double>(n));
    return;
  }
  rules.inflation.resize(0);
  std::vector<int> output_parity;
  if (spec.training.mirror == TrainingSpec::Mirror::pairs)
    for (int i = 0; i < static_cast<int>(n); ++i)
      output_parity.push_back(component_parity(spec.design.frame, space, i));
  rules.moments = covariance_moments(rules.network, met.X, in_sigmas(errors, met.covariance_factors), output_parity);
}

// What a kind of network is taught with: `teacher` for what it says, `met` for how sure it is, `validation` to know
// when it is best.
struct Lessons {
  const TeacherSet& teacher;
  const TeacherSet& met;
  const TeacherSet& validation;
  const StateSpace& space;
};

Network train_rules(const Lessons& lessons, const CorrectionSpec& spec, const TrainOptions& options,
                    TrainReport& report) {
  TrainedFuzzyNetwork trained =
      train_network(training_data(lessons.teacher, spec, lessons.space), spec.training, options);
  report.cost = trained.cost;
  RuleBase rules;
  rules.network = FuzzyNetwork(std::move(trained.parameters));
  rules.usage = trained.usage;
  rules.local_mean = trained.local_mean;
  fit_covariance(lessons.met, spec, lessons.space, rules);
  return rules;
}

// As the network sees them.
RecurrentRows recurrent_rows(const TeacherSet& teacher, const GatedRecurrent::Parameters& scales,
                             const FuzzyTrainingData& data) {
  RecurrentRows rows;
  rows.inputs = ((teacher.X.transpose().colwise() - scales.input_mean).array().colwise() / scales.input_scale.array())
                    .cwiseMin(scales.input_clip)
                    .cwiseMax(-scales.input_clip)
                    .cast<float>();
  rows.targets = (teacher.Y.transpose().array().colwise() / scales.output_scale.array()).cast<float>();
  rows.begins = teacher.begins;
  rows.taught = teacher.taught;
  rows.used = teacher.used;
  if (data.mirrored()) {
    rows.parity = Eigen::Map<const Eigen::VectorXi>(data.parity.data(), teacher.X.cols()).cast<float>();
    rows.out_parity = data.output_signs().cast<float>();
  }
  return rows;
}

Network train_recurrent(const Lessons& lessons, const CorrectionSpec& spec, const TrainOptions& options,
                        TrainReport& report) {
  const RecurrentModule module = recurrent_module(options.torch_folder);
  const FuzzyTrainingData data = training_data(lessons.teacher, spec, lessons.space);
  const FuzzyNetwork::Parameters normalised = normalisation(data, kInputClip);
  GatedRecurrent::Parameters parameters;
  parameters.input_mean = normalised.input_mean;
  parameters.input_scale = normalised.input_scale;
  parameters.input_clip = normalised.input_clip;
  // Of the taught rows: the others' labels are zero.
  const std::vector<bool>& is_taught = lessons.teacher.taught;
  const auto taught = static_cast<double>(std::count(is_taught.begin(), is_taught.end(), true));
  parameters.output_scale =
      (data.labels.colwise().squaredNorm().transpose() / taught).cwiseSqrt().cwiseMax(kLeastScale);
  const RecurrentRows rows = recurrent_rows(lessons.teacher, parameters, data);
  const RecurrentRows validation = recurrent_rows(lessons.validation, parameters, data);
  const RecurrentOptions recurrent{.units = spec.training.units,
                                   .epochs = spec.training.epochs,
                                   .batch = spec.training.batch,
                                   .learning_rate = spec.training.learning_rate,
                                   .seed = options.seed,
                                   .two_threads = options.threads != 1};
  const RecurrentCheckpoint checkpoint(options.checkpoint, rows, validation, recurrent);
  KeepRecurrentState keep;
  if (!options.checkpoint.empty()) keep = [&](const RecurrentState& state) { checkpoint.write(state); };
  report.cost =
      module.train(rows, validation, recurrent, checkpoint.read(), keep, options.training_progress, parameters);
  const Eigen::Index n = lessons.space.size(), entries = n * (n + 1) / 2;
  parameters.covariance_weight = Eigen::MatrixXf::Zero(entries, spec.training.units);
  parameters.covariance_bias = Eigen::VectorXf::Zero(entries);
  const Eigen::MatrixXd errors = lessons.met.errors(outputs(lessons.met, GatedRecurrent(parameters)));
  Eigen::MatrixXf sigmas = in_sigmas(errors, lessons.met.covariance_factors).transpose().cast<float>();
  for (Eigen::Index row = 0; row < sigmas.cols(); ++row)
    if (!lessons.met.is_taught(row)) sigmas.col(row).setZero();
  module.fit_covariance(recurrent_rows(lessons.met, parameters, data), sigmas, options.seed, {}, parameters);
  return GatedRecurrent(std::move(parameters));
}

// The taught rows of a set of whole tracks, without what makes tracks of them; any other set as it is.
TeacherSet taught_rows(const TeacherSet& teacher) {
  if (teacher.taught.empty()) return teacher;
  std::vector<Eigen::Index> rows;
  for (Eigen::Index row = 0; row < teacher.rows(); ++row)
    if (teacher.is_taught(row)) rows.push_back(row);
  const auto of = [&](const Eigen::MatrixXd& all) { return Eigen::MatrixXd(all(rows, Eigen::all)); };
  return {teacher.features,
          of(teacher.X),
          of(teacher.Y),
          of(teacher.reference),
          of(teacher.covariance_factors),
          of(teacher.reference_factors),
          of(teacher.intervals),
          {},
          {},
          {},
          teacher.unsure.size() > 0 ? of(teacher.unsure) : teacher.unsure};
}

// As its files have it, which hold all of it.
void give_to_all(Ranks& ranks, const CorrectionModel& model) {
  from_first(ranks, model_text(model));
  from_first(ranks, weights_text(model));
}

CorrectionModel model_of_first(Ranks& ranks) {
  const std::string text = from_first(ranks, {}), weights = from_first(ranks, {});
  return parse_model(text, weights, "the model of rank 0");
}

}  // namespace

CorrectionModel train_correction(const Study& study, const std::string& name, const TrainOptions& options,
                                 TrainReport* report) {
  const CorrectionSpec& spec = study.tracker(name).correction.value();
  std::vector<std::string> members = spec.design.members();
  if (!spec.training.teacher.empty()) members.push_back(spec.training.teacher);
  const Ensemble ensemble = study.make_ensemble(members);
  const StateSpace& space = ensemble.tracker(ensemble.index(spec.design.base)).space();
  const bool recurrent = spec.design.network == NetworkKind::recurrent;
  if (recurrent && is_first(options.ranks)) recurrent_module(options.torch_folder);  // said before the work if none
  TeacherOptions teacher_options{options.seed, Role::training, options.threads, options.teacher_progress,
                                 recurrent,    options.ranks};
  const std::unique_ptr<Scenario> taught = spec.training.scenario ? study.scenario(*spec.training.scenario) : nullptr;
  const Scenario& scenario = taught ? *taught : study.scenario();
  const TeacherSet teacher = collect_teacher_set(ensemble, spec, scenario, teacher_options);
  // Covariance and gate from the wider family, where there is one.
  std::optional<TeacherSet> wider, validation;
  if (spec.training.covariance_scenario)
    wider = collect_teacher_set(ensemble, spec, *study.scenario(*spec.training.covariance_scenario), teacher_options);
  if (recurrent) {
    CorrectionSpec fewer = spec;
    fewer.training.runs = std::max<std::size_t>(1, spec.training.runs / kTrainingPerValidation);
    teacher_options.role = Role::validation;
    validation = collect_teacher_set(ensemble, fewer, scenario, teacher_options);
  }
  if (!is_first(options.ranks)) return model_of_first(*options.ranks);
  const TeacherSet& met = wider ? *wider : teacher;
  const Lessons lessons{teacher, met, validation ? *validation : teacher, space};

  CorrectionModel model;
  model.space = &space;
  model.design = spec.design;
  for (const std::string& member : spec.design.members()) model.trackers[member] = study.configuration_line(member);
  TrainReport found;
  const auto begin = std::chrono::steady_clock::now();
  model.network =
      recurrent ? train_recurrent(lessons, spec, options, found) : train_rules(lessons, spec, options, found);
  found.training_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();

  const bool trusts_another = spec.design.reference != spec.design.base;
  const TeacherSet filled = taught_rows(met);
  model.gate = box_gate(training_data(filled, spec, space),
                        trusts_another ? disagreements(met, model.network) : Eigen::VectorXd(), spec.box);
  model.gate->intervals = interval_box(filled.intervals, spec.box);
  found.rows = recurrent ? std::count(teacher.taught.begin(), teacher.taught.end(), true) : teacher.rows();
  model.provenance = {{"study", study.name()},
                      {"tracker", name},
                      {"seed", fmt::format("{}", options.seed)},
                      {"training_runs", fmt::format("{}", spec.training.runs)},
                      {"training_rows", fmt::format("{}", found.rows)},
                      {"bounds", describe(spec.bounds)}};
  if (taught) model.provenance["scenario"] = provenance_of(*spec.training.scenario);
  if (!spec.training.teacher.empty())
    model.provenance["teacher"] =
        fmt::format("without truth, by {}: {}", spec.training.teacher, study.configuration_line(spec.training.teacher));
  if (wider) model.provenance["covariance_scenario"] = provenance_of(*spec.training.covariance_scenario);
  model.validate();
  if (options.ranks) give_to_all(*options.ranks, model);
  if (report) *report = found;
  return model;
}

}  // namespace truebearing
