#pragma once

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_int_distribution.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace mindahl {

/// Seeded random numbers, the same on every platform (Boost.Random says so of its own; the standard
/// library leaves distributions open).
class Draws {
 public:
  explicit Draws(std::uint64_t seed) : engine_(seed) {}

  double Uniform(double low, double high) {
    return boost::random::uniform_real_distribution<double>(low, high)(engine_);
  }
  double LogUniform(double low, double high) {
    return std::exp(Uniform(std::log(low), std::log(high)));
  }
  double Normal() { return normal_(engine_); }
  /// Draws an index in 0 … count − 1.
  std::size_t Index(std::size_t count) {
    return boost::random::uniform_int_distribution<std::size_t>(0, count - 1)(engine_);
  }

 private:
  boost::random::mt19937_64 engine_;
  boost::random::normal_distribution<double> normal_;
};

}  // namespace mindahl
