// SPDX-License-Identifier: Apache-2.0
#include "truebearing/core/chi_square.hpp"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/normal.hpp>

#include "truebearing/core/constants.hpp"

namespace truebearing {

double chi_square_quantile(double probability, double degrees_of_freedom) {
  return boost::math::quantile(boost::math::chi_squared(degrees_of_freedom), probability);
}

ChiSquareMeans chi_square_means(double count, double degrees_of_freedom) {
  constexpr double kOutside = 0.025;
  if (!(count > 0.0)) return {kNaN, kNaN};
  const double all = count * degrees_of_freedom;  // the sum is a chi-square of these
  return {chi_square_quantile(kOutside, all) / count, chi_square_quantile(1.0 - kOutside, all) / count};
}

double normal_quantile(double probability) {
  return boost::math::quantile(boost::math::normal(), probability);
}

}  // namespace truebearing
