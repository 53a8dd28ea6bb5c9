#include "report/prefixed.h"

#include <gtest/gtest.h>

namespace mindahl::report {
namespace {

TEST(Quantity, HasThePrefixWithWhichItIsFromOneToAThousand) {
  EXPECT_EQ(QuantityText(4e7, "N/m"), "40 N/µm");
  EXPECT_EQ(QuantityText(1.5e-6, "m"), "1.5 µm");
  EXPECT_EQ(QuantityText(0.0123456, "N"), "12.346 mN");
  EXPECT_EQ(QuantityText(-1500, "N"), "−1.5 kN");
  EXPECT_EQ(QuantityText(0, "m"), "0 m");
}

TEST(Quantity, LeavesAPureNumberAndAnUnknownUnitAlone) {
  EXPECT_EQ(QuantityText(0.33333333, "-"), "0.33333");
  EXPECT_EQ(QuantityText(12345, "N samples/m"), "12345 N samples/m");
  EXPECT_EQ(QuantityText(1e-9, "-"), "1.0000e-09");
}

TEST(Quantity, HasTwoDigitsOfItsErrorAndIsRoundedToThem) {
  EXPECT_EQ(QuantityText(3.98765e7, 1.234e5, "N/m"), "39.88 ± 0.12 N/µm");
  EXPECT_EQ(QuantityText(0.333333, 0.0123, "-"), "0.333 ± 0.012");
  EXPECT_EQ(QuantityText(0.300028785, 8.2e-5, "-"), "0.300029 ± 0.000082");
  // The larger of the two has the prefix.
  EXPECT_EQ(QuantityText(3e-4, 2.7e-3, "N"), "0.3 ± 2.7 mN");
  EXPECT_EQ(ValueText(40.0, 12.0, 1.0), "40 ± 12");
}

TEST(Quantity, HasOpenEndsOfAnInterval) {
  EXPECT_EQ(IntervalText(3.92e7, 4.08e7, 1e6), "39.20 … 40.80");
  EXPECT_EQ(IntervalText(12.5, std::nullopt, 1.0), "12.5 … open");
  EXPECT_EQ(IntervalText(-0.5, 0.25, 1.0), "−0.500 … 0.250");
}

}  // namespace
}  // namespace mindahl::report
