// SPDX-License-Identifier: Apache-2.0
// The subcommands, each in a file of its own. add_...() declares its arguments and what it runs.
#pragma once

#include "app/arguments.hpp"

namespace truebearing {

void add_new(const Subcommands& all);
void add_simulate(const Subcommands& all);
void add_tune(const Subcommands& all);
void add_train(const Subcommands& all);
void add_learn(const Subcommands& all);
void add_track(const Subcommands& all);
void add_smooth(const Subcommands& all);
void add_compare(const Subcommands& all);
void add_merge(const Subcommands& all);
void add_rare(const Subcommands& all);
void add_report(const Subcommands& all);
void add_check(const Subcommands& all);
void add_rules(const Subcommands& all);
void add_export(const Subcommands& all);
void add_keys(const Subcommands& all);
void add_tma(const Subcommands& all);

}  // namespace truebearing
