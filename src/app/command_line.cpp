#include "app/command_line.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <fmt/format.h>
#include <system_error>

#include "app/subcommands.hpp"
#include "truebearing/core/error.hpp"

namespace truebearing {

int command_line(int argc, const char* const* argv) {
  CLI::App app{"Trackers that learn to correct themselves.", "truebearing"};
  app.set_version_flag("--version", TRUEBEARING_VERSION);
  app.require_subcommand(1);
  const Subcommands all{app};
  add_simulate(all);
  add_tune(all);
  add_train(all);
  add_track(all);
  add_compare(all);
  add_check(all);
  add_rules(all);
  add_tma(all);
  try {
    app.parse(argc, argv);
    if (std::fflush(stdout) != 0) throw InputError("standard output", "cannot be written");
    return 0;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const InputError& error) {
    fmt::print(stderr, "truebearing: {}\n", error.what());
    return 1;
  } catch (const std::system_error& error) {  // of a full disk behind standard output, say
    fmt::print(stderr, "truebearing: {}\n", error.what());
    return 1;
  } catch (const std::exception& error) {
    fmt::print(stderr, "truebearing: internal error: {}\n", error.what());
    return 1;
  }
}

}  // namespace truebearing
