// SPDX-License-Identifier: Apache-2.0
#include "truebearing/io/file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <mutex>
#include <set>
#include <system_error>

#include "truebearing/core/error.hpp"

namespace truebearing {
namespace {

InputError system_error(const std::filesystem::path& path, const char* action, int code) {
  return {path.string(), fmt::format("cannot be {}: {}", action, std::strerror(code))};
}

}  // namespace

class FileDescriptor {
 public:
  explicit FileDescriptor(int descriptor) : descriptor_(descriptor) {}
  FileDescriptor(const FileDescriptor&) = delete;
  FileDescriptor& operator=(const FileDescriptor&) = delete;
  ~FileDescriptor() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  int get() const { return descriptor_; }

 private:
  int descriptor_;
};

constexpr const char* kTemporaryPattern = ".truebearing-*-*.tmp";

/// A file beside the target that is removed unless it was renamed onto it. It is locked while it is written: one
/// without a lock was left by a process that was killed.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::filesystem::path& target) : path_(unused_name(target)), file_(create(target)) {
    // As the file that it replaces; whose owner it was, where we may.
    struct stat old {};
    if (::stat(target.c_str(), &old) != 0) return;
    [[maybe_unused]] const int not_ours = ::fchown(file_.get(), old.st_uid, old.st_gid);
    ::fchmod(file_.get(), old.st_mode & 0777);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    if (!renamed_) ::unlink(path_.c_str());
  }

  bool write(std::string_view text) {
    while (!text.empty()) {
      const ssize_t written = ::write(file_.get(), text.data(), text.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) return false;
      text.remove_prefix(static_cast<std::size_t>(written));
    }
    return true;
  }

  bool reaches_the_disk() { return ::fsync(file_.get()) == 0; }

  bool rename_to(const std::filesystem::path& target) {
    renamed_ = std::rename(path_.c_str(), target.c_str()) == 0;
    return renamed_;
  }

 private:
  static std::filesystem::path unused_name(const std::filesystem::path& target) {
    static std::atomic<unsigned> counter{0};
    return target.parent_path() / fmt::format(".truebearing-{}-{}.tmp", ::getpid(), counter++);
  }

  int create(const std::filesystem::path& target) {
    // Nobody else reads what replaces a private file.
    const mode_t mode = ::access(target.c_str(), F_OK) == 0 ? 0600 : 0666;
    for (;; path_ = unused_name(target)) {
      const int descriptor = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
      // The name may be left over from a killed process that had our number.
      if (descriptor < 0 && errno != EEXIST) throw system_error(target, "written", errno);
      if (descriptor < 0) continue;
      ::flock(descriptor, LOCK_EX);
      struct stat made {};
      if (::fstat(descriptor, &made) == 0 && made.st_nlink > 0) return descriptor;
      ::close(descriptor);  // taken for one that was left, before it was locked
    }
  }

  std::filesystem::path path_;
  FileDescriptor file_;
  bool renamed_ = false;
};

