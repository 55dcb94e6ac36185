// SPDX-License-Identifier: Apache-2.0
// truebearing new KIND [-o FILE]: a small complete study to begin with. These are data/templates/KIND.toml, studies that
// run as they stand. Where the comment of a line begins with "--option", the last numbers before it are the option's; the
// first line that says so has as many numbers as the option takes, and no other.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "app/data_folder.hpp"
#include "app/output.hpp"
#include "app/subcommands.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/io/file.hpp"

namespace truebearing {
namespace {

struct NewArguments {
  std::string kind;
  std::string output;
  std::vector<double> sigma;
  std::vector<double> period_s;
  std::vector<double> speeds;
};

const std::vector<std::string>& kinds() {
  static const std::vector<std::string> all{"radar", "polar", "bearings", "sonar", "array", "flight"};
  return all;
}

// Where the numbers of a text stand, and how long they are: digits that belong to a name are none.
std::vector<std::pair<std::size_t, std::size_t>> numbers_in(std::string_view text) {
  std::vector<std::pair<std::size_t, std::size_t>> places;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto belongs = [&](std::size_t k) {
      return k < text.size() && (std::isalnum(static_cast<unsigned char>(text[k])) || text[k] == '_' || text[k] == '.');
    };
    if (!belongs(i)) continue;
    const std::size_t begin = i;
    while (belongs(i)) ++i;
    if (std::isdigit(static_cast<unsigned char>(text[begin]))) places.emplace_back(begin, i - begin);
  }
  return places;
}

void check_numbers(const std::string& option, const std::vector<double>& numbers, std::size_t count) {
  if (numbers.size() != count)
    throw InputError(option, fmt::format("has {} numbers", numbers.size()),
                     fmt::format("{} for this kind; a radar of range and bearing is `truebearing new polar`", count));
  for (const double number : numbers)
    if (!(number > 0.0) || !std::isfinite(number))
      throw InputError(option, fmt::format("is {}", number), "numbers > 0");
  if (!std::is_sorted(numbers.begin(), numbers.end()) && option == "--speeds")
    throw InputError(option, "begins with the greatest", "LEAST GREATEST");
}

// Puts the numbers where lines say the option.
void set_option(std::string& study, const std::string& option, const std::vector<double>& numbers) {
  if (numbers.empty()) return;
  const std::string mark = "# " + option;
  const std::size_t first = study.find(mark);
  if (first == std::string::npos) throw InputError(option, "is nothing that a study of this kind has");
  for (std::size_t at = first; at != std::string::npos; at = study.find(mark, at + 1)) {
    const std::size_t line = study.rfind('\n', at) + 1;
    const auto places = numbers_in(std::string_view(study).substr(line, at - line));
    if (at == first) check_numbers(option, numbers, places.size());
    for (std::size_t i = 1; i <= numbers.size(); ++i) {
      const auto& [begin, length] = places.at(places.size() - i);
      const std::string text = fmt::format("{}", numbers[numbers.size() - i]);
      study.replace(line + begin, length, text);
      at += text.size() - length;
    }
  }
}

// "radar", "radar.parameters.toml", "radar.nfnn.json": of the study's own name.
void rename(std::string& study, const std::string& from, const std::string& to) {
  const std::string quoted = '"' + from;
  for (std::size_t at = study.find(quoted); at != std::string::npos; at = study.find(quoted, at + to.size()))
    if (const char next = study[at + quoted.size()]; next == '"' || next == '.') study.replace(at + 1, from.size(), to);
}

void write_new_study(const NewArguments& options) {
  constexpr std::size_t kMostBytes = std::size_t{1} << 20;
  const std::string output = options.output.empty() ? options.kind + ".toml" : options.output;
  if (!is_standard_output(output) && std::filesystem::exists(output))
    throw InputError(output, "is there already", "-o FILE of another name");
  std::string study = read_text_file(data_folder() / "data/templates" / (options.kind + ".toml"), kMostBytes);
  set_option(study, "--sigma", options.sigma);
  set_option(study, "--period", options.period_s);
  set_option(study, "--speeds", options.speeds);
  const std::string name = std::filesystem::path(output).stem().string();
  if (!is_standard_output(output)) rename(study, options.kind, name);
  write_output(output, study);
  if (is_standard_output(output)) return;
  fmt::print("written: {}\nnext: truebearing learn {} --report {}.html\n", output, output, name);
}

}  // namespace

void add_new(const Subcommands& all) {
  auto options = std::make_shared<NewArguments>();
  const Subcommand command = all.add("new", "write a small complete study to begin with");
  command
      .argument("kind", options->kind,
                fmt::format("{}: a radar that gives East and North, or range and bearing (polar), ...",
                            fmt::join(kinds(), ", ")))
      .required()
      .one_of(kinds());
  command.argument("-o,--output", options->output, "the file; KIND.toml where not given; - is standard output");
  command.argument(
      "--sigma", options->sigma,
      "standard deviation of what is measured: m (radar, flight), m and degrees (polar), degrees (bearings), degrees and "
      "Hz (sonar)");
  command.argument("--period", options->period_s, "s between measurements");
  command.argument("--speeds", options->speeds, "least and greatest of the targets, m/s");
  command.runs([options] { write_new_study(*options); });
}

}  // namespace truebearing
