// SPDX-License-Identifier: Apache-2.0
// What every subcommand that reads a recorded log takes to read it by: --columns, --track-id, --sort-window.
#pragma once

#include <string>

#include "app/arguments.hpp"
#include "truebearing/recording/recording_options.hpp"

namespace truebearing {

struct LogArguments {
  std::string columns;
  std::string track_id;
  double sort_window_s = -1.0;  ///< not given

  /// `options` with what was given in place of its own. Throws InputError where --columns is no list of name=name.
  RecordingOptions over(RecordingOptions options) const;
};

/// Declares the options; `arguments` must live until the subcommand runs.
void add_log_arguments(const Subcommand& command, LogArguments& arguments);

/// Says on standard error what was found while the log was read, in one line; nothing of an empty note.
void print_note(const std::string& log, const std::string& note);

}  // namespace truebearing
