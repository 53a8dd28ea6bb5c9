#include "mindahl/report/units.h"
#include "support/prelude.h"

namespace mindahl::report::quantity_test {
namespace {

TEST(Quantity, IsInTheUnitThatMakesANumberFromOneToAThousand) {
  EXPECT_EQ(Quantity(4.8142e7, "N/m", 4), "48.14 N/µm");
  EXPECT_EQ(Quantity(41260.0, "N/m", 4), "41.26 N/mm");
  EXPECT_EQ(Quantity(12.5, "N/m", 4), "12.5 N/m");
  EXPECT_EQ(Quantity(5.609e-7, "m", 5), "560.9 nm");
  EXPECT_EQ(Quantity(-2.5e-4, "m", 3), "-250 µm");
  EXPECT_EQ(Quantity(1.1217e-5, "J", 5), "11.217 µJ");
  EXPECT_EQ(Quantity(3.72e8, "Pa", 3), "372 MPa");
  EXPECT_EQ(Quantity(2300.0, "N m", 3), "2.3 kN m");
  EXPECT_EQ(Quantity(0.125, "N", 2), "125 mN");  // not 1.2e+02
  EXPECT_EQ(Quantity(9.996e-4, "m", 4), "999.6 µm");
  EXPECT_EQ(Quantity(9.9996e-4, "m", 4), "1 mm");  // not 1000 µm
  EXPECT_EQ(Quantity(0.9996, "N", 3), "1 N");      // not 1e+03 mN
  EXPECT_EQ(Quantity(-0.9996, "N", 2), "-1 N");
  EXPECT_EQ(Quantity(99.6, "-", 2), "99.6");  // not 1e+02
  // A unit that takes no prefix is kept, and so is the unit of zero.
  EXPECT_EQ(Quantity(4.2e-11, "1/Pa", 3), "4.2e-11 1/Pa");
  EXPECT_EQ(Quantity(0.25, "-", 3), "0.25");
  EXPECT_EQ(Quantity(12345.0, "m", 5), "12345 m");  // no kilometres
  EXPECT_EQ(Quantity(0.0, "m", 3), "0 m");
  EXPECT_EQ(Quantity(std::numeric_limits<double>::infinity(), "N", 3), "inf N");
}

TEST(QuantityWithError, IsRoundedToTwoDigitsOfTheError) {
  EXPECT_EQ(QuantityWithError(4.814218e7, 3.91e4, "N/m"), "48.142 ± 0.039 N/µm");
  EXPECT_EQ(QuantityWithError(0.333048, 0.00112, "-"), "0.3330 ± 0.0011");
  EXPECT_EQ(QuantityWithError(15.0014, 0.0996, "N"), "15.00 ± 0.10 N");
  EXPECT_EQ(QuantityWithError(412.3, 131.0, "N"), "410 ± 130 N");
  // In the unit of the larger of the two.
  EXPECT_EQ(QuantityWithError(3.19e-4, 2.7e-3, "N"), "0.3 ± 2.7 mN");
  EXPECT_EQ(QuantityWithError(-1e-5, 2.7e-3, "N"), "0.0 ± 2.7 mN");  // not -0.0
  EXPECT_EQ(QuantityWithError(2.5329e-4, 0.0, "m"), "253.29 µm");
  EXPECT_EQ(QuantityWithError(1.5e-6, std::nullopt, "m"), "1.5 µm");
}

TEST(QuantityWithError, HasFiveDigitsFromAMillionOnAndWhereItIsSmallWithoutAPrefix) {
  EXPECT_EQ(QuantityWithError(5.00164e16, 1.2e14, "m"), "5.0016e+16 ± 1.2e+14 m");
  EXPECT_EQ(QuantityWithError(999949.0, 120.0, "m"), "999950 ± 120 m");
  EXPECT_EQ(QuantityWithError(4.207216e-11, 7.075e-14, "1/Pa"), "4.2072e-11 ± 7.075e-14 1/Pa");
}

TEST(QuantityWithInterval, HasTwoDigitsOfHalfTheIntervalAndSaysWhichEndIsOpen) {
  EXPECT_EQ(QuantityWithInterval(4.0e7, 3.92e7, 4.08e7, "N/m"), "40.00 N/µm (39.20 … 40.80)");
  EXPECT_EQ(QuantityWithInterval(0.433, 0.381, 0.498, "-"), "0.433 (0.381 … 0.498)");
  EXPECT_EQ(QuantityWithInterval(15.0, 12.0, std::nullopt, "N"), "15.0 N (12.0 … open)");
  EXPECT_EQ(QuantityWithInterval(15.0, std::nullopt, std::nullopt, "N"), "15 N");
}

TEST(UnitOfTorque, IsThatOfAForceTranslated) {
  for (const auto& [of_force, of_torque] : {std::pair("N", "N m"),
                                            {"m", "rad"},
                                            {"N/m", "N m/rad"},
                                            {"N/m²", "N m/rad²"},
                                            {"N s/m", "N m s/rad"},
                                            {"kg", "kg m²"},
                                            {"N samples²/m", "N m samples²/rad"},
                                            {"J", "J"},
                                            {"-", "-"}}) {
    EXPECT_EQ(UnitOfTorque(of_force), of_torque);
  }
}

/// What is printed is the value to within half of its last digit, whatever the sizes.
TEST(QuantityWithError, IsTheValueToWithinATwentiethOfItsError) {
  for (int exponent = -12; exponent <= 9; ++exponent) {
    for (const double mantissa : {1.0, 3.337, 9.995}) {
      for (const double relative : {1e-5, 0.0123, 0.5, 3.0}) {
        const double value = mantissa * std::pow(10.0, exponent);
        const double error = relative * value;
        const ScaledUnit unit = UnitFor("N", std::max(value, error));
        const double printed = std::stod(RoundedTo(error / unit.factor, value / unit.factor));
        EXPECT_LE(std::abs(printed * unit.factor - value), 0.0505 * error)
            << value << " ± " << error;
      }
    }
  }
}

}  // namespace
}  // namespace mindahl::report::quantity_test
