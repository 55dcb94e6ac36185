// SPDX-License-Identifier: Apache-2.0
// truebearing rare STUDY.toml TRACKER: how often a tracker loses its target, where that is too rare to be counted.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/data_folder.hpp"
#include "app/output.hpp"
#include "app/subcommands.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/core/suggestion.hpp"
#include "truebearing/evaluation/rare_loss.hpp"
#include "truebearing/evaluation/text_table.hpp"
#include "truebearing/io/json_file.hpp"
#include "truebearing/study/study.hpp"

namespace truebearing {
namespace {

struct RareArguments {
  std::string study, tracker, set, json;
  std::vector<std::string> loss;
  std::optional<std::uint64_t> seed;
  std::uint64_t draws = 2000, repetitions = 20, plain = 0;
  int threads = 0;
  bool quiet = false;
};

TrackerSet only(const Study& study, const std::string& name) {
  const TrackerSpec& spec = study.tracker(name);
  TrackerSet set(study.make_ensemble(spec.correction ? spec.correction->members() : std::vector<std::string>{name}));
  if (spec.correction)
    set.show_correction(name, study.load_model(name), spec.correction->bounds);
  else
    set.show_member(name);
  return set;
}

NamedScenario set_of(const Study& study, const std::string& name) {
  const std::vector<NamedScenario> sets = study.evaluation_scenarios();
  if (name.empty() && sets.size() == 1) return sets.front();
  std::vector<std::string> names;
  for (const NamedScenario& set : sets) {
    if (set.name == name) return set;
    names.push_back(set.name);
  }
  if (name.empty())
    throw InputError("--set", "is not given, and the study has several", fmt::format("{}", fmt::join(names, ", ")));
  throw InputError("--set", fmt::format("\"{}\" is no set of the study", name), suggestion(name, names));
}

// What is scored, with the thresholds "position_m=1000" in place of the study's where any are given.
ScoringRule rule_of(const Study& study, const RareArguments& arguments, const StateSpace& truth,
                    const StateSpace& space) {
  ScoringRule rule = study.scoring();
  if (arguments.loss.empty()) return rule;
  rule.loss_thresholds.clear();
  const Scorer scorer(truth, space);
  for (const std::string& text : arguments.loss) {
    const std::size_t equals = std::min(text.find('='), text.size());
    const std::string quantity = text.substr(0, equals);
    const char* const end = text.data() + text.size();
    double threshold = 0.0;
    const auto [read, status] = std::from_chars(std::min(text.data() + equals + 1, end), end, threshold);
    if (status != std::errc() || read != end || !(threshold > 0.0) || !std::isfinite(threshold))
      throw InputError("--loss", "is \"" + text + "\"", "QUANTITY=ERROR, as position_m=1000");
    if (!scorer.quantity(quantity))
      throw InputError("--loss", fmt::format("\"{}\" is no quantity of {}", quantity, arguments.tracker),
                       suggestion(quantity, scorer.quantities()));
    rule.loss_thresholds.emplace_back(quantity, threshold);
  }
  return rule;
}

// The loss rate over plain runs, those of compare, and its standard error (share_of()).
Estimate plain_loss(const TrackerSet& tracker, const NamedScenario& set, const ScoringRule& rule,
                    const RareArguments& arguments, std::uint64_t seed) {
  ComparisonOptions options;
  options.seed = seed;
  options.runs = arguments.plain;
  options.threads = arguments.threads;
  options.scoring = rule;
  ProgressLine progress("plain runs", arguments.quiet);
  options.progress = progress.callback();
  const double rate = compare(tracker, {set}, options).trackers.front().loss_rate;
  const double runs = static_cast<double>(options.runs);
  return share_of(std::round(rate * runs), runs);
}

// "position_m beyond 1000"; several joined by "or".
std::string conditions(const ScoringRule& rule, double score) {
  std::vector<std::string> all;
  for (const auto& [quantity, threshold] : rule.loss_thresholds)
    all.push_back(fmt::format("{} beyond {}", quantity, figure(score * threshold)));
  return fmt::format("{}", fmt::join(all, " or "));
}

std::string probability(double value) {
  return fmt::format("{:.3g}", value);
}

std::string text_of(const RareArguments& arguments, const NamedScenario& set, const ScoringRule& rule,
                    const RareLoss& loss) {
  const auto [rate, se] = loss.loss_rate;
  std::string text =
      fmt::format("{} of {}: lost, its last error in {}, ", arguments.tracker, set.name, conditions(rule, 1.0));
  text += rate > 0.0 ? fmt::format("with probability {} +- {:.2g}\n", probability(rate), se)
                     : std::string("was not found\n");
  text += fmt::format("{} repetitions of {} levels of {} runs: {} runs", loss.repetitions.size(), loss.levels.size(),
                      arguments.draws, loss.runs);
  if (se > 0.0) text += fmt::format("; plain runs for that error: {:.2g}", rate * (1.0 - rate) / (se * se));
  text += "\n\n";
  Rows rows{{"last error in", "probability", "+-", "moves taken %"}};
  for (const RareLoss::Level& level : loss.levels)
    rows.push_back({conditions(rule, level.score), probability(level.probability.value),
                    fmt::format("{:.2g}", level.probability.se),
                    std::isnan(level.taken) ? "-" : fmt::format("{:.0f}", 100.0 * level.taken)});
  return text + aligned(rows);
}

// What whoever reads the figure should know; mostly nothing.
std::string warning(const RareLoss& loss) {
  const std::vector<double>& all = loss.repetitions;
  const double most_of_all = std::max(0.4, 2.0 / static_cast<double>(all.size()));
  const double largest = *std::max_element(all.begin(), all.end());
  const double sum = loss.loss_rate.value * static_cast<double>(all.size());
  const auto none = std::count(all.begin(), all.end(), 0.0);
  if (none == 0 && largest <= most_of_all * sum) return {};
  if (sum == 0.0) return "no repetition found a loss, which does not say that there is none: more --draws\n";
  return fmt::format(
      "{} of the {} repetitions found no loss and one {:.0f} % of all: do not trust the standard error; "
      "more --draws\n",
      none, all.size(), 100.0 * largest / sum);
}

nlohmann::ordered_json json_of(const Study& study, const RareArguments& arguments, const NamedScenario& set,
                               const ScoringRule& rule, std::uint64_t seed, const RareLoss& loss) {
  nlohmann::ordered_json json{{"study", study.name()},
                              {"set", set.name},
                              {"tracker", arguments.tracker},
                              {"seed", seed},
                              {"version", TRUEBEARING_VERSION},
                              {"loss_rate", loss.loss_rate.value},
                              {"loss_rate_se", loss.loss_rate.value > 0.0 ? loss.loss_rate.se : kNaN},
                              {"draws", arguments.draws},
                              {"runs", loss.runs},
                              {"repetitions", loss.repetitions}};
  for (const auto& [quantity, threshold] : rule.loss_thresholds) json["loss_thresholds"][quantity] = threshold;
  for (const RareLoss::Level& level : loss.levels)
    json["levels"].push_back({{"of_threshold", level.score},
                              {"probability", level.probability.value},
                              {"se", level.probability.se},
                              {"taken", level.taken}});
  return json;
}

void rare(const RareArguments& arguments) {
  const Study study = Study::load(arguments.study);
  check_outputs({arguments.json}, study.input_files());
  const TrackerSet tracker = only(study, arguments.tracker);
  const NamedScenario set = set_of(study, arguments.set);
  const ScoringRule rule = rule_of(study, arguments, set.scenario->truth_space(), tracker.space(0));
  const std::uint64_t seed = arguments.seed.value_or(study.seed());
  RareLoss loss;
  {
    ProgressLine progress("rare " + arguments.tracker, arguments.quiet);
    loss = rare_loss(tracker, *set.scenario, rule,
                     {seed, arguments.draws, arguments.repetitions, arguments.threads, progress.callback()});
  }
  std::string text = text_of(arguments, set, rule, loss);
  nlohmann::ordered_json json = json_of(study, arguments, set, rule, seed, loss);
  if (arguments.plain > 0) {
    const auto [rate, se] = plain_loss(tracker, set, rule, arguments, seed);
    text += fmt::format("\n{} plain runs: {} +- {:.2g}; apart by {:.1f} standard errors\n", arguments.plain,
                        probability(rate), se, (loss.loss_rate.value - rate) / std::hypot(loss.loss_rate.se, se));
    json["plain"] = {{"runs", arguments.plain}, {"loss_rate", rate}, {"loss_rate_se", se}};
  }
  if (const std::string warned = warning(loss); !warned.empty()) text += "\n" + warned;
  if (!is_standard_output(arguments.json)) fmt::print("{}", text);
  if (!arguments.json.empty()) write_output(arguments.json, json_text(json));
}

}  // namespace

void add_rare(const Subcommands& all) {
  auto options = std::make_shared<RareArguments>();
  const Subcommand command = all.add("rare", "tell how often a tracker loses its target, where that is rare");
  add_study(command, options->study);
  command.argument("tracker", options->tracker, "one of the study's trackers").required();
  command.argument("--loss", options->loss,
                   "QUANTITY=ERROR, as position_m=1000: lost is what ends beyond it; the study's loss_thresholds where "
                   "not given");
  command.argument("--set", options->set, "the set of the study, where it has several");
  command.argument("--draws", options->draws, "runs of a level").within(20, 1000000);
  command.argument("--repetitions", options->repetitions, "independent ones, for the standard error").within(2, 10000);
  command.argument("--plain", options->plain, "count so many plain runs too, and compare").within(1, 1000000000);
  command.argument("--seed", options->seed, "seed; the study's own where not given");
  command.argument("--threads", options->threads, "0: one per core").within(0, 1024);
  command.argument("--json", options->json, "write the results as JSON; - is standard output");
  command.flag("--quiet", options->quiet, "no progress");
  command.runs([options] { rare(*options); });
}

}  // namespace truebearing
