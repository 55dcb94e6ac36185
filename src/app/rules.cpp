// SPDX-License-Identifier: Apache-2.0
// truebearing rules MODEL: what a trained correction is: its sizes, inputs, scores, and its rules as a table or as
// sentences.
#include <cctype>
#include <fmt/format.h>
#include <memory>
#include <string>
#include <vector>

#include "app/subcommands.hpp"
#include "app/terminal.hpp"
#include "truebearing/correction/feature.hpp"
#include "truebearing/correction/frame.hpp"
#include "truebearing/correction/model_file.hpp"
#include "truebearing/correction/rule_report.hpp"

namespace truebearing {
namespace {

constexpr const char* kInitials =
    "Letters are initials: VS very small, S small, M medium, L large, VL very large; or LN large negative, N negative, "
    "SN small\nnegative, NZ near zero, SP small positive, P positive, LP large positive.\n";

struct RulesArguments {
  std::string model;
  bool sentences = false;
  TableArguments tables;
};

// "VERY SMALL" as "VS".
std::string initials(const std::string& words) {
  std::string letters;
  bool begins = true;
  for (const char c : words) {
    if (begins && std::isalpha(static_cast<unsigned char>(c)) != 0) letters += c;
    begins = c == ' ';
  }
  return letters;
}

// a, b, ..., z, a2, b2, ...
std::string letter(std::size_t i) {
  const std::string one(1, static_cast<char>('a' + i % 26));
  return i < 26 ? one : one + std::to_string(i / 26 + 1);
}

Eigen::Index weights_of(const GatedRecurrent::Parameters& p) {
  return p.encoder_weight.size() + p.encoder_bias.size() + p.weight_ih.size() + p.weight_hh.size() + p.bias_ih.size() +
         p.bias_hh.size() + p.output_weight.size() + p.output_bias.size() + p.covariance_weight.size() +
         p.covariance_bias.size();
}

std::string sizes(const CorrectionModel& model) {
  const std::size_t inputs = model.design.features.size();
  const int outputs = model.space->size();
  if (const auto* gru = std::get_if<GatedRecurrent>(&model.network))
    return fmt::format("a recurrent network (GRU): {} inputs, {} of memory, {} outputs, {} weights; it holds no rules",
                       inputs, describe(model.network), outputs, weights_of(gru->parameters()));
  return fmt::format("a fuzzy network (NFNN): {} inputs, {}, {} outputs", inputs, describe(model.network), outputs);
}

std::string facts(const CorrectionModel& model, const std::string& file) {
  const CorrectionDesign& design = model.design;
  std::string text =
      fmt::format("{} corrects {} towards the truth; trusted: {}\n", file, design.base, design.reference);
  text += fmt::format("  network: {}\n  frame: {}, corrections in {}\n  covariance: {}\n  gate: {}\n", sizes(model),
                      to_string(design.frame),
                      design.output_in_sigma ? "standard deviations of " + design.base : "units of the state",
                      design.covariance_moments ? "of its own" : "that of " + design.covariance_of + ", scaled",
                      model.gate ? "the box of what was taught" : "none");
  for (const auto& [key, value] : model.provenance) text += fmt::format("  {}: {}\n", key, value);
  return text;
}

std::string inputs_table(const CorrectionModel& model, const TableLayout& layout) {
  const auto* gru = std::get_if<GatedRecurrent>(&model.network);
  const Eigen::VectorXd mean = gru ? gru->parameters().input_mean : model.rules().network.parameters().input_mean;
  const Eigen::VectorXd scale = gru ? gru->parameters().input_scale : model.rules().network.parameters().input_scale;
  Rows rows{{"input", "mean", "scale"}};
  for (std::size_t i = 0; i < model.design.features.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    rows.push_back(
        {fmt::format("{}  {}", letter(i), describe(model.design.features[i])), figure(mean[at]), figure(scale[at])});
  }
  return aligned(rows, layout);
}

std::string rules_table(const CorrectionModel& model, const TableLayout& layout) {
  constexpr double kPercent = 100.0;
  const StateSpace& space = space_in(model.design.frame, *model.space);
  Rows rows{{"rule", "usage %"}};
  for (std::size_t i = 0; i < model.design.features.size(); ++i) rows[0].push_back(letter(i));
  for (const std::string& component : space.components)
    rows[0].push_back((model.design.output_in_sigma ? "adds sigmas of " : "adds ") + component);
  int number = 0;
  for (const ReportedRule& rule : reported_rules(model)) {
    std::vector<std::string> row{std::to_string(++number), fmt::format("{:.1f}", kPercent * rule.usage)};
    for (const std::string& term : rule.terms) row.push_back(initials(term));
    for (const double value : rule.added) row.push_back(fmt::format("{:+.3g}", value));
    rows.push_back(std::move(row));
  }
  return aligned(rows, layout) + "\n" + kInitials;
}

void print_rules(const RulesArguments& arguments) {
  const CorrectionModel model = read_model_file(arguments.model);
  const TableLayout layout = arguments.tables.layout();
  fmt::print("{}\n", facts(model, arguments.model));
  const bool has_rules = std::holds_alternative<RuleBase>(model.network);
  if (has_rules && arguments.sentences) {
    fmt::print("{}", rule_sentences(model));
    return;
  }
  fmt::print("{}", inputs_table(model, layout));
  if (has_rules) fmt::print("\n{}", rules_table(model, layout));
}

}  // namespace

void add_rules(const Subcommands& all) {
  auto arguments = std::make_shared<RulesArguments>();
  const Subcommand command = all.add("rules", "print what a model file holds, and its rules as a table");
  command.argument("model", arguments->model, "model file (JSON)").required();
  command.flag("--sentences", arguments->sentences, "the rules as sentences, with what the teacher said");
  add_table_arguments(command, arguments->tables);
  command.runs([arguments] { print_rules(*arguments); });
}

}  // namespace truebearing
