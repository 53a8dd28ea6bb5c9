#include "mindahl/contact/hertz.h"

#include "support/prelude.h"

namespace mindahl::contact::hertz_test {
namespace {

constexpr double kPlane = std::numeric_limits<double>::infinity();
const Body kSteel{.youngs_modulus = 210e9, .poisson_ratio = 0.3};

TEST(EquivalentRadius, IsThatOfThePairInParallel) {
  EXPECT_EQ(EquivalentRadius(0.01, kPlane), 0.01);
  EXPECT_EQ(EquivalentRadius(kPlane, 0.01), 0.01);
  EXPECT_EQ(Body{}.radius, kPlane);
  EXPECT_DOUBLE_EQ(EquivalentRadius(0.01, 0.01), 0.005);
  EXPECT_DOUBLE_EQ(EquivalentRadius(0.03, 0.06), 0.02);
  EXPECT_DOUBLE_EQ(EquivalentRadius(0.06, 0.03), 0.02);
  EXPECT_DOUBLE_EQ(EquivalentRadius(0.02, -0.03), 0.06);  // of a ball in a seat
  EXPECT_DOUBLE_EQ(EquivalentRadius(-0.03, 0.02), 0.06);
}

TEST(EquivalentRadius, KeepsItsDigitsInANearlyConformalSeat) {
  // 1/ρ = 1/1 − 1/(1 + 2⁻⁴⁰): ρ = 2⁴⁰ + 1 exactly.
  EXPECT_NEAR(EquivalentRadius(1.0, -(1.0 + std::ldexp(1.0, -40))) / (std::ldexp(1.0, 40) + 1.0),
              1.0, 2.0 * std::numeric_limits<double>::epsilon());
}

TEST(HertzInput, RefusesSurfacesWithoutAContactCircle) {
  EXPECT_EQ(MessageOf([] { EquivalentRadius(kPlane, kPlane); }),
            "relative curvature 1/R1 + 1/R2 [1/m] = 0 is invalid: must be > 0: two planes make no "
            "Hertz contact, at least one radius must be finite");
  const std::string seat =
      " is invalid: must be > 0: a concave seat (negative radius) must be wider than the body in "
      "it";
  for (const auto& [radius_1, radius_2, curvature] :
       {std::tuple{0.5, -0.25, "-2"}, {0.5, -0.5, "0"}, {kPlane, -0.5, "-2"}, {-0.5, -0.5, "-4"}}) {
    EXPECT_EQ(MessageOf([one = radius_1, two = radius_2] { EquivalentRadius(one, two); }),
              std::string("relative curvature 1/R1 + 1/R2 [1/m] = ") + curvature + seat);
  }
}

TEST(HertzInput, RefusesARadiusOfZero) {
  EXPECT_EQ(MessageOf([] { EquivalentRadius(0.01, 0.0); }),
            "radius of body 2 [m] = 0 is invalid: must be a number other than 0: infinite for a "
            "plane, negative for a concave seat");
  EXPECT_EQ(MessageOf([] { EquivalentRadius(std::nan(""), 0.01); }),
            "radius of body 1 [m] = nan is invalid: must be a number other than 0: infinite for a "
            "plane, negative for a concave seat");
}

TEST(HertzInput, BoundsThePoissonRatioByStability) {
  const auto with = [](double poisson_ratio) {
    return MessageOf([=] {
      const Body body{.youngs_modulus = 1e9, .poisson_ratio = poisson_ratio};
      ShearModulus(body);
      EffectiveModulus(kSteel, body);
    });
  };
  EXPECT_EQ(with(0.5), "");
  EXPECT_EQ(with(-0.999), "");
  EXPECT_EQ(with(-1.0), "Poisson ratio = -1 is invalid: must be > -1 and <= 0.5");
  EXPECT_EQ(with(0.51), "Poisson ratio = 0.51 is invalid: must be > -1 and <= 0.5");
  EXPECT_EQ(with(std::nan("")), "Poisson ratio = nan is invalid: must be > -1 and <= 0.5");
}

TEST(HertzInput, NamesTheQuantityThatIsNotPositive) {
  EXPECT_EQ(
      MessageOf([] { EffectiveModulus({.youngs_modulus = 0.0, .poisson_ratio = 0.3}, kSteel); }),
      "Young's modulus [Pa] = 0 is invalid: must be finite and > 0");
  EXPECT_EQ(MessageOf([] { EffectiveModulus(kSteel, {.youngs_modulus = -1.0}); }),
            "Young's modulus [Pa] = -1 is invalid: must be finite and > 0");
  EXPECT_EQ(MessageOf([] { HertzContactRadius(-1.0, 0.01, 1e11); }),
            "normal load [N] = -1 is invalid: must be finite and > 0");
  EXPECT_EQ(MessageOf([] { HertzContactRadius(1.0, 0.0, 1e11); }),
            "equivalent radius [m] = 0 is invalid: must be finite and > 0");
  EXPECT_EQ(MessageOf([] { HertzContactRadius(1.0, 0.01, kPlane); }),
            "effective modulus [Pa] = inf is invalid: must be finite and > 0");
  EXPECT_EQ(MessageOf([] { HertzEquivalentRadius(1.0, 0.0, 1e11); }),
            "contact radius [m] = 0 is invalid: must be finite and > 0");
  EXPECT_EQ(MessageOf([] { HertzMaximumPressure(0.0, 1e-3); }),
            "normal load [N] = 0 is invalid: must be finite and > 0");
}

}  // namespace
}  // namespace mindahl::contact::hertz_test
