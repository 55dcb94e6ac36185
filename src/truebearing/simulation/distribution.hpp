// SPDX-License-Identifier: Apache-2.0
// A number in a scenario: a value, or a distribution that each run draws from. In TOML: 200.0 or one of
// { uniform = [low, high] }, { normal = [mean, standard deviation] }, { log_uniform = [low, high] },
// { choice = [a, b, ...] }.
#pragma once

#include <string>
#include <vector>

#include "truebearing/core/random.hpp"
#include "truebearing/io/table_reader.hpp"

namespace truebearing {

class Distribution {
 public:
  enum class Kind { fixed, uniform, normal, log_uniform, choice };

  /// A number that is always the same.
  Distribution(double value) : Distribution(Kind::fixed, {value}) {}
  /// `parameters` as in TOML. Throws InputError where they make no distribution.
  Distribution(Kind kind, std::vector<double> parameters);

  /// Takes exactly one uniform number from the stream, whatever the kind: to make one number of a scenario a
  /// distribution does not change what the others draw.
  double draw(RandomStream& stream) const;
  /// The value that a share u in [0, 1) of the draws lies below.
  double quantile(double u) const;
  /// The share of the draws below x: the other way round.
  double share_below(double x) const;
  bool is_fixed() const { return kind_ == Kind::fixed; }
  bool operator==(const Distribution&) const = default;

 private:
  double value(double u, const std::vector<double>& choices) const;

  Kind kind_;
  std::vector<double> parameters_;
  std::vector<double> ascending_;  ///< where they are to choose from
};

/// Reads a number or a distribution all of whose draws lie in `range`; a normal, which knows no range, is for
/// kAnyNumber only.
Distribution read_distribution(TableReader& table, const std::string& key, Range range = kAnyNumber);
Distribution read_distribution_or(TableReader& table, const std::string& key, double fallback,
                                  Range range = kAnyNumber);

}  // namespace truebearing
