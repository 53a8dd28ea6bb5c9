#include "mindahl/models/excitation.h"

#include <boost/math/constants/constants.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/random/mersenne_twister.hpp>

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

TEST(Excitation, SineIsASine) {
  constexpr double kRounding = 1e-15;
  const Excitation sine =
      MakeExcitation({.amplitude = 2.0, .cycles = 1.5, .samples_per_cycle = 90, .frequency = 4.0});
  ASSERT_EQ(sine.displacement.size(), 136U);
  for (std::size_t i = 0; i < sine.time.size(); ++i) {
    EXPECT_NEAR(sine.time[i], static_cast<double>(i) / 360, kRounding);
    EXPECT_NEAR(sine.displacement[i], 2 * std::sin(2 * std::numbers::pi * 4.0 * sine.time[i]),
                20 * kRounding);  // the argument of this one is rounded, to 1e-15 of 10
    EXPECT_EQ(sine.envelope[i], 2.0);
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

double Largest(const std::vector<double>& values) {
  double largest = 0.0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return largest;
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

TEST(Excitation, RandomExtremesAreUniformBeyondTheLast) {
  constexpr std::size_t kCycles = 20'000;
  const Excitation random = MakeExcitation(
      {.waveform = Waveform::kRandom, .amplitude = 1.0, .cycles = kCycles, .samples_per_cycle = 4});
  const std::vector<double> extremes = AtExtremes(random.displacement, 4);
  ASSERT_EQ(extremes.size(), 2 * kCycles);
  std::vector<double> shares;  // of the way from the last extreme to the bound
  for (std::size_t k = 1; k < extremes.size(); ++k) {
    const double bound = extremes[k] > extremes[k - 1] ? 1.0 : -1.0;
    shares.push_back((extremes[k] - extremes[k - 1]) / (bound - extremes[k - 1]));
  }
  std::ranges::sort(shares);
  // Kolmogorov: sup |F_n − F| exceeds 1.95/√n with probability 1e-3. That the largest is scaled to
  // 1 shifts a share by some 1/n.
  const auto count = static_cast<double>(shares.size());
  const double tolerance = 2 / std::sqrt(count);
  for (std::size_t i = 0; i < shares.size(); ++i) {
    ASSERT_NEAR(shares[i], (static_cast<double>(i) + 0.5) / count, tolerance);
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

TEST(Excitation, NestedExtremesFallAndGrowByEqualSteps) {
  constexpr double kRounding = 1e-15;
  const auto extremes = [](double cycles) {
    return AtExtremes(MakeExcitation({.waveform = Waveform::kNested,
                                      .amplitude = 1.0,
                                      .cycles = cycles,
                                      .samples_per_cycle = 8})
                          .displacement,
                      8);
  };
  const auto expect_equal = [](const std::vector<double>& actual, std::vector<double> expected) {
    ASSERT_EQ(actual.size(), expected.size());
    for (std::size_t k = 0; k < actual.size(); ++k) EXPECT_NEAR(actual[k], expected[k], kRounding);
  };
  expect_equal(extremes(1), {1.0, -1.0 / 3});
  expect_equal(extremes(2), {1.0, -3.0 / 7, 1.0 / 7, -5.0 / 7});
  expect_equal(extremes(2.25), {7.0 / 9, -3.0 / 9, 1.0 / 9, -5.0 / 9, 1.0});
}

TEST(Excitation, NestedEnvelopeTouchesTheExtremesAndIsNowhereExceeded) {
  const Excitation nested = MakeExcitation(
      {.waveform = Waveform::kNested, .amplitude = 5.0, .cycles = 7.5, .samples_per_cycle = 1000});
  for (std::size_t i = 0; i < nested.displacement.size(); ++i) {
    EXPECT_LE(std::abs(nested.displacement[i]), nested.envelope[i]);
    if (i % 500 == 250) {
      EXPECT_EQ(std::abs(nested.displacement[i]), nested.envelope[i]);
    }
  }
}

TEST(Excitation, GrowthOfOneIsTheSine) {
  const ExcitationOptions sine{.amplitude = 5.0, .cycles = 2};
  ExcitationOptions growing = sine;
  growing.waveform = Waveform::kGrowingSine;
  growing.growth = 1.0;
  EXPECT_EQ(MakeExcitation(growing).displacement, MakeExcitation(sine).displacement);
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
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(MakeExcitation({.amplitude = 0.0}), InvalidArgument);
  EXPECT_THROW(MakeExcitation({.amplitude = nan}), InvalidArgument);
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

TEST(Excitation, HalfCosinesAreWithinTheirBound) {
  using Real = boost::multiprecision::cpp_bin_float_50;
  constexpr double kBound = 6 * std::numeric_limits<double>::epsilon();  // excitation.h
  constexpr std::size_t kFine = 4004;
  for (const Waveform waveform : {Waveform::kRandom, Waveform::kNested}) {
    const Excitation made = MakeExcitation(
        {.waveform = waveform, .amplitude = 1.7e-7, .cycles = 5, .samples_per_cycle = kFine});
    const std::vector<double> extremes = AtExtremes(made.displacement, kFine);
    for (std::size_t k = 0; k + 1 < extremes.size(); ++k) {
      for (std::size_t i = 0; i <= kFine / 2; ++i) {
        const Real angle = boost::math::constants::pi<Real>() * Real(2 * i) / Real(kFine);
        const Real exact = (Real(extremes[k]) + Real(extremes[k + 1])) / 2 +
                           (Real(extremes[k]) - Real(extremes[k + 1])) / 2 * cos(angle);
        const double actual = made.displacement[kFine / 4 + k * kFine / 2 + i];
        ASSERT_NEAR(static_cast<double>(Real(actual) - exact), 0.0, kBound * 1.7e-7);
      }
    }
  }
}

// The noise of a record and its random waveform are drawn with one seed.
TEST(Excitation, RandomDoesNotRepeatTheNumbersOfTheNoise) {
  constexpr std::size_t kCycles = 20'000;
  const std::vector<double> extremes = AtExtremes(MakeExcitation({.waveform = Waveform::kRandom,
                                                                  .amplitude = 1.0,
                                                                  .cycles = kCycles,
                                                                  .samples_per_cycle = 4,
                                                                  .seed = 7})
                                                      .displacement,
                                                  4);
  boost::random::mt19937_64 engine(7);
  double sum = 0.0;
  for (const double extreme : extremes) {
    sum += extreme * (std::ldexp(static_cast<double>(engine()), -63) - 1);
  }
  // Each term has mean 0 and variance at most 1/3; four standard deviations of the sum.
  const auto count = static_cast<double>(extremes.size());
  EXPECT_LT(std::abs(sum), 4 * std::sqrt(count / 3));
}

}  // namespace
}  // namespace mindahl::models::excitation_test
