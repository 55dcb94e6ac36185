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
#include "app/ranks_of_mpirun.hpp"
#include "app/subcommands.hpp"
#include "app/workflow.hpp"

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

void train(const TrainArguments& options, Ranks* ranks) {
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
  std::vector<std::filesystem::path> own;
  std::vector<std::string> outputs, motions;
  const auto output_of = [&](const std::filesystem::path& file) {
    own.push_back(file);
    return options.output.empty() ? file.string() : options.output;
  };
  for (const std::string& name : names) outputs.push_back(output_of(study.tracker(name).correction->model));
  for (const std::string& name : learned) motions.push_back(output_of(study.tracker(name).learned->file));
  std::vector<std::string> all = outputs;
  all.insert(all.end(), motions.begin(), motions.end());
  WorkflowOptions workflow{options.seed.value_or(study.seed()), options.threads, options.quiet || !is_first(ranks),
                           ranks};
  check_ranks(ranks, inputs_without(study, own),
              fmt::format("{} {} {}", workflow.seed, fmt::join(names, " "), fmt::join(learned, " ")));
  if (is_first(ranks)) check_products(study, all, own);
  keep_checkpoints(study, names, outputs, workflow);
  train_motions(study, learned, motions, workflow);  // first: filters that are corrected may have them
  if (names.empty()) return;
  const CorrectionModels models = train_study(study, names, workflow);
  if (!is_first(ranks)) return;
  for (std::size_t i = 0; i < names.size(); ++i) write_model(outputs[i], *models.at(names[i]));
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
  command.runs([options] { with_ranks([&](Ranks* ranks) { train(*options, ranks); }); });
}

}  // namespace truebearing
