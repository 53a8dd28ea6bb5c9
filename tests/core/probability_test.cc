#include "core/probability.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

// Against closed forms, of degrees of freedom where there are any: the quantiles are inverses, and
// no two arguments may be swapped.
namespace mindahl::probability_test {
namespace {

constexpr double kRounding = 1e-12;

TEST(Probability, FOfTwoDegreesIsAPower) {
  // P(F(2, n) > f) = (1 + 2f/n)^(−n/2).
  EXPECT_NEAR(PValueOfF(3, 2, 10), std::pow(1.6, -5), kRounding);
  EXPECT_NEAR(FQuantile(2, 10, std::pow(1.6, -5)), 3, 1e-9);
}

TEST(Probability, FOfOneDegreeIsTheSquareOfT) {
  // P(|t| > x) of one degree: 1 − 2·atan(x)/π.
  const double chance = 1 - 2 * std::atan(2.0) / std::numbers::pi;
  EXPECT_NEAR(PValueOfT(2, 1), chance, kRounding);
  EXPECT_NEAR(PValueOfF(4, 1, 1), chance, kRounding);
}

TEST(Probability, ChiSquaredOfTwoDegreesIsExponential) {
  EXPECT_NEAR(PValueOfChiSquared(3, 2), std::exp(-1.5), kRounding);
}

TEST(Probability, QuantilesAreTwoSided) {
  // With one degree of freedom t is tan(π·c/2).
  EXPECT_NEAR(StudentQuantile(1, 0.5), 1, kRounding);
  EXPECT_NEAR(StudentQuantile(1, 0.9), std::tan(0.45 * std::numbers::pi), 1e-10);
  EXPECT_NEAR(std::erf(NormalQuantile(0.95) / std::numbers::sqrt2), 0.95, kRounding);
}

}  // namespace
}  // namespace mindahl::probability_test
