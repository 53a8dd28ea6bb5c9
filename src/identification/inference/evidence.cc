#include "identification/inference/evidence.h"

#include <algorithm>
#include <cmath>

#include "identification/problem/scaled_records.h"

namespace mindahl::identification {
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

}  // namespace mindahl::identification
