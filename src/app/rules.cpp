// SPDX-License-Identifier: Apache-2.0
// truebearing rules MODEL: the learned rules, as sentences.
#include <fmt/format.h>
#include <memory>

#include "app/subcommands.hpp"
#include "truebearing/correction/model_file.hpp"
#include "truebearing/correction/rule_report.hpp"

namespace truebearing {

void add_rules(const Subcommands& all) {
  auto path = std::make_shared<std::string>();
  const Subcommand command = all.add("rules", "print the rules of a model file as sentences");
  command.argument("model", *path, "model file (JSON)").required();
  command.runs([path] {
    const CorrectionModel model = read_model_file(*path);
    fmt::print("{} corrects {} towards the truth; trusted: {}\n", *path, model.design.base, model.design.reference);
    for (const auto& [key, value] : model.provenance) fmt::print("  {}: {}\n", key, value);
    if (std::holds_alternative<RuleBase>(model.network))
      fmt::print("\n{}", rule_sentences(model));
    else
      fmt::print("\nA recurrent network of {}: it holds no rules.\n", describe(model.network));
  });
}

}  // namespace truebearing
