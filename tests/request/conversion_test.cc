#include "mindahl/request/conversion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mindahl::request::conversion_test {
namespace {

TEST(MakeConversion, RangesToWhereItIsAskedAndElseEndsAtTheAmplitude) {
  ConversionRequest request;
  request.law = {.tangential_stiffness = 4e7, .shape_exponent = 1.0 / 3, .slip_force = 40.0};
  request.to = "lammps";
  request.options.amplitude = 1e-6;
  EXPECT_FALSE(MakeConversion(request).request.options.range);
  request.largest_amplitude = 3e-6;
  const auto above = MakeConversion(request).request.options.range;
  ASSERT_TRUE(above);
  EXPECT_EQ(above->lower, 1e-6);
  EXPECT_EQ(above->upper, 3e-6);
  request.largest_amplitude.reset();
  request.least_amplitude = 2e-7;
  const auto below = MakeConversion(request).request.options.range;
  ASSERT_TRUE(below);
  EXPECT_EQ(below->lower, 2e-7);
  EXPECT_EQ(below->upper, 1e-6);
}

TEST(MakeConversion, OfAContactThatSticksHasNoRelativeErrorOfTheEnergy) {
  ConversionRequest request;
  request.law = {.tangential_stiffness = 4e7, .shape_exponent = 0.0, .slip_force = 40.0};
  request.to = "lugre";
  request.options.amplitude = 5e-7;  // half of what Jenkins' element slips at
  const std::string text = ToText(MakeConversion(request));
  EXPECT_THAT(text, ::testing::HasSubstr("energy lost where the contact loses none\n"));
  EXPECT_THAT(text, ::testing::Not(::testing::HasSubstr("inf")));
}

}  // namespace
}  // namespace mindahl::request::conversion_test
