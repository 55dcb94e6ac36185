// SPDX-License-Identifier: Apache-2.0
// SmoothingBank makes a smoother of a FilterBank. Hypotheses of a bank are constant, so that
//     p(x_k | all) = sum_i w_i p(x_k | all, i),  w_i the weight of hypothesis i after all measurements,
// and each term is what the smoother of that filter says (backward_step.hpp: Rauch, Tung and Striebel): exact where the
// filters are. Of a fixed lag, all is what came up to lag_s after the step. A step stays the bank's own where nothing
// later was used, and where the bank failed or did not look at a measurement. Told of a run (foresee), it keeps x and P of
// every hypothesis at every measurement.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "truebearing/core/constants.hpp"
#include "truebearing/filter/backward_step.hpp"
#include "truebearing/tracker/filter_bank.hpp"
#include "truebearing/tracker/smoother.hpp"

namespace truebearing {

class SmoothingBank final : public Smoother {
 public:
  /// lag_s > 0, infinite for the fixed interval.
  explicit SmoothingBank(std::unique_ptr<FilterBank> bank, double lag_s = kInfinity);

  void foresee(std::span<const Measurement> measurements) override;
  void reset() override;
  std::unique_ptr<Tracker> fresh() const override;

  const StateSpace& space() const override { return bank_->space(); }
  std::optional<Measured> measures() const override { return bank_->measures(); }

 private:
  // The members after a measurement, or as the bank began.
  struct Knot {
    double time_s;
    std::vector<double> filtered;  // x, P of each member, one after the other
    std::vector<double> weights;   // sum to 1
  };
  // Moments of the members about what the bank published.
  struct Sums {
    double weight = 0.0;
    BoundedVector first;
    BoundedMatrix second;
  };

  Tracker& filter() override { return *bank_; }
  const Tracker& filter() const override { return *bank_; }
  void add_knot();
  void take(const Measurement& measurement);
  std::size_t last_knot_of(const Step& step) const;
  void look_back(std::size_t member, std::size_t first_step, std::size_t end_step, std::size_t last,
                 std::vector<Sums>& sums);
  ModeEstimates filtered(std::size_t knot, std::size_t member) const;
  void add(const ModeEstimate& member, double weight, const Step& step, Sums& sums) const;
  void write(const Sums& sums, Step& step) const;

  std::unique_ptr<FilterBank> bank_;
  double lag_s_;
  std::vector<BackwardStep> backward_;  // of each member
  std::vector<Knot> knots_;
};

}  // namespace truebearing
