// SPDX-License-Identifier: Apache-2.0
// truebearing train STUDY.toml [-o MODEL]: teacher signals -> network -> model file.
#include <cstdint>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/data_folder.hpp"
#include "app/output.hpp"
#include "app/subcommands.hpp"
#include "app/workflow.hpp"
#include "truebearing/correction/learned_motion_file.hpp"
#include "truebearing/correction/model_file.hpp"

namespace truebearing {
namespace {

struct TrainArguments {
  std::string study;
  std::string output;
  std::vector<std::string> trackers;
  std::optional<std::uint64_t> seed;
  int threads = 0;
  bool quiet = false;
};

void train_one_motion(const Study& study, const std::string& name, const TrainArguments& options) {
  const std::filesystem::path own = study.tracker(name).learned->file;
  const std::string output = options.output.empty() ? own.string() : options.output;
  check_products(study, {output}, {own});
  const MotionResidual residual =
      train_motion(study, name, {options.seed.value_or(study.seed()), options.threads, options.quiet});
  write_output(output, learned_motion_text(residual));
  if (!is_standard_output(output)) fmt::print("written: {}\n", output);
}

void train(const TrainArguments& options) {
  Study study = Study::load(options.study);
  for (const std::string& name : options.trackers)
    if (!study.tracker(name).correction && !study.tracker(name).learned)
      throw InputError(options.study, "\"" + name + "\" is not a corrected tracker",
                       "trackers of kind \"corrected\", or with a learned motion");
  const std::vector<std::string> learned = learned_trackers(study, options.trackers),
                                 names = corrected_trackers(study, options.trackers);
  if (names.empty() && learned.empty()) throw InputError(options.study, "has no tracker of kind \"corrected\"");
  if (!options.output.empty() && names.size() + learned.size() > 1)
    throw InputError("-o", fmt::format("names one file for {} models", names.size() + learned.size()),
                     "--tracker NAME beside it");
  for (const std::string& name : learned) train_one_motion(study, name, options);
  if (names.empty()) return;
  std::vector<std::string> outputs;
  std::vector<std::filesystem::path> own;
  for (const std::string& name : names) {
    own.push_back(study.tracker(name).correction->model);
    outputs.push_back(options.output.empty() ? own.back().string() : options.output);
  }
  check_products(study, outputs, own);
  WorkflowOptions workflow{options.seed.value_or(study.seed()), options.threads, options.quiet};
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (study.tracker(names[i]).correction->design.network != NetworkKind::recurrent) continue;
    if (is_standard_output(outputs[i]))
      throw InputError("-o", "is one stream, and the model two files", "a file's name");
    workflow.checkpoints[names[i]] = outputs[i] + ".checkpoint";
  }
  const CorrectionModels models = train_study(study, names, workflow);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const CorrectionModel& model = *models.at(names[i]);
    if (weights_name(model).empty())
      write_output(outputs[i], model_text(model));
    else
      write_model_file(outputs[i], model);
    if (const auto checkpoint = workflow.checkpoints.find(names[i]); checkpoint != workflow.checkpoints.end()) {
      std::error_code ignored;
      std::filesystem::remove(checkpoint->second, ignored);
    }
    if (!is_standard_output(outputs[i])) fmt::print("written: {}\n", outputs[i]);
  }
}

}  // namespace

void add_train(const Subcommands& all) {
  auto options = std::make_shared<TrainArguments>();
  const Subcommand command = all.add("train", "train the corrections of a study and write their model files");
  add_study(command, options->study);
  command.argument("-o,--output", options->output, "model file; the one that the study names where not given");
  command.argument("--tracker", options->trackers, "only these corrected trackers");
  command.argument("--seed", options->seed, "seed; the study's own where not given");
  command.argument("--threads", options->threads, "0: one per core").within(0, 1024);
  command.flag("--quiet", options->quiet, "no progress");
  command.runs([options] { train(*options); });
}

}  // namespace truebearing
