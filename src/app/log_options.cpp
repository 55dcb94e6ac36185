// SPDX-License-Identifier: Apache-2.0
#include "app/log_options.hpp"

#include <fmt/format.h>
#include <string_view>

#include "truebearing/core/error.hpp"
#include "truebearing/core/printable.hpp"

namespace truebearing {
namespace {

std::string trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(' ');
  return first == text.npos ? std::string() : std::string(text.substr(first, text.find_last_not_of(' ') - first + 1));
}

// "rng=range_km,remark=": what the file calls a column and what it is called here.
std::vector<std::pair<std::string, std::string>> read_columns(std::string_view list) {
  std::vector<std::pair<std::string, std::string>> columns;
  while (!list.empty()) {
    const std::string_view one = list.substr(0, list.find(','));
    const std::size_t equals = one.rfind('=');
    if (equals == one.npos || trimmed(one.substr(0, equals)).empty())
      throw InputError("--columns", "holds " + as_shown(one),
                       "a name in the file = a name here, as in time=time_s,rng=range_km; no name leaves a column out");
    columns.emplace_back(trimmed(one.substr(0, equals)), trimmed(one.substr(equals + 1)));
    list.remove_prefix(std::min(list.size(), one.size() + 1));
  }
  return columns;
}

}  // namespace

RecordingOptions LogArguments::over(RecordingOptions options) const {
  if (!columns.empty()) options.columns = read_columns(columns);
  if (!track_id.empty()) options.target = track_id;
  if (sort_window_s >= 0.0) options.sort_window_s = sort_window_s;
  return options;
}

void add_log_arguments(const Subcommand& command, LogArguments& arguments) {
  command.argument("--columns", arguments.columns,
                   "names of the log's columns: time=time_s,rng=range_km; rng= leaves one out");
  command.argument("--track-id", arguments.track_id, "the target whose rows are read, where the log has several");
  command.argument("--sort-window", arguments.sort_window_s, "put rows in order that come up to so many seconds late")
      .non_negative();
}

void print_note(const std::string& log, const std::string& note) {
  constexpr std::size_t kMostShown = 186;
  if (!note.empty())
    fmt::print(stderr, "truebearing: {}\n",
               shortened(printable(shortened_from_front(log, 60) + ": " + note), kMostShown));
}

}  // namespace truebearing
