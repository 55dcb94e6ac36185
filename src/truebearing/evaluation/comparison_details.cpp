// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/comparison_details.hpp"

#include <algorithm>
#include <cmath>

#include "truebearing/core/chi_square.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/evaluation/samples.hpp"
#include "truebearing/evaluation/summary.hpp"

namespace truebearing {

// The standard error of a mean m of squares carries over to its root as se / (2 sqrt(m)).
double DetailsTally::StepMoments::rmse_se() const {
  if (runs < 2.0) return kNaN;
  const double mean = sum / runs;
  const double variance = std::max(0.0, squares / runs - mean * mean) * runs / (runs - 1.0);
  return mean > 0.0 ? std::sqrt(variance / runs) / (2.0 * std::sqrt(mean)) : 0.0;
}

void DetailsTally::add_errors(const RunScore& run, std::size_t quantity) {
  if (run_rmse_[quantity].size() < kMostRunsApart)
    run_rmse_[quantity].push_back(root_mean(squared_errors(run, quantity)));
  std::vector<StepMoments>& moments = steps_[quantity];
  moments.resize(std::max(moments.size(), run.steps()));
  for (std::size_t step = 0; step < run.steps(); ++step) {
    SquaredErrors of_step;
    for (std::size_t target = 0; target < run.targets; ++target)
      if (const double error = run.error[quantity][target * run.steps() + step]; !std::isnan(error)) of_step.add(error);
    if (of_step.count == 0.0) continue;
    const double square = mean_square(of_step);
    moments[step].sum += square;
    moments[step].squares += square * square;
    moments[step].runs += 1.0;
  }
}

void DetailsTally::add(const RunScore& run) {
  run_rmse_.resize(run.error.size());
  steps_.resize(run.error.size());
  for (std::size_t quantity = 0; quantity < run.error.size(); ++quantity) add_errors(run, quantity);
  nees_.resize(std::max(nees_.size(), run.steps()));
  for (std::size_t place = 0; place < run.nees.size(); ++place) {
    if (std::isnan(run.nees[place])) continue;
    nees_[place % run.steps()].sum += run.nees[place];
    nees_[place % run.steps()].count += 1.0;
  }
}

void DetailsTally::exchange(TallyStream& stream) {
  stream.list(run_rmse_, [&](std::vector<double>& runs) {
    const std::size_t count = stream.length(runs.size());
    for (std::size_t i = 0; i < count; ++i)
      if (stream.writes())
        stream.value(runs[i]);
      else if (const double rmse = stream.value(0.0); runs.size() < kMostRunsApart)
        runs.push_back(rmse);
  });
  stream.list(steps_, [&](std::vector<StepMoments>& steps) {
    stream.list(steps, [&](StepMoments& step) {
      for (double* sum : {&step.sum, &step.squares, &step.runs}) stream.sum(*sum);
    });
  });
  stream.list(nees_, [&](Nees& step) {
    stream.sum(step.sum);
    stream.sum(step.count);
  });
}

TrackerDetails DetailsTally::details() const {
  TrackerDetails details;
  details.run_rmse = run_rmse_;
  for (const std::vector<StepMoments>& moments : steps_) {
    std::vector<double>& se = details.series_se.emplace_back();
    for (const StepMoments& step : moments) se.push_back(step.rmse_se());
  }
  double count = -1.0;
  ChiSquareMeans consistent{};
  for (const Nees& step : nees_) {
    if (step.count != count) {
      count = step.count;
      consistent = chi_square_means(count, dimension_);
    }
    details.nees.push_back(count > 0.0 ? step.sum / count : kNaN);
    details.nees_low.push_back(consistent.low);
    details.nees_high.push_back(consistent.high);
  }
  return details;
}

}  // namespace truebearing
