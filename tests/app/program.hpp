// SPDX-License-Identifier: Apache-2.0
// Runs the built program as a user does: in a shell, in a folder of its own.
#pragma once

#include <csignal>
#include <cstdio>
#include <fcntl.h>
#include <filesystem>
#include <string>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/radar_study.hpp"
#include "tests/support/temporary_folder.hpp"

namespace truebearing::testing {

struct Outcome {
  int status = -1;  ///< exit status; 128 + the signal where one ended it
  std::string out;
  std::string err;
};

/// Starts `truebearing ARGUMENTS` in the folder, its output going to out.txt and err.txt beside the folder. `before` is
/// put in front in the shell ("ulimit -f 0;").
inline pid_t start(const TemporaryFolder& folder, const std::string& arguments, const std::filesystem::path& outputs,
                   const std::string& before = {}) {
  const std::string command =
      "cd '" + folder.path().string() + "'; " + before + " exec '" + TRUEBEARING_PROGRAM + "' " + arguments;
  const pid_t child = ::fork();
  if (child == 0) {
    const int in = ::open("/dev/null", O_RDONLY);
    const int out = ::open((outputs / "out.txt").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    const int err = ::open((outputs / "err.txt").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    ::dup2(in, 0);
    ::dup2(out, 1);
    ::dup2(err, 2);
    ::execl("/bin/sh", "sh", "-c", command.c_str(), static_cast<char*>(nullptr));
    ::_exit(127);
  }
  return child;
}

inline int wait_for(pid_t child) {
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

inline Outcome run(const TemporaryFolder& folder, const std::string& arguments, const std::string& before = {}) {
  const TemporaryFolder outputs;
  Outcome outcome;
  outcome.status = wait_for(start(folder, arguments, outputs.path(), before));
  outcome.out = outputs.read("out.txt");
  outcome.err = outputs.read("err.txt");
  return outcome;
}

inline bool is_one_line(const std::string& text) {
  return !text.empty() && text.find('\n') == text.size() - 1;
}

}  // namespace truebearing::testing
