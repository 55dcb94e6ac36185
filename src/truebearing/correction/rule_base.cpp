// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/rule_base.hpp"

#include <fmt/format.h>
#include <string>

#include "truebearing/core/covariance.hpp"
#include "truebearing/core/error.hpp"

namespace truebearing {

void RuleBase::answer(const NetworkInputs& inputs, NetworkMemory&, NetworkAnswer& answer) const {
  if (moments.size() == 0) {
    answer.moments.resize(0, 0);
    network.answer(inputs, answer.y, 1, inflation.data(), &answer.inflation);
  } else {
    const int n = network.outputs();
    answer.moments.resize(n, n);
    network.answer(inputs, answer.y, n, moments.data(), answer.moments.data());
  }
}

void RuleBase::check(const CorrectionDesign& design, int n) const {
  const Eigen::Index M = network.rules();
  require_valid(outputs() == n, "rules", fmt::format("consequents of {} numbers", outputs()),
                fmt::format("{}, one per component of the state", n));
  if (!design.covariance_moments) {
    require_valid(moments.size() == 0, "moments", "stand beside inflation", "one of the two");
    require_valid(inflation.size() == M && inflation.allFinite() && (inflation.array() > 0.0).all(), "inflation",
                  fmt::format("holds {} numbers, or one that is not > 0", inflation.size()),
                  fmt::format("{} numbers > 0", M));
  } else {
    require_valid(inflation.size() == 0, "inflation", "stands beside moments", "one of the two");
    require_valid(moments.rows() == M && moments.cols() == n * n, "moments",
                  fmt::format("is {} x {}", moments.rows(), moments.cols()), fmt::format("{} x {}", M, n * n));
    for (Eigen::Index j = 0; j < M; ++j)
      require_valid(is_covariance(BoundedMatrix(moments.row(j).reshaped(n, n))), "moments",
                    fmt::format("of rule {} are no covariance", j), "symmetric positive semi-definite matrices");
  }
  require_valid(usage.size() == M && usage.allFinite(), "usage", fmt::format("holds {} numbers", usage.size()),
                fmt::format("{} finite numbers", M));
  require_valid(local_mean.rows() == M && local_mean.cols() == n && local_mean.allFinite(), "local_mean",
                fmt::format("is {} x {}", local_mean.rows(), local_mean.cols()),
                fmt::format("{} x {} finite numbers", M, n));
}

}  // namespace truebearing
