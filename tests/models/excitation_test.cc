#include "mindahl/models/excitation.h"

#include <boost/math/constants/constants.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>

#include "support/histories.h"
#include "support/prelude.h"

namespace mindahl::models::excitation_test {
namespace {

TEST(Excitation, SineIsExactAtZerosAndExtremesAndRepeatsBitForBit) {
  const Excitation sine =
      MakeExcitation({.amplitude = 3e-7, .cycles = 5, .samples_per_cycle = 200});
  ASSERT_EQ(sine.displacement.size(), 1001U);
  for (std::size_t cycle = 0; cycle < 5; ++cycle) {
    const auto at = [&](std::size_t i) { return sine.displacement[200 * cycle + i]; };
    EXPECT_EQ(at(0), 0.0);
    EXPECT_EQ(at(50), 3e-7);
    EXPECT_EQ(at(100), 0.0);
    EXPECT_EQ(at(150), -3e-7);
    for (std::size_t i = 0; i < 200; ++i) EXPECT_EQ(at(i), sine.displacement[i]);
  }
}

TEST(Excitation, TriangleIsStraightBetweenTheSameExtremes) {
  const Excitation triangle = MakeExcitation(
      {.waveform = Waveform::kTriangle, .amplitude = 1.0, .cycles = 1, .samples_per_cycle = 8});
  EXPECT_EQ(triangle.displacement, (std::vector<double>{0, 0.5, 1, 0.5, 0, -0.5, -1, -0.5, 0}));
}

TEST(Excitation, GrowingSineGrowsByTheFactorAsked) {
  const Excitation growing = MakeExcitation({.waveform = Waveform::kGrowingSine,
                                             .amplitude = 5.0,
                                             .cycles = 4,
                                             .samples_per_cycle = 100,
                                             .growth = 20.0});
  constexpr double kRounding = 1e-14;
  EXPECT_EQ(growing.envelope.back(), 5.0);
  EXPECT_NEAR(growing.envelope.front(), 0.25, kRounding);
  EXPECT_NEAR(growing.envelope[200], 5.0 / std::sqrt(20.0), kRounding);  // geometric
  for (std::size_t i = 0; i < growing.displacement.size(); ++i) {
    EXPECT_LE(std::abs(growing.displacement[i]), growing.envelope[i]);
  }
  EXPECT_EQ(growing.displacement[325], growing.envelope[325]);
}

TEST(Excitation, RejectsValuesOutOfRange) {
  EXPECT_THROW(MakeExcitation({.amplitude = 0.0}), InvalidArgument);
  EXPECT_THROW(MakeExcitation({.amplitude = std::nan("")}), InvalidArgument);
  EXPECT_THROW(MakeExcitation({.amplitude = 1.0, .cycles = 0.0}), InvalidArgument);
  EXPECT_THROW(MakeExcitation({.amplitude = 1.0, .cycles = 1e9}), InvalidArgument);
  EXPECT_THROW(MakeExcitation({.amplitude = 1.0, .samples_per_cycle = 3}), InvalidArgument);
  EXPECT_THROW(MakeExcitation({.amplitude = 1.0, .frequency = -1.0}), InvalidArgument);
  EXPECT_THROW(MakeExcitation({.amplitude = 1.0, .growth = 0.5}), InvalidArgument);
}

TEST(Excitation, IsWithinItsBoundOfTheExactWave) {
  using Real = boost::multiprecision::cpp_bin_float_50;
  constexpr double kBound = 4 * std::numeric_limits<double>::epsilon();  // excitation.h
  constexpr double kGrowth = 37.0;
  const double grown = 1 + std::log(kGrowth);
  for (const std::size_t per_cycle : {4U, 7U, 200U, 1001U}) {
    const ExcitationOptions options{.waveform = Waveform::kGrowingSine,
                                    .amplitude = 1.7e-7,
                                    .cycles = 3,
                                    .samples_per_cycle = per_cycle,
                                    .growth = kGrowth};
    ExcitationOptions steady = options;
    steady.waveform = Waveform::kSine;
    const Excitation growing = MakeExcitation(options);
    const Excitation sine = MakeExcitation(steady);
    const std::size_t steps = 3 * per_cycle;
    for (std::size_t i = 0; i <= steps; ++i) {
      const Real wave =
          Real(1.7e-7) * sin(2 * boost::math::constants::pi<Real>() * Real(i) / Real(per_cycle));
      const Real envelope = pow(Real(kGrowth), Real(Real(i) / Real(steps) - 1));
      EXPECT_NEAR(static_cast<double>(Real(sine.displacement[i]) - wave), 0.0, kBound * 1.7e-7);
      EXPECT_NEAR(static_cast<double>(Real(growing.displacement[i]) - wave * envelope), 0.0,
                  kBound * grown * 1.7e-7);
    }
  }
}

}  // namespace
}  // namespace mindahl::models::excitation_test
