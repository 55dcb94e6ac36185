// What the subcommands share of their output: files or standard output, and progress on a terminal.
#pragma once

#include <chrono>
#include <functional>
#include <string>

namespace truebearing {

/// Writes `text` to standard output where `path` is "-", else to that file, whole or not at all.
void write_output(const std::string& path, const std::string& text);

/// A line on the terminal that says how far long work is and how long it will still take. Silent where standard output
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
  Clock::time_point begin_;
  Clock::time_point last_;
};

}  // namespace truebearing
