#include "core/probability.h"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/special_functions/erf.hpp>
#include <cmath>
#include <numbers>

namespace mindahl {
namespace {

/// Boost would evaluate in long double, at several times the cost, to round the last digit well.
using InDouble = boost::math::policies::policy<boost::math::policies::promote_double<false>>;
using ChiSquared = boost::math::chi_squared_distribution<double, InDouble>;
using FisherF = boost::math::fisher_f_distribution<double, InDouble>;
using StudentsT = boost::math::students_t_distribution<double, InDouble>;

}  // namespace

double NormalQuantile(double confidence) {
  return std::numbers::sqrt2 * boost::math::erf_inv(confidence);
}

double StudentQuantile(double degrees_of_freedom, double confidence) {
  return quantile(StudentsT(degrees_of_freedom), (1 + confidence) / 2);
}

double PValueOfT(double t, double degrees_of_freedom) {
  return 2 * cdf(complement(StudentsT(degrees_of_freedom), std::abs(t)));
}

double PValueOfF(double f, double numerator_degrees, double degrees_of_freedom) {
  return cdf(complement(FisherF(numerator_degrees, degrees_of_freedom), f));
}

double QuantileOfF(double p_value, double numerator_degrees, double degrees_of_freedom) {
  return quantile(complement(FisherF(numerator_degrees, degrees_of_freedom), p_value));
}

double PValueOfChiSquared(double x, double degrees_of_freedom) {
  return cdf(complement(ChiSquared(degrees_of_freedom), x));
}

}  // namespace mindahl
