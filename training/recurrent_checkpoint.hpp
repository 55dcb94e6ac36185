// SPDX-License-Identifier: Apache-2.0
// The file that a training of a recurrent network keeps while it lasts, so that one that is killed goes on where it was and
// ends with the same bits: a RecurrentState as safetensors, with the hash of the data and options that it belongs to.
#pragma once

#include <array>
#include <filesystem>

#include "training/recurrent_training.hpp"

namespace truebearing {

class RecurrentCheckpoint {
 public:
  /// Of a training with these rows and options, in which the number of threads does not count. `path` empty: no file.
  RecurrentCheckpoint(std::filesystem::path path, const RecurrentRows& training, const RecurrentRows& validation,
                      const RecurrentOptions& options);

  /// Not begun where there is no file. Throws InputError where it is another training's, or damaged.
  RecurrentState read() const;
  /// Replaces the file, whole or not at all. Throws InputError where it cannot be written.
  void write(const RecurrentState& state) const;

 private:
  struct Layer {
    const char* name;
    Eigen::Index rows, columns;
  };

  std::filesystem::path path_;
  std::array<Layer, 8> layers_;  // in the order of RecurrentState
  Eigen::Vector4f belongs_to_;   // a hash, 16 bits to a number
  int epochs_;
};

}  // namespace truebearing
