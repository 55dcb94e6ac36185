// SPDX-License-Identifier: Apache-2.0
#include "training/teacher.hpp"

#include <algorithm>
#include <cstring>
#include <fmt/format.h>
#include <optional>
#include <string>

#include "training/teacher_rows.hpp"
#include "truebearing/core/error.hpp"

namespace truebearing {
namespace {

// As machines of one kind have them.
std::string bytes_of(const TeacherRows& rows) {
  return {reinterpret_cast<const char*>(rows.data()), rows.size() * sizeof(double)};
}

TeacherRows rows_of(const std::string& bytes) {
  TeacherRows rows(bytes.size() / sizeof(double));
  if (!rows.empty()) std::memcpy(rows.data(), bytes.data(), rows.size() * sizeof(double));
  return rows;
}

}  // namespace

Eigen::VectorXd mahalanobis_lengths(const Eigen::MatrixXd& errors, const Eigen::MatrixXd& factors) {
  const Eigen::Index n = errors.cols();
  Eigen::VectorXd lengths(errors.rows());
  for (Eigen::Index row = 0; row < errors.rows(); ++row) {
    const BoundedVector e = errors.row(row).transpose();
    const BoundedMatrix factor = factors.row(row).reshaped(n, n);
    lengths[row] = factor.triangularView<Eigen::Lower>().solve(e).norm();
  }
  return lengths;
}

TeacherSet collect_teacher_set(const Ensemble& ensemble, const CorrectionSpec& correction, const Scenario& scenario,
                               const TeacherOptions& options) {
  const StateSpace& space = ensemble.tracker(ensemble.index(correction.design.base)).space();
  const int teacher = ensemble.index(correction.training.teacher);
  const StateSpace& truth_space = teacher < 0 ? scenario.truth_space() : ensemble.tracker(teacher).space();
  std::vector<int> truth_index;
  for (const std::string& component : space.components) {
    truth_index.push_back(truth_space.component_index(component));
    if (truth_index.back() < 0)
      throw InputError("training",
                       fmt::format("the {} is {}, the base's state {}",
                                   teacher < 0 ? "scenario's truth" : "teacher's state", truth_space.name, space.name),
                       "a truth that has every component of the state");
  }
  const std::size_t runs = correction.training.runs;
  // All ranks have to cut the runs alike, whatever machines they are on. How many of a cut are made together, where
  // their processors gain by that, is their own.
  const bool gains = ensemble.gains_together();
  const std::size_t together = options.ranks ? runs_together(runs / options.ranks->size(), 1)
                               : gains       ? runs_together(runs, options.threads)
                                             : 1;
  std::vector<TeacherRows> by_group((runs + together - 1) / together);
  std::vector<std::optional<TeacherRowMakers>> makers(worker_count(options.threads));
  const auto make = [&](std::size_t first, std::size_t count, std::size_t worker) {
    if (!makers[worker])
      makers[worker].emplace(gains ? together : 1, ensemble, correction, truth_space, truth_index,
                             options.whole_tracks);
    std::vector<RunKey> keys;
    for (std::size_t run = first; run < first + count; ++run) keys.push_back({options.seed, options.role, run});
    return makers[worker]->rows(scenario, keys);
  };
  if (options.ranks)
    share_work(
        *options.ranks, by_group.size(), options.threads,
        [&](std::size_t group, std::size_t worker) {
          return bytes_of(make(group * together, std::min(together, runs - group * together), worker));
        },
        [&](std::size_t group, const std::string& bytes) { by_group[group] = rows_of(bytes); },
        options.progress
            ? Progress([&](std::size_t done, std::size_t) { options.progress(std::min(done * together, runs), runs); })
            : Progress());
  else
    monte_carlo_together(
        runs, together, options.threads,
        [&](std::size_t first, std::size_t count, std::size_t worker) {
          by_group[first / together] = make(first, count, worker);
        },
        options.progress);
  if (!is_first(options.ranks)) return {};
  return teacher_set_of(by_group, correction.design.features, space.size(), options.whole_tracks, teacher >= 0);
}

}  // namespace truebearing
