// SPDX-License-Identifier: Apache-2.0
#include "app/output.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fmt/format.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#include <utility>

#include "truebearing/core/error.hpp"

namespace truebearing {
namespace {

namespace fs = std::filesystem;

bool is_replaceable(const std::string& path) {
  std::error_code unknown;
  const fs::file_status status = fs::status(path, unknown);
  return !fs::exists(status) || fs::is_regular_file(status) || fs::is_directory(status);
}

// Of what an output may not be the same as: a terminal or /dev/null can be both.
bool keeps_what_is_written(const struct stat& file) {
  return S_ISREG(file.st_mode) || S_ISFIFO(file.st_mode);
}

bool find(const std::string& path, int standard, struct stat& file) {
  return (path == "-" ? ::fstat(standard, &file) : ::stat(path.c_str(), &file)) == 0;
}

bool is_same_file(const std::string& output, const std::string& input) {
  struct stat written, read;
  return find(output, STDOUT_FILENO, written) && find(input, STDIN_FILENO, read) && keeps_what_is_written(written) &&
         written.st_dev == read.st_dev && written.st_ino == read.st_ino;
}

bool is_same_output(const std::string& a, const std::string& b) {
  if (is_standard_output(a) || is_standard_output(b)) return is_standard_output(a) && is_standard_output(b);
  std::error_code unknown;
  return is_replaceable(a) && fs::weakly_canonical(a, unknown) == fs::weakly_canonical(b, unknown);
}

void check_writable(const std::string& path) {
  if (is_standard_output(path) || !is_replaceable(path)) return;
  std::error_code unknown;
  if (fs::is_directory(path, unknown)) throw InputError(path, "is a folder", "a file to write to");
  const fs::path file = fs::exists(path, unknown) ? fs::canonical(path, unknown) : fs::path(path);
  const fs::path folder = file.has_parent_path() ? file.parent_path() : ".";
  if (::access(folder.c_str(), W_OK | X_OK) != 0)
    throw InputError(path, fmt::format("cannot be written: {}", std::strerror(errno)), "a file in a folder of yours");
}

}  // namespace

bool is_standard_output(const std::string& path) {
  if (path == "-") return true;
  struct stat named, standard;
  return ::stat(path.c_str(), &named) == 0 && ::fstat(STDOUT_FILENO, &standard) == 0 &&
         named.st_dev == standard.st_dev && named.st_ino == standard.st_ino;
}

void check_outputs(const std::vector<std::string>& outputs, const std::vector<fs::path>& inputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const std::string& output = outputs[i];
    if (output.empty()) continue;
    for (const fs::path& input : inputs)
      if (is_same_file(output, input.string()))
        throw InputError(output, fmt::format("is read by this command, as {}", input.string()), "another file");
    for (std::size_t j = 0; j < i; ++j)
      if (!outputs[j].empty() && is_same_output(output, outputs[j]))
        throw InputError(output, "is to hold two outputs", "a file for each");
    check_writable(output);
  }
}

OutputStream::OutputStream(const std::string& path) : name_(path) {
  if (is_standard_output(path)) {
    name_ = "standard output";
    stream_ = stdout;
  } else if (is_replaceable(path)) {
    file_ = std::make_unique<FileWriter>(path);
  } else {
    opened_.reset(std::fopen(path.c_str(), "w"));
    stream_ = opened_.get();
    check(stream_ != nullptr);
  }
}

OutputStream::~OutputStream() = default;

void OutputStream::check(bool written) const {
  if (!written) throw InputError(name_, fmt::format("cannot be written: {}", std::strerror(errno)));
}

void OutputStream::write(std::string_view text) {
  if (stream_) return check(std::fwrite(text.data(), 1, text.size(), stream_) == text.size());
  constexpr std::size_t kBlockBytes = std::size_t{1} << 16;
  waiting_ += text;
  if (waiting_.size() < kBlockBytes) return;
  file_->write(waiting_);
  waiting_.clear();
}

void OutputStream::flush() {
  if (stream_) check(std::fflush(stream_) == 0);
}

void OutputStream::finish() {
  flush();
  if (!file_) return;
  file_->write(waiting_);
  file_->commit();
}

void write_output(const std::string& path, const std::string& text) {
  OutputStream output(path);
  output.write(text);
  output.finish();
}

void say(const std::string& line) {
  std::fputs((line + '\n').c_str(), stderr);
}

ProgressLine::ProgressLine(std::string label, bool quiet)
    : label_(std::move(label)),
      active_(!quiet && isatty(STDERR_FILENO) != 0 && isatty(STDOUT_FILENO) != 0),
      begin_(Clock::now()),
      last_(begin_) {}

ProgressLine::~ProgressLine() {
  if (shown_) std::fputs("\r\033[K", stderr);
}

void ProgressLine::show(std::size_t done, std::size_t total) {
  const Clock::time_point now = Clock::now();
  if (!active_ || done == 0) return;
  if (first_done_ == 0) {
    first_done_ = done;
    begin_ = now;
  } else if (now - last_ < std::chrono::milliseconds(200)) {
    return;
  }
  last_ = now;
  shown_ = true;
  std::string line = fmt::format("\r\033[K{} {}/{}", label_, done, total);
  if (done > first_done_) {
    const double elapsed_s = std::chrono::duration<double>(now - begin_).count();
    const double left_s = elapsed_s * static_cast<double>(total - done) / static_cast<double>(done - first_done_);
    line += fmt::format(", {:.0f} s left", left_s);
  }
  std::fputs(line.c_str(), stderr);
  std::fflush(stderr);
}

std::function<void(std::size_t, std::size_t)> ProgressLine::callback() {
  return [this](std::size_t done, std::size_t total) { show(done, total); };
}

}  // namespace truebearing
