// SPDX-License-Identifier: Apache-2.0
#include "truebearing/measurement/range_to_site.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "truebearing/core/random.hpp"

namespace truebearing::range_to_site_test {
namespace {

constexpr double kJacobian = 1e-6;

TEST(RangeToSite, MeasuresTheDistance) {
  const RangeToSite<> model{{100.0, 200.0}, 150.0};
  EXPECT_DOUBLE_EQ(model.h({103.0, 196.0, 7.0, 8.0})(0), 5.0);
  EXPECT_DOUBLE_EQ(model.R()(0), 22500.0);
}

TEST(RangeToSite, HasTheJacobianOfCentralDifferences) {
  RandomStream random({1, Role::evaluation, 0}, StreamId::test);
  for (int trial = 0; trial < 100; ++trial) {
    const RangeToSite<> model{{random.normal() * 1e3, random.normal() * 1e3}, 1.0};
    const Eigen::Vector4d x(random.normal() * 1e4, random.normal() * 1e4, random.normal() * 50, random.normal() * 50);
    const double step = 1e-2;
    for (int j = 0; j < 4; ++j) {
      const Eigen::Vector4d offset = step * Eigen::Vector4d::Unit(j);
      const double difference = (model.h(x + offset)(0) - model.h(x - offset)(0)) / (2 * step);
      EXPECT_NEAR(model.H(x)(j), difference, kJacobian);
    }
  }
}

TEST(RangeToSite, HasNoDirectionAtTheSite) {
  const RangeToSite<> model{{1.0, 2.0}, 10.0};
  EXPECT_EQ(model.H({1.0, 2.0, 3.0, 4.0}), Eigen::RowVector4d::Zero());
  EXPECT_EQ(model.h({1.0, 2.0, 3.0, 4.0})(0), 0.0);
}

}  // namespace
}  // namespace truebearing::range_to_site_test
