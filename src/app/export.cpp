// SPDX-License-Identifier: Apache-2.0
// truebearing export MODEL --to onnx: a recurrent network for programs that run networks of that format.
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <string>

#include "app/output.hpp"
#include "app/subcommands.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/core/suggestion.hpp"
#include "truebearing/correction/model_file.hpp"
#include "truebearing/correction/onnx_file.hpp"

namespace truebearing {
namespace {

struct ExportArguments {
  std::string model;
  std::string to;
  std::string output;
};

void export_model(const ExportArguments& arguments) {
  if (arguments.to != "onnx")
    throw InputError("--to", "is \"" + arguments.to + "\"", suggestion(arguments.to, {"onnx"}));
  const std::filesystem::path file = arguments.model;
  const std::string output =
      arguments.output.empty() ? std::filesystem::path(file).replace_extension(".onnx").string() : arguments.output;
  const CorrectionModel model = read_model_file(file);
  check_outputs({output}, {file, file.parent_path() / weights_name(model)});
  const auto* network = std::get_if<GatedRecurrent>(&model.network);
  if (!network) throw InputError(arguments.model, "holds rules (nfnn)", "a recurrent network (gru)");
  write_output(output, onnx_bytes(network->parameters(), file.stem().string()));
  if (!is_standard_output(output)) fmt::print("written: {}\n", output);
}

}  // namespace

void add_export(const Subcommands& all) {
  auto arguments = std::make_shared<ExportArguments>();
  const Subcommand command = all.add("export", "write the recurrent network of a model for other programs");
  command.argument("model", arguments->model, "model file (JSON)").required();
  command.argument("--to", arguments->to, "its format: onnx").required();
  command.argument("-o,--output", arguments->output, "file; the model's name with .onnx where not given");
  command.runs([arguments] { export_model(*arguments); });
}

}  // namespace truebearing
