// SPDX-License-Identifier: Apache-2.0
// What the trainers of the fuzzy network share: the training data, its normalisation and its mirror image.
//
// N rows, d features, p outputs, M rules. Features X (N x d) and teacher signal Y (N x p) are raw; the network sees
// u = clip((x - mean) / scale) and learns y / output_scale. With mirror symmetry every row stands for two: features and
// outputs of parity -1 change sign (a mirrored target needs the mirrored correction).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "truebearing/core/random.hpp"
#include "truebearing/correction/fuzzy_network.hpp"

namespace truebearing {

struct FuzzyTrainingData {
  Eigen::MatrixXd features;        ///< X (N x d), raw
  Eigen::MatrixXd labels;          ///< Y (N x p), the teacher signal
  std::vector<int> parity;         ///< (d), +1 even or -1 odd; empty: no mirror symmetry
  Eigen::VectorXd output_weights;  ///< (p), > 0, of the squared normalised residuals; empty: all 1
  std::vector<int> output_parity;  ///< (p), as parity; empty: all odd
  /// With mirror symmetry: rules in pairs that mirror each other, in place of the rows' mirror images.
  bool paired_rules = false;

  Eigen::Index rows() const { return features.rows(); }
  bool mirrored() const { return !parity.empty(); }
  bool mirrored_rows() const { return mirrored() && !paired_rules; }
  Eigen::VectorXd weights() const;  ///< output_weights, or ones
  /// Of the outputs as numbers (p): output_parity, or -1 for all.
  Eigen::VectorXd output_signs() const;
};

struct TrainedFuzzyNetwork {
  FuzzyNetwork::Parameters parameters;
  double cost = 0.0;           ///< mean over rows of the weighted squared normalised residuals, ridge term included
  Eigen::VectorXd usage;       ///< (M), mean of phi over the training rows and their mirror images
  Eigen::MatrixXd local_mean;  ///< (M x p), phi-weighted mean of the labels, in their units
};

/// Called after each iteration or epoch with its number from 1, their total, and the cost; may be empty.
using TrainingProgress = std::function<void(int iteration, int total, double cost)>;

/// The one stream that a trainer draws from.
inline RandomStream learning_stream(std::uint64_t seed) {
  return {RunKey{.seed = seed, .role = Role::training, .run = 0}, StreamId::learning};
}

/// Throws InputError where shapes disagree, a number is not finite, a parity is not +-1, a weight is not positive, or
/// there are fewer rows than rules.
void validate(const FuzzyTrainingData& data, int rules);

/// Throws InputError, naming `option`, unless low <= value <= high; a NaN is refused.
void require_option(const char* option, double value, double low, double high);

/// Input mean and scale, clip and output scale; the rest of the parameters is left empty. An input's scale is its
/// standard deviation; an odd one with mirror symmetry has mean 0. The outputs' scale is their root mean square, for
/// the network has no offset. What does not vary gets scale 1.
FuzzyNetwork::Parameters normalisation(const FuzzyTrainingData& data, double input_clip);

/// Rows as the network sees them, one to a column, with their mirror images behind them: of row n at n + N.
struct NormalisedRows {
  Eigen::MatrixXd inputs;   ///< U' (d x n)
  Eigen::MatrixXd targets;  ///< T' (p x n)
};
NormalisedRows normalised_rows(const FuzzyTrainingData& data, const FuzzyNetwork::Parameters& normalisation);

/// At most `count` of `total` row numbers, ascending: one at random from each of `count` equal strata, so that every
/// run and every phase of it is represented.
std::vector<Eigen::Index> stratified_rows(Eigen::Index total, Eigen::Index count, RandomStream& random);

}  // namespace truebearing
