// truebearing tune STUDY.toml [-o FILE]: baseline parameters fitted to training draws.
#include <fmt/format.h>
#include <memory>

#include "app/output.hpp"
#include "app/subcommands.hpp"
#include "app/workflow.hpp"

namespace truebearing {
namespace {

struct Options {
  std::string study;
  std::string output;
  std::uint64_t seed = 0;
  int threads = 0;
  bool quiet = false;
};

void tune(const Options& options, bool seed_given) {
  Study study = Study::load(options.study);
  const std::string output = options.output.empty() ? study.parameters_path().string() : options.output;
  const ParametersFile parameters =
      tune_study(study, {seed_given ? options.seed : study.seed(), options.threads, options.quiet});
  if (parameters.trackers.empty()) throw InputError(options.study, "has no tracker with a key `tune`");
  if (output.empty()) throw InputError(options.study, "has no key `parameters`", "that key, or -o FILE");
  write_output(output, parameters_text(parameters));
  if (output != "-") fmt::print("written: {}\n", output);
}

}  // namespace

void add_tune(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("tune", "fit the baselines' parameters (Q, R, P0) to training draws");
  command->add_option("study", options->study, "study file (TOML)")->required();
  command->add_option("-o,--output", options->output, "parameters file; the one that the study names where not given");
  CLI::Option* seed = command->add_option("--seed", options->seed, "seed; the study's own where not given");
  command->add_option("--threads", options->threads, "0: one per core")->check(CLI::Range(0, 1024));
  command->add_flag("--quiet", options->quiet, "no progress");
  command->callback([options, seed] { tune(*options, seed->count() > 0); });
}

}  // namespace truebearing
