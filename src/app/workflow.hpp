// SPDX-License-Identifier: Apache-2.0
// Tuning and training a whole study: what `tune`, `train`, `learn` and `compare --retrain` share.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "truebearing/evaluation/ranks.hpp"
#include "truebearing/study/study.hpp"

namespace truebearing {

struct WorkflowOptions {
  std::uint64_t seed = 1;
  int threads = 0;
  bool quiet = false;
  Ranks* ranks = nullptr;  ///< share the runs; all of them have what is found, the first says so
  /// Where trainings that take long keep how far they are, by the tracker's name; none where not named.
  std::map<std::string, std::filesystem::path> checkpoints = {};
};

/// Whether the study has a tracker with something to tune.
bool has_tuned_trackers(const Study& study);
/// The corrected trackers of those names; all of them where there are none.
std::vector<std::string> corrected_trackers(const Study& study, const std::vector<std::string>& names);

/// check_outputs() for what is made from a study and replaces the files that it names for it: these do not count as
/// inputs.
void check_products(const Study& study, const std::vector<std::string>& outputs,
                    const std::vector<std::filesystem::path>& replaced);

/// The files that the study reads, without those.
std::vector<std::filesystem::path> inputs_without(const Study& study,
                                                  const std::vector<std::filesystem::path>& replaced);

/// Throws InputError at every rank where they are of other versions, have other options, as this text says them, or
/// find other texts in these files. Nothing without ranks.
void check_ranks(Ranks* ranks, const std::vector<std::filesystem::path>& files, const std::string& options);

/// Fits every tracker of the study that has something to tune, as all ranks have it. Says on standard error what it
/// found, unless quiet.
ParametersFile tune_study(const Study& study, const WorkflowOptions& options);

/// The trackers of those names whose motion is learned; all of them where there are none.
std::vector<std::string> learned_trackers(const Study& study, const std::vector<std::string>& names);
/// Teaches the motions of those trackers and writes them to the files of the same places.
void train_motions(const Study& study, const std::vector<std::string>& names, const std::vector<std::string>& outputs,
                   const WorkflowOptions& options);

/// Names a file beside each output, in which the training of a recurrent network keeps how far it is. Throws InputError
/// where such a model, which is two files, is to be a stream.
void keep_checkpoints(const Study& study, const std::vector<std::string>& names,
                      const std::vector<std::string>& outputs, WorkflowOptions& options);

/// Trains the corrected trackers of those names; all of them where there are none. Scores each on validation runs,
/// which the model file remembers. All ranks have the models.
CorrectionModels train_study(const Study& study, const std::vector<std::string>& names, const WorkflowOptions& options);

/// These write to a file or standard output, and print which file it was.
void write_parameters(const std::string& output, const ParametersFile& parameters);
/// And removes its checkpoint.
void write_model(const std::string& output, const CorrectionModel& model);

}  // namespace truebearing
