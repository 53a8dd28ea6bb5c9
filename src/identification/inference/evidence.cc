#include "identification/inference/evidence.h"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

#include "identification/problem/scaled_records.h"

namespace mindahl::identification {
namespace {

/// Boost would evaluate in long double, at several times the cost, to round the last digit well.
using InDouble = boost::math::policies::policy<boost::math::policies::promote_double<false>>;

}  // namespace

Evidence::Evidence(std::size_t samples, double effective)
    : samples_(static_cast<double>(samples)), effective_(effective) {}

double Evidence::Floored(double sum_of_squares) const {
  return std::max(sum_of_squares, samples_ * kRoundingRms * kRoundingRms);
}

double Evidence::LikelihoodRatio(double held, double free) const {
  return effective_ * std::log(Floored(held) / Floored(free));
}

double Evidence::FStatistic(double held, double free, double variance) const {
  return std::max(held - free, 0.0) / variance * (effective_ / samples_);
}

double Evidence::Aicc(double sum_of_squares, std::size_t parameters) const {
  const auto k = static_cast<double>(parameters + 1);  // and the variance
  return effective_ * std::log(Floored(sum_of_squares) / samples_) + 2 * k +
         2 * k * (k + 1) / std::max(samples_ - k - 1, 1.0);
}

double PValueOfF(double f, double numerator_degrees, double degrees_of_freedom) {
  const boost::math::fisher_f_distribution<double, InDouble> distribution(numerator_degrees,
                                                                          degrees_of_freedom);
  return boost::math::cdf(boost::math::complement(distribution, f));
}

double PValueOfF(double f, double degrees_of_freedom) {
  return PValueOfF(f, 1.0, degrees_of_freedom);
}

double PValueOfChiSquared(double x, double degrees_of_freedom) {
  const boost::math::chi_squared_distribution<double, InDouble> distribution(degrees_of_freedom);
  return boost::math::cdf(boost::math::complement(distribution, x));
}

double ChiSquaredQuantile(double degrees_of_freedom, double chance) {
  const boost::math::chi_squared_distribution<double, InDouble> distribution(degrees_of_freedom);
  return boost::math::quantile(boost::math::complement(distribution, chance));
}

double StudentQuantile(double degrees_of_freedom, double confidence) {
  struct Asked {
    double degrees_of_freedom = 0.0;
    double confidence = 0.0;
    double quantile = 0.0;
  };
  // Cycle after cycle of a campaign asks for the same.
  thread_local Asked last;
  if (last.degrees_of_freedom != degrees_of_freedom || last.confidence != confidence) {
    const boost::math::students_t_distribution<double, InDouble> distribution(degrees_of_freedom);
    last = {degrees_of_freedom, confidence,
            boost::math::quantile(distribution, (1 + confidence) / 2)};
  }
  return last.quantile;
}

}  // namespace mindahl::identification
