// SPDX-License-Identifier: Apache-2.0
// The measurements of targets in space: range, bearing and elevation, with a range rate and without, two angles alone,
// and the conversion to a position.
#include <gtest/gtest.h>

#include "tests/support/jacobian.hpp"
#include "truebearing/core/covariance.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/measurement/bearing_elevation.hpp"
#include "truebearing/measurement/position_and_rate.hpp"
#include "truebearing/measurement/range_bearing_elevation_rate.hpp"
#include "truebearing/measurement/range_bearing_rate.hpp"

namespace truebearing::space_measurements_test {
namespace {

using State = Eigen::Matrix<double, 6, 1>;

constexpr double kAlgebra = 1e-12;
constexpr double kJacobian = 1e-6;

const Eigen::Vector3d kSite_m(100.0, 200.0, 30.0), kSiteVelocity_mps(1.0, -2.0, 3.0);

template <typename Model>
void expect_jacobian_of_central_differences(const Model& model, std::uint64_t seed) {
  RandomStream random({seed, Role::evaluation, 0}, StreamId::test);
  for (int trial = 0; trial < 100; ++trial) {
    State x;
    for (int i = 0; i < 3; ++i) x(i) = 1e4 * random.normal();
    for (int i = 3; i < 6; ++i) x(i) = 50.0 * random.normal();
    const auto z = model.h(x);
    const double length_m = 1e-4 * (x.head<3>() - kSite_m).head<2>().norm();
    const State step{length_m, length_m, length_m, 1e-3, 1e-3, 1e-3};
    const auto expected =
        testing::central_differences([&](const State& at) { return model.residual(model.h(at), z); }, x, step);
    for (int i = 0; i < Model::kMeasurements; ++i)
      EXPECT_LT((model.H(x).row(i) - expected.row(i)).norm(), kJacobian * expected.row(i).norm()) << i;
  }
}

const RangeBearingElevation<> kPolar{kSite_m, {50.0, 0.01, 0.02}};
const RangeBearingElevationRate<> kDoppler{kSite_m, kSiteVelocity_mps, {50.0, 0.01, 0.02, 0.5}, 0.7};
const BearingElevation<> kAngles{kSite_m, {0.01, 0.02}};

TEST(SpaceMeasurements, HaveTheJacobiansOfCentralDifferences) {
  expect_jacobian_of_central_differences(kPolar, 41);
  expect_jacobian_of_central_differences(kDoppler, 42);
  expect_jacobian_of_central_differences(kAngles, 43);
  const State row{-0.1, -0.2, -0.2, 0.3, 0.6, 0.6};
  expect_jacobian_of_central_differences(PositionAndRate<3>{Eigen::Matrix3d::Identity(), row, 0.3, 1.0}, 44);
}

TEST(SpaceMeasurements, AreWhatIsSeen) {
  const State x{kSite_m.x() + 3.0, kSite_m.y() + 4.0, kSite_m.z() + 12.0, 1.0, 2.0, 16.0};
  const Eigen::Vector4d z = kDoppler.h(x);
  EXPECT_NEAR(z(0), 13.0, kAlgebra);
  EXPECT_NEAR(z(1), std::atan2(3.0, 4.0), kAlgebra);
  EXPECT_NEAR(z(2), std::atan2(12.0, 5.0), kAlgebra);
  EXPECT_NEAR(z(3), (4.0 * 4.0 + 12.0 * 13.0) / 13.0, kAlgebra);
  EXPECT_EQ(kPolar.h(x), z.head<3>());
  EXPECT_EQ(kAngles.h(x), z.segment<2>(1));
  const Eigen::Matrix4d R = kDoppler.R();
  EXPECT_TRUE(R.diagonal().isApprox(Eigen::Vector4d(2500.0, 1e-4, 4e-4, 0.25), kAlgebra));
  EXPECT_NEAR(R(0, 3), 0.7 * 50.0 * 0.5, kAlgebra);
  EXPECT_TRUE(is_covariance(R));
}

// A target and a sensor in the plane are seen as the models of the plane see them.
TEST(SpaceMeasurements, AgreeWithThePlane) {
  const RangeBearingRate<> plane{{100.0, 200.0}, {1.0, -2.0}, 50.0, 0.01, 0.5};
  const RangeBearingElevationRate<> space{{100.0, 200.0, 0.0}, {1.0, -2.0, 0.0}, {50.0, 0.01, 0.02, 0.5}};
  const Eigen::Vector4d flat(-3000.0, 800.0, 20.0, -30.0);
  const State x{flat[0], flat[1], 0.0, flat[2], flat[3], 0.0};
  const Eigen::Vector3d z = plane.h(flat);
  EXPECT_TRUE(space.h(x).isApprox(Eigen::Vector4d(z[0], z[1], 0.0, z[2]), kAlgebra));
  const Eigen::Matrix<double, 4, 6> H = space.H(x);
  const Eigen::Matrix<double, 3, 4> expected = plane.H(flat);
  for (const auto& [row, of_plane] : {std::pair{0, 0}, {1, 1}, {3, 2}}) {
    const Eigen::Vector4d level(H(row, 0), H(row, 1), H(row, 3), H(row, 4));
    EXPECT_LT((level - expected.row(of_plane).transpose()).norm(), kAlgebra) << row;
    EXPECT_EQ(H(row, 2), 0.0);
    EXPECT_EQ(H(row, 5), 0.0);
  }
}

TEST(SpaceMeasurements, WholeTurnsOfTheBearingAloneChangeNothing) {
  const Eigen::Vector4d z(5000.0, 3.1, 1.5, 7.0), z_pred(4990.0, -3.1, -1.5, 4.0);
  const Eigen::Vector4d difference(10.0, 6.2 - 2 * kPi, 3.0, 3.0);
  EXPECT_TRUE(kDoppler.residual(z, z_pred).isApprox(difference, kAlgebra));
  EXPECT_TRUE(kPolar.residual(z.head<3>(), z_pred.head<3>()).isApprox(difference.head<3>(), kAlgebra));
  EXPECT_TRUE(kAngles.residual(z.segment<2>(1), z_pred.segment<2>(1)).isApprox(difference.segment<2>(1), kAlgebra));
}

TEST(SpaceMeasurements, SayNothingAtTheSiteAndNoBearingAboveIt) {
  State x;
  x << kSite_m, 10.0, 20.0, 30.0;
  EXPECT_TRUE(kPolar.H(x).isZero(0.0));
  EXPECT_TRUE(kDoppler.H(x).isZero(0.0));
  EXPECT_TRUE(kAngles.H(x).isZero(0.0));
  EXPECT_EQ(kDoppler.h(x)(3), 0.0);
  x(2) += 1000.0;
  EXPECT_TRUE(kDoppler.H(x).row(1).isZero(0.0));
  EXPECT_EQ(kDoppler.H(x)(0, 2), 1.0);
  EXPECT_TRUE(kDoppler.h(x).allFinite());
}

// Mean and covariance of the errors of positions that are converted from drawn measurements; the standard deviations of
// the angles are large enough for the bias to show. 2e5 draws: the mean of each component is known to .0022 of its standard
// deviation, a variance to .32 % (of errors with broader tails a little less), so that the limits are five of these.
TEST(ConvertedElevation, IsUnbiasedAndHasItsCovariance) {
  constexpr int kDraws = 200'000;
  const Eigen::Vector3d sigma(50.0, 0.15, 0.1);
  for (const Eigen::Vector3d& offset_m :
       {Eigen::Vector3d(3000.0, -1000.0, 2000.0), Eigen::Vector3d(10.0, 4000.0, 50.0)}) {
    RandomStream random({51, Role::evaluation, 0}, StreamId::test);
    const SightInSpace<double> sight(offset_m);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero(), biased = sum;
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    for (int i = 0; i < kDraws; ++i) {
      const Eigen::Vector3d noise =
          sigma.cwiseProduct(Eigen::Vector3d(random.normal(), random.normal(), random.normal()));
      const Eigen::Vector3d z = Eigen::Vector3d(sight.range_m, sight.bearing_rad, sight.elevation_rad) + noise;
      const Eigen::Vector3d error = convert_range_bearing_elevation(z, sigma, kSite_m) - (kSite_m + offset_m);
      biased += convert_range_bearing_elevation(z, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()) - offset_m;
      sum += error;
      squares += error * error.transpose();
    }
    const Eigen::Matrix3d R = converted_covariance(offset_m, sigma);
    ASSERT_TRUE(is_covariance(R));
    const Eigen::Vector3d deviation = R.diagonal().cwiseSqrt();
    EXPECT_LT((sum / kDraws).cwiseQuotient(deviation).cwiseAbs().maxCoeff(), 0.011);
    EXPECT_GT((biased / kDraws).cwiseQuotient(deviation).cwiseAbs().maxCoeff(), 0.05) << "what is corrected";
    const Eigen::Matrix3d difference = squares / kDraws - R;
    EXPECT_LT((deviation.cwiseInverse().asDiagonal() * difference * deviation.cwiseInverse().asDiagonal())
                  .cwiseAbs()
                  .maxCoeff(),
              0.02);
  }
}

TEST(ConvertedElevation, IsTheConversionOfThePlaneOnTheGround) {
  const Eigen::Vector3d sigma(50.0, 0.03, 0.0);
  const Eigen::Matrix3d R = converted_covariance({3000.0, 4000.0, 0.0}, sigma);
  EXPECT_TRUE(
      (R.topLeftCorner<2, 2>().isApprox(converted_covariance(Eigen::Vector2d(3000.0, 4000.0), 50.0, 0.03), 1e-9)));
  EXPECT_EQ(R(2, 2), 0.0);
  const ConvertedPosition plane = convert_range_bearing({5000.0, 0.7}, 50.0, 0.03, {1.0, 2.0});
  const Eigen::Vector3d position = convert_range_bearing_elevation({5000.0, 0.7, 0.0}, sigma, {1.0, 2.0, 3.0});
  EXPECT_TRUE(position.isApprox(Eigen::Vector3d(plane.position_m.x(), plane.position_m.y(), 3.0), kAlgebra));
}

}  // namespace
}  // namespace truebearing::space_measurements_test
