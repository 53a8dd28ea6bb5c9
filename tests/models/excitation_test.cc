#include "mindahl/models/excitation.h"

#include <boost/math/constants/constants.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/random/mersenne_twister.hpp>

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

/// Samples at the times (2k + 1)/4f; the samples in a cycle are a multiple of 4.
std::vector<double> AtExtremes(const std::vector<double>& values, std::size_t per_cycle) {
  std::vector<double> extremes;
  for (std::size_t i = per_cycle / 4; i < values.size(); i += per_cycle / 2) {
    extremes.push_back(values[i]);
  }
  return extremes;
}

TEST(Excitation, RandomTurnsBackTwiceACycleAndReachesItsAmplitude) {
  for (double cycles = 0.25; cycles < 21; cycles += 0.25) {
    for (const std::uint64_t seed : {0U, 1U, 2U, 3U, 4U}) {
      const Excitation random = MakeExcitation({.waveform = Waveform::kRandom,
                                                .amplitude = 3e-7,
                                                .cycles = cycles,
                                                .samples_per_cycle = 40,
                                                .seed = seed});
      EXPECT_EQ(random.displacement.front(), 0.0);
      EXPECT_EQ(Largest(random.displacement), 3e-7);
      EXPECT_EQ(random.envelope, std::vector<double>(random.displacement.size(), 3e-7));
      // No sample lies beyond the extremes on either side of it.
      for (std::size_t i = 10; i + 20 < random.displacement.size(); i += 20) {
        for (std::size_t j = i; j < i + 20; ++j) {
          const double step = random.displacement[j + 1] - random.displacement[j];
          EXPECT_GE(step * (random.displacement[i + 20] - random.displacement[i]), 0.0);
        }
      }
      const std::vector<double> extremes = AtExtremes(random.displacement, 40);
      for (std::size_t k = 2; k < extremes.size(); ++k) {
        EXPECT_LT((extremes[k] - extremes[k - 1]) * (extremes[k - 1] - extremes[k - 2]), 0.0);
      }
    }
  }
}

TEST(Excitation, RandomIsThatOfItsSeedOnEveryPlatform) {
  const auto random = [](std::uint64_t seed) {
    return MakeExcitation({.waveform = Waveform::kRandom, .amplitude = 1.0, .seed = seed})
        .displacement;
  };
  EXPECT_EQ(random(1), random(1));
  EXPECT_NE(random(1), random(2));
  // The top bit of the generator's first number is the direction of the first step.
  for (std::uint64_t seed = 0; seed < 64; ++seed) {
    boost::random::mt19937_64 engine(~seed);
    EXPECT_EQ(random(seed)[1] > 0, engine() >> 63 == 1) << seed;
  }
}

TEST(Excitation, NestedExtremesCloseEveryLoopOnReturn) {
  for (double cycles = 0.25; cycles < 21; cycles += 0.25) {
    const Excitation nested = MakeExcitation({.waveform = Waveform::kNested,
                                              .amplitude = 5.0,
                                              .cycles = cycles,
                                              .samples_per_cycle = 40});
    EXPECT_EQ(nested.displacement.front(), 0.0);
    EXPECT_EQ(Largest(nested.displacement), 5.0);
    const std::vector<double> extremes = AtExtremes(nested.displacement, 40);
    const auto size = [&](std::size_t k) { return std::abs(extremes[k]); };
    const std::size_t innermost = extremes.size() / 2;
    for (std::size_t k = 0; k < extremes.size(); ++k) {
      EXPECT_EQ(extremes[k] > 0, k % 2 == 0);
      if (k == 0) continue;
      if (k <= innermost) {
        EXPECT_LT(size(k), size(k - 1));
      } else {
        EXPECT_GT(size(k), size(k - 1));
        EXPECT_GT(size(k), size(2 * innermost - k)) << "does not close its loop";
        EXPECT_EQ(std::signbit(extremes[k]), std::signbit(extremes[2 * innermost - k]));
      }
    }
  }
}

TEST(Excitation, NamesAreThoseOfTheCommandLine) {
  EXPECT_EQ(FindWaveform("sine"), Waveform::kSine);
  EXPECT_EQ(FindWaveform("triangle"), Waveform::kTriangle);
  EXPECT_EQ(FindWaveform("growing-sine"), Waveform::kGrowingSine);
  EXPECT_EQ(FindWaveform("random"), Waveform::kRandom);
  EXPECT_EQ(FindWaveform("nested"), Waveform::kNested);
  EXPECT_FALSE(FindWaveform("square").has_value());
  EXPECT_FALSE(FindWaveform("").has_value());
  EXPECT_EQ(WaveformNames().size(), 5U);
}

TEST(Excitation, RejectsValuesOutOfRange) {
  EXPECT_THROW(MakeExcitation({.amplitude = 0.0}), InvalidArgument);
  EXPECT_THROW(MakeExcitation({.amplitude = std::nan("")}), InvalidArgument);
  EXPECT_THROW(MakeExcitation({.amplitude = 1.0, .cycles = 0.0}), InvalidArgument);
  EXPECT_THROW(MakeExcitation({.amplitude = 1.0, .cycles = 1e9}), InvalidArgument);
  EXPECT_THROW(MakeExcitation({.amplitude = 1.0, .samples_per_cycle = 3}), InvalidArgument);
  EXPECT_THROW(
      MakeExcitation({.amplitude = 1.0, .cycles = 1e-9, .samples_per_cycle = 2'000'000'000}),
      InvalidArgument);
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
