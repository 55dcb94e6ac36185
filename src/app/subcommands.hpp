// The subcommands, each in a file of its own. add_...() declares its options; its callback does the work and throws
// InputError where the input is at fault.
#pragma once

#include <CLI/CLI.hpp>

namespace truebearing {

void add_simulate(CLI::App& app);
void add_tune(CLI::App& app);
void add_train(CLI::App& app);
void add_track(CLI::App& app);
void add_compare(CLI::App& app);
void add_check(CLI::App& app);
void add_rules(CLI::App& app);
void add_tma(CLI::App& app);

}  // namespace truebearing
