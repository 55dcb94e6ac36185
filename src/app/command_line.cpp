// SPDX-License-Identifier: Apache-2.0
#include "app/command_line.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <fcntl.h>
#include <fmt/format.h>
#include <iostream>
#include <new>
#include <string>
#include <system_error>
#include <unistd.h>
#include <vector>

#include "app/data_folder.hpp"
#include "app/output.hpp"
#include "app/subcommands.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/core/printable.hpp"
#include "truebearing/core/suggestion.hpp"

namespace truebearing {
namespace {

// A file that is opened where a standard stream is closed would take its place, and what is meant for the stream would
// end in the file. In place of such a stream stands one that refuses what it is for.
void occupy_standard_streams() {
  for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; ++stream)
    if (::fcntl(stream, F_GETFD) == -1) ::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

int fail(const std::string& what) {
  say("truebearing: " + what);
  return 1;
}

// The first argument where it should be a subcommand and is none.
std::string unknown_subcommand(const CLI::App& app, int argc, const char* const* argv) {
  if (argc < 2 || argv[1][0] == '-' || argv[1][0] == '\0') return {};
  const std::string name = argv[1];
  std::vector<std::string> names;
  for (const CLI::App* subcommand : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(subcommand->get_name());
  if (std::find(names.begin(), names.end(), name) != names.end()) return {};
  return InputError("command line", as_shown(name) + " is no subcommand", suggestion(name, names)).what();
}

// Help, the version, or what is wrong with the usage.
int finish(CLI::App& app, const CLI::ParseError& error) {
  constexpr std::size_t kLongestFault = 220;
  if (error.get_exit_code() != 0) {
    fail(shortened(printable(error.what()), kLongestFault) + "; --help says what is valid");
    return 2;
  }
  app.exit(error);
  if (!std::cout.flush() || std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
    return fail("standard output: cannot be written");
  return 0;
}

}  // namespace

int command_line(int argc, const char* const* argv) {
  CLI::App app{"Trackers that learn to correct themselves.", "truebearing"};
  app.set_version_flag("--version", TRUEBEARING_VERSION);
  app.add_flag_callback(
         "--data-dir",
         [] {
           fmt::print("{}\n", data_folder().string());
           throw CLI::Success();
         },
         "Display the folder of the scenarios, studies and models that come with the program and exit")
      ->trigger_on_parse();
  app.require_subcommand(1);
  const Subcommands all{app};
  add_new(all);
  add_simulate(all);
  add_tune(all);
  add_train(all);
  add_learn(all);
  add_track(all);
  add_smooth(all);
  add_compare(all);
  add_merge(all);
  add_rare(all);
  add_report(all);
  add_check(all);
  add_rules(all);
  add_export(all);
  add_keys(all);
  add_tma(all);
  occupy_standard_streams();
  std::ios::sync_with_stdio(false);  // of standard input is known then what has come
  try {
    app.parse(argc, argv);
    if (std::fflush(stdout) != 0) throw InputError("standard output", "cannot be written");
    return 0;
  } catch (const CLI::ParseError& error) {
    if (const std::string unknown = unknown_subcommand(app, argc, argv); !unknown.empty()) return fail(unknown) + 1;
    return finish(app, error);
  } catch (const InputError& error) {
    return fail(error.what());
  } catch (const std::system_error& error) {  // of a full disk behind standard output, say
    const std::string what = error.what();
    return fail(what.starts_with("cannot write to file") ? "standard output: " + what : what);
  } catch (const std::bad_alloc&) {
    return fail("there is not enough memory for this");
  } catch (const std::exception& error) {
    return fail(fmt::format("internal error: {}", error.what()));
  }
}

}  // namespace truebearing
