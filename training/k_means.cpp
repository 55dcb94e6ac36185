// SPDX-License-Identifier: Apache-2.0
#include "training/k_means.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "training/fuzzy_training.hpp"
#include "truebearing/core/error.hpp"

namespace truebearing {
namespace {

// Points and centres stand in columns here.
Eigen::Index nearest(const Eigen::MatrixXd& centres, const Eigen::Ref<const Eigen::VectorXd>& point) {
  Eigen::Index best = 0;
  double best_distance = (centres.col(0) - point).squaredNorm();
  for (Eigen::Index j = 1; j < centres.cols(); ++j) {
    const double distance = (centres.col(j) - point).squaredNorm();
    if (distance < best_distance) {
      best_distance = distance;
      best = j;
    }
  }
  return best;
}

// Each next seed is a point drawn with probability proportional to its squared distance from the seeds so far.
Eigen::MatrixXd spread_seeds(const Eigen::MatrixXd& points, Eigen::Index count, RandomStream& random) {
  Eigen::MatrixXd seeds(points.rows(), count);
  seeds.col(0) = points.col(static_cast<Eigen::Index>(random.index(static_cast<std::uint64_t>(points.cols()))));
  Eigen::VectorXd distances = (points.colwise() - seeds.col(0)).colwise().squaredNorm();
  for (Eigen::Index j = 1; j < count; ++j) {
    double remaining = random.uniform() * distances.sum();
    Eigen::Index drawn = 0;
    while (drawn + 1 < points.cols() && remaining >= distances[drawn]) remaining -= distances[drawn++];
    seeds.col(j) = points.col(drawn);
    distances = distances.cwiseMin((points.colwise() - seeds.col(j)).colwise().squaredNorm().transpose());
  }
  return seeds;
}

}  // namespace

Eigen::MatrixXd k_means(const Eigen::MatrixXd& points, int count, RandomStream& random, const KMeansOptions& options) {
  if (count < 1 || points.rows() < count) {
    throw InputError("k-means", std::to_string(count) + " centres for " + std::to_string(points.rows()) + " points",
                     "1 to the number of points");
  }
  const std::vector<Eigen::Index> rows =
      stratified_rows(points.rows(), std::max<Eigen::Index>(options.max_points, count), random);
  const Eigen::MatrixXd sample = points(rows, Eigen::all).transpose();
  Eigen::MatrixXd centres = spread_seeds(sample, count, random);
  std::vector<Eigen::Index> assigned(rows.size(), -1);
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(sample.rows(), count);
    Eigen::VectorXd members = Eigen::VectorXd::Zero(count);
    bool changed = false;
    for (Eigen::Index n = 0; n < sample.cols(); ++n) {
      const Eigen::Index j = nearest(centres, sample.col(n));
      changed |= j != std::exchange(assigned[static_cast<std::size_t>(n)], j);
      sums.col(j) += sample.col(n);
      members[j] += 1.0;
    }
    if (!changed) break;
    for (Eigen::Index j = 0; j < count; ++j) {
      if (members[j] > 0.0) centres.col(j) = sums.col(j) / members[j];  // an empty one stays where it is
    }
  }
  return centres.transpose();
}

}  // namespace truebearing
