// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/angle_likelihood_kernels.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <vector>

#include "truebearing/array/angle_likelihood.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/core/simd_width.hpp"

namespace truebearing::angle_likelihood_kernels_test {
namespace {

// The parts of the information of N signals, each (N x N) by columns of `lanes`, and J made of them.
struct Parts {
  int N, lanes;
  std::array<std::vector<double>, 3> parts;  // angles, angle_power, powers
  std::vector<double> J;

  explicit Parts(int signals) : N(signals), lanes(padded_to_widest(signals)) {
    double next = 0.0;
    for (std::vector<double>& part : parts) {
      part.assign(static_cast<std::size_t>(N * lanes), -1.0);
      for (int j = 0; j < N; ++j)
        for (int i = 0; i < N; ++i) part[place(i, j)] = next++;
    }
    J.resize(static_cast<std::size_t>(4 * N * N));
  }

  std::size_t place(int i, int j) const { return static_cast<std::size_t>(j * lanes + i); }
  double at(int i, int j) const { return J[static_cast<std::size_t>(j * 2 * N + i)]; }

  bool assemble() {
    bool is_finite = false;
    kernels::assemble_information({N, lanes, parts[0].data(), parts[1].data(), parts[2].data(), J.data(), &is_finite});
    return is_finite;
  }
};

TEST(AssembledInformation, HasEveryPartInItsPlace) {
  for (int N = 1; N <= kMaxSignals; ++N) {
    Parts of(N);
    ASSERT_TRUE(of.assemble()) << N;
    for (int j = 0; j < N; ++j)
      for (int i = 0; i < N; ++i) {
        EXPECT_EQ(of.at(i, j), of.parts[0][of.place(i, j)]) << N;
        EXPECT_EQ(of.at(i, N + j), of.parts[1][of.place(i, j)]) << N;
        EXPECT_EQ(of.at(N + j, i), of.parts[1][of.place(i, j)]) << N;
        EXPECT_EQ(of.at(N + i, N + j), of.parts[2][of.place(i, j)]) << N;
      }
  }
}

TEST(AssembledInformation, OfOneNumberThatIsNotFiniteIsNot) {
  for (int N = 1; N <= kMaxSignals; ++N) {
    Parts of(N);
    for (std::vector<double>& part : of.parts)
      for (int j = 0; j < N; ++j)
        for (int i = 0; i < N; ++i)
          for (const double value : {kInfinity, -kInfinity, kNaN}) {
            double& number = part[of.place(i, j)];
            const double before = number;
            number = value;
            EXPECT_FALSE(of.assemble()) << N << ": " << i << " " << j << " " << value;
            number = before;
          }
    EXPECT_TRUE(of.assemble()) << N;
  }
}

TEST(AssembledInformation, OfNumbersWhoseSumIsNotFiniteIs) {
  for (int N = 1; N <= kMaxSignals; ++N) {
    Parts of(N);
    for (std::vector<double>& part : of.parts) part.assign(part.size(), std::numeric_limits<double>::max());
    EXPECT_TRUE(of.assemble()) << N;
  }
}

}  // namespace
}  // namespace truebearing::angle_likelihood_kernels_test
