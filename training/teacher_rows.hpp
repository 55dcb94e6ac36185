// SPDX-License-Identifier: Apache-2.0
// What the steps of a run teach, as rows of numbers: made with the ensemble that the run goes through, and put together
// to a TeacherSet.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "training/teacher.hpp"

namespace truebearing {

/// The numbers of a TeacherSet's rows (features, label, reference, the two factors, intervals, first of its track,
/// taught, used, error of the label), one row after another.
using TeacherRows = std::vector<double>;

/// Makes the rows of several runs together (EnsemblePack).
class TeacherRowMakers {
 public:
  /// count: runs together. truth_index: in the truth, or in the state of the teacher, of each component of the base's
  /// state.
  TeacherRowMakers(std::size_t count, const Ensemble& ensemble, const CorrectionSpec& correction,
                   const StateSpace& truth_space, const std::vector<int>& truth_index, bool whole_tracks);
  ~TeacherRowMakers();

  /// Of these runs, one behind another.
  TeacherRows rows(const Scenario& scenario, std::span<const RunKey> keys);

 private:
  class Maker;

  void add(const Scenario& scenario, std::span<const RunKey> keys, TeacherRows& rows);

  std::vector<std::unique_ptr<Maker>> makers_;
  std::unique_ptr<EnsemblePack> ensembles_;
};

/// The set of all rows, of states of n components. Throws InputError where none is taught.
TeacherSet teacher_set_of(const std::vector<TeacherRows>& rows, const std::vector<FeatureSpec>& features,
                          Eigen::Index n, bool whole_tracks, bool by_smoother);

}  // namespace truebearing
