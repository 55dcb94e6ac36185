// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/readers.hpp"

#include <cerrno>
#include <fcntl.h>
#include <filesystem>
#include <memory>
#include <sstream>
#include <string>
#include <system_error>
#include <unistd.h>
#include <utility>

#include "tests/fuzz/estimators.hpp"
#include "tests/fuzz/snapshot_files.hpp"
#include "tests/support/temporary_folder.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/correction/model_file.hpp"
#include "truebearing/io/safetensors.hpp"
#include "truebearing/io/table_reader.hpp"
#include "truebearing/recording/debrief_replay.hpp"
#include "truebearing/recording/geographic_track.hpp"
#include "truebearing/recording/recording_csv.hpp"
#include "truebearing/recording/snapshot_log.hpp"
#include "truebearing/study/parameters_file.hpp"
#include "truebearing/study/study.hpp"
#include "truebearing/tracker/step_log.hpp"
#include "truebearing/tracker/step_log_recording.hpp"

namespace truebearing::testing {
namespace {

// One file, open for as long as the process lives, in memory where the system has room for such: thousands are read in
// a second.
class HostileFile {
 public:
  HostileFile()
      : folder_(std::filesystem::is_directory("/dev/shm") ? "/dev/shm" : std::filesystem::temp_directory_path()),
        path_(folder_.write("hostile", {})),
        file_(::open(path_.c_str(), O_WRONLY | O_CLOEXEC)) {}
  HostileFile(const HostileFile&) = delete;
  HostileFile& operator=(const HostileFile&) = delete;
  ~HostileFile() { ::close(file_); }

  const std::filesystem::path& write(const std::string& text) const {
    const auto size = static_cast<ssize_t>(text.size());
    if (::ftruncate(file_, 0) != 0 || ::pwrite(file_, text.data(), text.size(), 0) != size)
      throw std::filesystem::filesystem_error("no file for a reader", path_, {errno, std::generic_category()});
    return path_;
  }

 private:
  TemporaryFolder folder_;
  std::filesystem::path path_;
  int file_;
};

template <typename Read>
void read_file(const std::string& text, const Read& read) {
  static const HostileFile file;
  read(file.write(text));
}

void read(std::uint8_t reader, const std::string& text) {
  std::istringstream stream(text);
  switch (reader) {
    case 'r':
      read_recording(stream, "hostile.csv");
      break;
    case 'd': {
      auto table = std::make_unique<std::istringstream>(table_of_debrief_replay(stream, "hostile.rep"));
      read_recording(CsvReader(std::move(table), "hostile.rep"), {});
      break;
    }
    case 'g':
      read_geographic_tracks(stream, "hostile.csv");
      break;
    case 's':
      recordings_of(read_step_log(stream, "hostile.csv"), "hostile.csv");
      break;
    case 't':
      parse_toml(text, "hostile.toml");
      break;
    case 'm':
      parse_model(text, "hostile.json");
      break;
    case 'w':
      parse_safetensors(text, "hostile.safetensors");
      break;
    case 'p':
      read_file(text, read_parameters_file);
      break;
    case 'y':
      read_file(text, Study::load);
      break;
    case 'h':
      read_file(text, [](const std::filesystem::path& path) { read_snapshot_log(path); });
      break;
    default:
      throw InputError("hostile", "is for no reader");
  }
}

}  // namespace

bool read_hostile(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return false;
  if (bytes.front() == 'e') return drive_estimator(bytes.subspan(1));
  try {
    switch (const std::span<const std::uint8_t> rest = bytes.subspan(1); bytes.front()) {
      case 'f':
        read_made_snapshots(rest);
        break;
      case 'c':
        read_answered_snapshots(rest);
        break;
      default:
        read(bytes.front(), std::string(rest.begin(), rest.end()));
    }
  } catch (const InputError&) {
    return false;
  }
  return true;
}

}  // namespace truebearing::testing
