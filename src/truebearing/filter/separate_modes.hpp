// SPDX-License-Identifier: Apache-2.0
// Modes of any kinds and lengths, each a filter behind its own seam. States may be of unequal length: every state is the
// beginning of the longest one (n). What mode i does not have and mode j has, an acceleration say, mode j takes from
// itself when it mixes: zeros from i would pull it towards no acceleration with a false certainty (Granstrom, Willett
// and Bar-Shalom 2015).
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "truebearing/filter/mode_bank.hpp"

namespace truebearing {

class SeparateModes final : public ModeBank {
 public:
  explicit SeparateModes(Modes modes);

  void begin(const double* x, const double* P, int n) override;
  void begin_mode(int mode, const double* x, const double* P) override {
    modes_[static_cast<std::size_t>(mode)]->begin(x, P);
  }
  bool mix_and_predict(const ModeMatrix& weights, double dt_s) override;
  void update(const AnyMeasurement& measurement, ModeVector& log_likelihood) override;
  void keep() override;
  void mix_innovations(const ModeVector& weights, BoundedVector& nu, BoundedMatrix& S) const override;
  void mix_gains(const ModeVector& weights, BoundedMatrix& K) const override;
  void mix(const ModeVector& weights, double* x, double* P) const override;
  void assign(const ModeBank& other) override;
  std::unique_ptr<ModeBank> fresh() const override;
  std::span<const std::unique_ptr<TrackedState>> modes() const override { return modes_; }

 private:
  Modes modes_;
  Modes scratch_;  // what the modes are to become, until all of them have
  std::vector<StateUpdate> updates_;
  int states_ = 0;  // n
};

}  // namespace truebearing
