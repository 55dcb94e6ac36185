// SPDX-License-Identifier: Apache-2.0
// truebearing check FILE: of a study, is it valid, and what would it run; of a recorded log, what it holds.
#include <filesystem>
#include <fmt/format.h>
#include <memory>

#include "app/check_log.hpp"
#include "app/data_folder.hpp"
#include "app/subcommands.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/recording/snapshot_log.hpp"
#include "truebearing/study/study.hpp"
#include "truebearing/tracker/step_log.hpp"

namespace truebearing {
namespace {

void describe_correction(const Study& study, const TrackerSpec& spec) {
  const CorrectionSpec& correction = *spec.correction;
  fmt::print("    corrects {}, trusts {}, covariance of {}, kappa {}\n", correction.design.base,
             correction.design.reference, correction.design.covariance_of, correction.bounds.kappa);
  for (const FeatureSpec& feature : correction.design.features) fmt::print("    feature: {}\n", describe(feature));
  try {
    study.load_model(spec.name);
    fmt::print("    model: {}\n", correction.model.string());
  } catch (const InputError& missing) {
    fmt::print("    not ready: {}\n", missing.what());
  }
}

struct CheckArguments {
  std::string file;
  std::string json;
  LogArguments reading;
};

void check_study(const std::string& path) {
  const Study study = Study::load(path);
  fmt::print("{}: {} runs, seed {}, scored from step {}\n", study.name(), study.runs(), study.seed(),
             study.scoring().from_step);
  for (const TrackerSpec& spec : study.trackers()) {
    fmt::print("  {} ({}{})\n", spec.name, spec.kind, spec.shown ? "" : ", not shown");
    if (spec.correction) {
      describe_correction(study, spec);
      continue;
    }
    try {
      fmt::print("    {}\n", study.configuration_line(spec.name));
    } catch (const InputError& missing) {
      fmt::print("    not ready: {}\n", missing.what());
    }
  }
  fmt::print("{}", study.note());
}

void check(const CheckArguments& options) {
  const bool is_study = std::filesystem::path(options.file).extension() == ".toml";
  const bool is_array = !is_study && is_snapshot_log(options.file);
  const bool is_steps = !is_study && !is_array && is_step_log(options.file);
  if (!is_study && !is_array && !is_steps) return check_log_file(options.file, options.reading, options.json);
  if (!options.json.empty()) throw InputError("--json", "is of logs of measurements in CSV", "no --json");
  if (is_study)
    check_study(options.file);
  else if (is_steps)
    check_step_log(options.file);
  else
    check_snapshot_log(options.file);
}

}  // namespace

void add_check(const Subcommands& all) {
  auto options = std::make_shared<CheckArguments>();
  const Subcommand command = all.add(
      "check", "say whether a study is valid and what it would run, or what a log holds and whether it can be used");
  command
      .argument(
          "file", options->file,
          "study file (.toml), or the name of one that comes with the program; or recorded log (CSV or HDF5) or step log; - is "
          "standard input")
      .required()
      .read_as(study_file);
  command.argument("--json", options->json, "write what was found in a log as JSON; - is standard output");
  add_log_arguments(command, options->reading);
  command.runs([options] { check(*options); });
}

}  // namespace truebearing
