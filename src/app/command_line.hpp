// SPDX-License-Identifier: Apache-2.0
// The command line as one function, so that a program that registers trackers of its own has all of it.
#pragma once

namespace truebearing {

/// Runs `truebearing` with these arguments. Exit status: 0 done; 1 the input is at fault; 2 wrong usage.
int command_line(int argc, const char* const* argv);

}  // namespace truebearing
