// SPDX-License-Identifier: Apache-2.0
// Shards: the runs of one comparison shared among processes that know nothing of each other (an array of batch jobs).
// A shard file has the tallies of consecutive blocks of runs (evaluation/comparison_runs.hpp): a line of JSON that says
// of which comparison they are, then a line for each block. `merge` adds them in the order of the blocks, as one
// process does, and has its figures to the last bit where all machines are of one kind (docs/scale.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "app/compare_study.hpp"

namespace truebearing {

/// Part `index` of `count`, from 1.
struct Shard {
  std::size_t index = 1;
  std::size_t count = 1;

  /// Of "I/N". Throws InputError.
  static Shard parse(const std::string& text);
  std::size_t first(std::size_t blocks) const { return blocks * (index - 1) / count; }
  std::size_t last(std::size_t blocks) const { return blocks * index / count; }  ///< the one behind its last
};

/// What all shards of a comparison have in common, and which one it is.
struct ShardHeader {
  std::string study;   ///< its path
  std::string inputs;  ///< hash of its file and of those that it names
  std::uint64_t seed = 0;
  std::size_t runs = 0;
  bool all = false;
  bool details = false;
  Shard shard;
};

/// What differs between hosts or days is found out by it.
std::string hash_of_files(const std::vector<std::filesystem::path>& files);
/// Of the study's file and of every file that it names.
std::string hash_of_inputs(const Study& study);

/// Runs the blocks of a shard and writes them. Throws InputError.
void write_shard(StudyComparison& comparison, const ShardHeader& header, const std::string& output, bool quiet);

/// Reads the headers of shard files, and puts the files in the order of their shards. Throws InputError where they are
/// not all shards of one comparison, each once.
ShardHeader read_headers(std::vector<std::string>& files);

/// Gives every block of the files, in their order, to the figures. Throws InputError.
void add_shards(const std::vector<std::string>& files, const ComparisonRuns& runs, ComparisonFigures& figures);

}  // namespace truebearing
