// truebearing check STUDY.toml: is it valid, and what would it run.
#include <fmt/format.h>
#include <memory>

#include "app/subcommands.hpp"
#include "truebearing/study/study.hpp"

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

void check(const std::string& path) {
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
}

}  // namespace

void add_check(const Subcommands& all) {
  auto path = std::make_shared<std::string>();
  const Subcommand command = all.add("check", "say whether a study is valid and what it would run");
  command.argument("study", *path, "study file (TOML)").required();
  command.runs([path] { check(*path); });
}

}  // namespace truebearing
