// SPDX-License-Identifier: Apache-2.0
// truebearing tune STUDY.toml [-o FILE]: baseline parameters fitted to training draws.
#include <cstdint>
#include <fmt/format.h>
#include <memory>
#include <optional>

#include "app/data_folder.hpp"
#include "app/ranks_of_mpirun.hpp"
#include "app/subcommands.hpp"
#include "app/workflow.hpp"

namespace truebearing {
namespace {

struct TuneArguments {
  std::string study;
  std::string output;
  std::optional<std::uint64_t> seed;
  int threads = 0;
  bool quiet = false;
};

void tune(const TuneArguments& options, Ranks* ranks) {
  Study study = Study::load(options.study);
  const std::string output = options.output.empty() ? study.parameters_path().string() : options.output;
  if (!has_tuned_trackers(study)) throw InputError(options.study, "has no tracker with a key `tune`");
  if (output.empty()) throw InputError(options.study, "has no key `parameters`", "that key, or -o FILE");
  const std::uint64_t seed = options.seed.value_or(study.seed());
  check_ranks(ranks, inputs_without(study, {study.parameters_path()}), fmt::format("{}", seed));
  if (is_first(ranks)) check_products(study, {output}, {study.parameters_path()});
  const ParametersFile parameters =
      tune_study(study, {seed, options.threads, options.quiet || !is_first(ranks), ranks});
  if (is_first(ranks)) write_parameters(output, parameters);
}

}  // namespace

void add_tune(const Subcommands& all) {
  auto options = std::make_shared<TuneArguments>();
  const Subcommand command = all.add("tune", "fit the baselines' parameters (Q, R, P0) to training draws");
  add_study(command, options->study);
  command.argument("-o,--output", options->output, "parameters file; the one that the study names where not given");
  command.argument("--seed", options->seed, "seed; the study's own where not given");
  command.argument("--threads", options->threads, "0: one per core").within(0, 1024);
  command.flag("--quiet", options->quiet, "no progress");
  command.runs([options] { with_ranks([&](Ranks* ranks) { tune(*options, ranks); }); });
}

}  // namespace truebearing
