// SPDX-License-Identifier: Apache-2.0
// The error as papers on learned filters print it. Key of [scoring]: mse_db = true.
//   mse_db  10 log10 of the squared error's mean over the components of the state, scored steps, targets and runs,
//           each component in its own unit; its standard error is that of the mean square (jackknife over runs), in dB
#include <cmath>
#include <string>

#include "truebearing/evaluation/metric_registry.hpp"
#include "truebearing/evaluation/run_score.hpp"
#include "truebearing/evaluation/samples.hpp"
#include "truebearing/evaluation/summary.hpp"

namespace truebearing {
namespace {

class MseTally final : public MetricTally {
 public:
  explicit MseTally(const Scorer& scorer) : scorer_(scorer) {}

  void add(const RunScore& run) override {
    SquaredErrors all;
    for (std::size_t q = 0; q < scorer_.quantities().size(); ++q) {
      const SquaredErrors norms = squared_errors(run, q);
      all.add(SquaredErrors{norms.sum, norms.count * scorer_.dimension(q)});
    }
    runs_.add(all);
  }

  void exchange(TallyStream& stream) override { runs_.exchange(stream); }

  std::vector<Metric> metrics() const override {
    const Estimate mse = runs_.mse();
    return {{"mse_db", "dB", std::nullopt, 10.0 * std::log10(mse.value), 10.0 / std::log(10.0) * mse.se / mse.value}};
  }

 private:
  const Scorer& scorer_;
  RunErrors runs_;
};

class MseMetrics final : public MetricFamily {
 public:
  std::unique_ptr<MetricTally> tally(const ScoringRule&, const Scorer& scorer) const override {
    return std::make_unique<MseTally>(scorer);
  }
};

}  // namespace

std::shared_ptr<const MetricFamily> read_mse_db(TableReader& scoring, const StateSpace&, ScoringRule&) {
  return scoring.boolean_or("mse_db", false) ? std::make_shared<MseMetrics>() : nullptr;
}

}  // namespace truebearing
