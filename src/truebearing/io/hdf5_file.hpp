// SPDX-License-Identifier: Apache-2.0
// HDF5 files as far as the house needs them: named datasets of numbers, with numbers as their attributes. Written in
// memory, so that a file appears whole (io/file.hpp) and has the same bytes whenever it holds the same numbers. Read
// in a process of its own (io/limited_child.hpp), since libhdf5 does not survive every damaged file; links and storage
// that lead to other files are refused.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace truebearing {

class Hdf5Respondent;

/// False where there is no file, and for pipes, which can be read only once.
bool is_hdf5_file(const std::filesystem::path& path);

class Hdf5Reader {
 public:
  /// Throws InputError where the file is absent, none of HDF5 or truncated; what follows does where it is at fault.
  explicit Hdf5Reader(const std::filesystem::path& path);
  /// Of a file that another has open (io/hdf5_server.hpp); `name` stands for it in messages.
  Hdf5Reader(std::string name, std::unique_ptr<Hdf5Respondent> respondent);
  Hdf5Reader(const Hdf5Reader&) = delete;
  Hdf5Reader& operator=(const Hdf5Reader&) = delete;
  ~Hdf5Reader();

  bool has(const std::string& dataset) const;
  /// The lengths of its dimensions, of which there are none where it is a lone number.
  std::vector<std::uint64_t> shape(const std::string& dataset) const;
  /// Throws unless the file holds so many numbers in it: to be asked before they are given memory.
  void check_holds(const std::string& dataset, std::uint64_t size) const;
  /// All its numbers, integers or floats of any width, the last dimension running fastest; as many as `values` has.
  void read(const std::string& dataset, std::span<double> values) const;
  /// Nothing where there is none of that name.
  std::optional<double> attribute(const std::string& dataset, const std::string& name) const;

  /// "log.h5: snapshots", for messages.
  std::string where(const std::string& dataset) const { return name_ + ": " + dataset; }

 private:
  std::string name_;
  std::unique_ptr<Hdf5Respondent> respondent_;  ///< who has the file open
};

class Hdf5Writer {
 public:
  /// `name` stands for the file in messages. All throw InputError where memory runs out.
  explicit Hdf5Writer(std::string name);
  Hdf5Writer(const Hdf5Writer&) = delete;
  Hdf5Writer& operator=(const Hdf5Writer&) = delete;
  ~Hdf5Writer();

  /// A dataset of 64 bit floats, to be filled row by row.
  void add(const std::string& dataset, const std::vector<std::uint64_t>& shape);
  /// What stands at one index of the first dimension.
  void write_row(const std::string& dataset, std::uint64_t row, std::span<const double> values);
  void add_attribute(const std::string& dataset, const std::string& name, double value);

  /// The bytes of the file.
  std::string str() const;

 private:
  std::string name_;
  std::int64_t file_;
};

}  // namespace truebearing
