// SPDX-License-Identifier: Apache-2.0
// truebearing merge PART.json... -o FILE.json: the shards of one comparison as the results of all its runs.
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "app/output.hpp"
#include "app/shard.hpp"
#include "app/subcommands.hpp"
#include "truebearing/core/error.hpp"

namespace truebearing {
namespace {

struct MergeArguments {
  std::vector<std::string> parts;
  CompareStudyOptions options;
};

void merge(const MergeArguments& arguments) {
  std::vector<std::string> parts = arguments.parts;
  CompareStudyOptions options = arguments.options;
  const ShardHeader header = read_headers(parts);
  std::error_code unknown;
  if (!std::filesystem::exists(header.study, unknown))
    throw InputError(parts.front(), "is of " + header.study + ", which is not there", "that study where it was");
  if (options.report.wanted() && !header.details)
    throw InputError(parts.front(), "has nothing for the plots of a page", "shards of compare --shard --details");
  Study study = Study::load(header.study);
  if (header.all) study.show_all();
  if (hash_of_inputs(study) != header.inputs)
    throw InputError(header.study, "or a file that it names, has changed since " + parts.front() + " was written",
                     "shards of the study as it is");
  std::vector<std::filesystem::path> inputs = study.input_files();
  inputs.insert(inputs.end(), parts.begin(), parts.end());
  check_outputs(options.report, {options.json}, inputs);
  options.seed = header.seed;
  options.runs = header.runs;
  options.details = header.details;
  const CorrectionModels models;
  StudyComparison comparison(study, models, options);
  ComparisonFigures figures(comparison.runs());
  add_shards(parts, comparison.runs(), figures);
  comparison.write(figures.comparison());
}

}  // namespace

void add_merge(const Subcommands& all) {
  auto arguments = std::make_shared<MergeArguments>();
  CompareStudyOptions& options = arguments->options;
  const Subcommand command = all.add("merge", "make the results of all runs of the shards that compare --shard wrote");
  command.argument("parts", arguments->parts, "all shards of one comparison, in any order").required();
  command.argument("-o,--output", options.json, "write the results as JSON; - is standard output");
  add_report_arguments(command, options.report);
  add_table_arguments(command, options.tables);
  command.runs([arguments] { merge(*arguments); });
}

}  // namespace truebearing
