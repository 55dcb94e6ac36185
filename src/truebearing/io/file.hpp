// SPDX-License-Identifier: Apache-2.0
// Whole files: reading with a size limit, writing so that a crash leaves the old file or the new one, never a mixture.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace truebearing {

/// The text of a file of at most max_bytes. Throws InputError where it is missing, unreadable or larger.
std::string read_text_file(const std::filesystem::path& path, std::size_t max_bytes);

/// The files that a pattern stands for, sorted by name: in the file's name, * is any text. A pattern without it is the
/// file itself, there or not. Throws InputError where nothing matches, or where a folder's name holds a *.
std::vector<std::filesystem::path> matching_files(const std::filesystem::path& pattern);

/// A file that is written piece by piece: commit() flushes it to disk and gives it its name, as write_file_atomically()
/// does; without it nothing is left behind. Throws InputError.
class FileWriter {
 public:
  explicit FileWriter(const std::filesystem::path& path);
  ~FileWriter();
  FileWriter(const FileWriter&) = delete;
  FileWriter& operator=(const FileWriter&) = delete;

  void write(std::string_view text);
  void commit();

 private:
  struct Target;
  std::unique_ptr<Target> target_;
};

/// Writes to a temporary name of its own beside `path`, flushes it to disk and renames it: after a crash, a full disk
/// or a second writer, the file is the old one or one writer's whole text. It keeps the mode of the old one, and a
/// symbolic link stays one, also to what is not there yet. Throws InputError; leaves nothing behind on failure, and
/// removes what a killed process has left in that folder.
void write_file_atomically(const std::filesystem::path& path, std::string_view text);

}  // namespace truebearing
