#include "core/probability.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

// Against closed forms, of degrees of freedom where there are any: the quantiles are inverses, and
// no two arguments may be swapped.
namespace mindahl::probability_test {
namespace {

constexpr double kRounding = 1e-13;

TEST(Probability, FOfTwoDegreesIsAPower) {
  // P(F(2, n) > f) = (1 + 2f/n)^(−n/2).
  EXPECT_NEAR(PValueOfF(3, 2, 10), std::pow(1.6, -5), kRounding);
}

TEST(Probability, FOfOneDegreeIsTheSquareOfT) {
  // P(|t| > x) = 1 − 2/π·atan x at one degree, 1 − x/√(2 + x²) at two.
  for (const double x : {0.3, 1.0, 2.0, 7.0}) {
    const double chance = 1 - 2 * std::atan(x) / std::numbers::pi;
    EXPECT_NEAR(PValueOfT(x, 1), chance, kRounding);
    EXPECT_NEAR(PValueOfF(x * x, 1, 1), chance, kRounding);
    EXPECT_NEAR(PValueOfF(x * x, 1, 2), 1 - x / std::sqrt(2 + x * x), kRounding);
  }
  EXPECT_EQ(PValueOfF(0, 1, 7), 1);
  EXPECT_NEAR(QuantileOfF(std::pow(1.6, -5), 2, 10), 3, 3 * kRounding);
}

TEST(Probability, ChiSquaredOfTwoDegreesIsExponential) {
  EXPECT_NEAR(PValueOfChiSquared(3, 2), std::exp(-1.5), kRounding);
}

TEST(Probability, QuantilesAreTwoSided) {
  // With one degree of freedom t is tan(π·c/2), with two c·√(2/(1 − c²)).
  for (const double chance : {0.5, 0.9, 0.95}) {
    EXPECT_NEAR(StudentQuantile(1, chance), std::tan(chance / 2 * std::numbers::pi), 1e-11);
    EXPECT_NEAR(StudentQuantile(2, chance), chance * std::sqrt(2 / (1 - chance * chance)), 1e-11);
  }
  for (const double chance : {0.01, 0.5, 0.95, 0.999999}) {
    EXPECT_NEAR(std::erf(NormalQuantile(chance) / std::numbers::sqrt2), chance, kRounding);
  }
}

}  // namespace
}  // namespace mindahl::probability_test