namespace {

/// The file that `path` leads to, there or not, so that a symbolic link stays one. Devices and folders cannot be
/// replaced.
std::filesystem::path replaceable_target(const std::filesystem::path& path) {
  constexpr int kMaxLinks = 40;
  std::filesystem::path target = path;
  std::error_code error;
  for (int links = 0; std::filesystem::is_symlink(target, error); ++links) {
    if (links == kMaxLinks) throw system_error(path, "written", ELOOP);
    target = target.parent_path() / std::filesystem::read_symlink(target, error);
    if (error) throw system_error(path, "written", error.value());
  }
  const std::filesystem::file_status status = std::filesystem::status(target, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
    throw InputError(path.string(), "is not a regular file");
  return target;
}

/// Does the name fit the pattern, in which * is any text?
bool fits(std::string_view name, std::string_view pattern) {
  const std::size_t star = pattern.find('*');
  if (star == std::string_view::npos) return name == pattern;
  if (name.substr(0, star) != pattern.substr(0, star)) return false;
  name.remove_prefix(star);
  pattern.remove_prefix(star + 1);
  // All parts but the last may be found as early as they are there.
  for (std::size_t next = pattern.find('*'); next != std::string_view::npos; next = pattern.find('*')) {
    const std::size_t found = name.find(pattern.substr(0, next));
    if (found == std::string_view::npos) return false;
    name.remove_prefix(found + next);
    pattern.remove_prefix(next + 1);
  }
  return name.ends_with(pattern);
}

void remove_if_left(const std::filesystem::path& path) {
  const FileDescriptor file(::open(path.c_str(), O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  if (file.get() >= 0 && ::flock(file.get(), LOCK_EX | LOCK_NB) == 0) ::unlink(path.c_str());
}

/// Temporary files that killed processes left in a folder. Looked for once: a run may write many files to one.
void remove_left_files(const std::filesystem::path& folder) {
  static std::mutex mutex;
  static std::set<std::filesystem::path> seen;
  const std::lock_guard lock(mutex);
  std::error_code error;
  if (!seen.insert(std::filesystem::absolute(folder, error)).second) return;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (fits(entry->path().filename().string(), kTemporaryPattern)) remove_if_left(entry->path());
}

std::filesystem::path folder_of(const std::filesystem::path& file) {
  return file.has_parent_path() ? file.parent_path() : ".";
}

/// The target, beside which no temporary file of a killed process lies any more.
std::filesystem::path without_left_files_beside(std::filesystem::path target) {
  remove_left_files(folder_of(target));
  return target;
}

}  // namespace

std::vector<std::filesystem::path> matching_files(const std::filesystem::path& pattern) {
  const std::string name = pattern.filename().string();
  if (pattern.parent_path().string().find('*') != std::string::npos)
    throw InputError(pattern.string(), "has a * in the name of a folder", "a * in the name of the file only");
  if (name.find('*') == std::string::npos) return {pattern};
  const std::filesystem::path folder = pattern.has_parent_path() ? pattern.parent_path() : ".";
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string file = entry->path().filename().string();
    const bool hidden = file.starts_with('.') && !name.starts_with('.');
    if (!hidden && fits(file, name)) files.push_back(pattern.parent_path() / file);
  }
  if (files.empty()) throw InputError(pattern.string(), "matches no file");
  std::sort(files.begin(), files.end());
  return files;
}

std::string read_text_file(const std::filesystem::path& path, std::size_t max_bytes) {
  const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.get() < 0) throw system_error(path, "opened", errno);
  std::array<char, 16384> chunk;  // most files fit
  std::string text;
  for (;;) {
    const ssize_t count = ::read(file.get(), chunk.data(), chunk.size());
    if (count == 0) return text;
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw system_error(path, "read", errno);
    text.append(chunk.data(), static_cast<std::size_t>(count));
    if (text.size() > max_bytes)
      throw InputError(path.string(), "is too large", fmt::format("at most {} bytes", max_bytes));
  }
}

struct FileWriter::Target {
  explicit Target(const std::filesystem::path& named)
      : path(named), replaced(without_left_files_beside(replaceable_target(named))), temporary(replaced) {}

  std::filesystem::path path;
  std::filesystem::path replaced;
  TemporaryFile temporary;
};

FileWriter::FileWriter(const std::filesystem::path& path) : target_(std::make_unique<Target>(path)) {}

FileWriter::~FileWriter() = default;

void FileWriter::write(std::string_view text) {
  if (!target_->temporary.write(text)) throw system_error(target_->path, "written", errno);
}

void FileWriter::commit() {
  if (!target_->temporary.reaches_the_disk() || !target_->temporary.rename_to(target_->replaced))
    throw system_error(target_->path, "written", errno);

  // The rename is on disk once the folder is. Not every file system can do that, and the file is whole either way.
  const FileDescriptor directory(::open(folder_of(target_->replaced).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (directory.get() >= 0) ::fsync(directory.get());
}

void write_file_atomically(const std::filesystem::path& path, std::string_view text) {
  FileWriter file(path);
  file.write(text);
  file.commit();
}

}  // namespace truebearing
