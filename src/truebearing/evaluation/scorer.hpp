// SPDX-License-Identifier: Apache-2.0
// Scorer: a tracker's estimate against the truth, quantity by quantity. Where the components and quantities of its
// state are found in the truth is settled once, by name.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "truebearing/core/bounded.hpp"
#include "truebearing/core/state_space.hpp"
#include "truebearing/evaluation/step_columns.hpp"
#include "truebearing/tracker/step_record.hpp"

namespace truebearing {

struct RunScore;

class Scorer {
 public:
  Scorer(const StateSpace& truth, const StateSpace& estimate);

  const StateSpace& truth() const { return *truth_; }
  /// The truth's quantities that the tracker estimates.
  const std::vector<std::string>& quantities() const { return quantity_names_; }
  /// Place of a quantity in quantities(), or nothing.
  std::optional<std::size_t> quantity(const std::string& name) const;
  /// How many components the NEES is taken over: its expected value for a consistent tracker.
  int dimension() const { return all_.size(); }
  /// The same for one quantity.
  int dimension(std::size_t quantity) const { return quantities_[quantity].size(); }
  /// What 95 % of the NEES of a consistent tracker stay below; and of those of one quantity.
  double nees95() const { return nees95_; }
  double nees95(std::size_t quantity) const { return quantity_nees95_[quantity]; }

  /// The 2-norm of truth - estimate in that quantity, in its unit.
  double error(std::size_t quantity, const BoundedVector& truth, const BoundedVector& estimate) const;
  /// The value of a quantity of one component in the truth and in an estimate, in its unit.
  double true_value(std::size_t quantity, const BoundedVector& truth) const;
  double estimated_value(std::size_t quantity, const BoundedVector& estimate) const;

  void prepare(RunScore& score, std::size_t steps, std::size_t targets = 1) const;
  /// Takes the figures of a step that is to be scored, for its place in the score. They stand there once so many steps
  /// came that they are scored together, or after score_together(). columns: of dimension() components.
  void score_step(const BoundedVector& truth, const StepRecord& record, std::size_t place, StepColumns& columns,
                  RunScore& score) const;
  /// Scores those that wait.
  void score_together(StepColumns& columns, RunScore& score) const;

 private:
  // Of components that both have: where they stand in the truth, in the estimate, and among all that both have.
  struct Places {
    std::vector<int> truth;
    std::vector<int> estimate;
    std::vector<int> among_all;
    int size() const { return static_cast<int>(truth.size()); }
  };

  const StateSpace* truth_;
  Places all_;
  std::vector<std::string> quantity_names_;
  std::vector<Places> quantities_;
  std::vector<double> scales_;  // [quantity]: from the unit of the components to its own
  double nees95_ = 0.0;
  std::vector<double> quantity_nees95_;
};

}  // namespace truebearing
