// SPDX-License-Identifier: Apache-2.0
// What the subcommands share of their output: files or standard output, and progress on a terminal.
#pragma once

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "truebearing/io/file.hpp"

namespace truebearing {

/// Is it standard output: "-", or what else leads there ("/dev/stdout")?
bool is_standard_output(const std::string& path);

/// To be called before the work. Throws InputError where an output would destroy one of the run's own inputs, through
/// links too, where two outputs are one file, or where nothing can be written. Empty outputs are passed over; "-" among
/// the inputs is standard input.
void check_outputs(const std::vector<std::string>& outputs, const std::vector<std::filesystem::path>& inputs);

/// An output that is written as its text comes: to standard output, a pipe or a device at once, to a file so that it is
/// there whole after finish() and not before. Throws InputError.
class OutputStream {
 public:
  explicit OutputStream(const std::string& path);
  ~OutputStream();

  void write(std::string_view text);
  /// Passes on what was written; a file has time until finish().
  void flush();
  void finish();

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  void check(bool written) const;

  std::string name_;
  std::unique_ptr<FileWriter> file_;
  std::string waiting_;                       // to be written to it
  std::unique_ptr<std::FILE, Close> opened_;  // a pipe or a device
  std::FILE* stream_ = nullptr;               // that, or standard output
};

/// Writes `text` to standard output where `path` leads there, else to that file, whole or not at all.
void write_output(const std::string& path, const std::string& text);

/// A line for whoever watches, on standard error. Nobody may be there: what cannot be written is lost.
void say(const std::string& line);

/// A line on the terminal that says how far long work is and, from the second time that it is shown, how long it will
/// still take: work may begin after its line does, and may go on from where it was broken off. Silent where standard output
/// or standard error is no terminal, or `quiet`.
class ProgressLine {
 public:
  ProgressLine(std::string label, bool quiet);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void show(std::size_t done, std::size_t total);
  /// show() as a callback; the line must outlive it.
  std::function<void(std::size_t, std::size_t)> callback();

 private:
  using Clock = std::chrono::steady_clock;
  std::string label_;
  bool active_;
  bool shown_ = false;
  std::size_t first_done_ = 0;  // when it was shown first
  Clock::time_point begin_;
  Clock::time_point last_;
};

}  // namespace truebearing
