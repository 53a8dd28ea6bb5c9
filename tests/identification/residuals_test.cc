

#include "identification/inference/noise.h"
#include "recovery/recovered.h"
#include "support/prelude.h"

namespace mindahl::identification::residuals_test {
namespace {

using Series = std::vector<std::vector<double>>;

// A handful of additions and a division: a few roundings.
constexpr double kRounding = 1e-15;

ResidualStatistics Describe(const Series& residuals, const Series& forces) {
  std::vector<RecordFit> records;
  for (std::size_t r = 0; r < residuals.size(); ++r) {
    RecordFit& record = records.emplace_back();
    record.residual = residuals[r];
    record.counts.assign(residuals[r].size(), 1);
    for (std::size_t i = 0; i < residuals[r].size(); ++i) {
      record.fitted_force.push_back(forces[r][i] + residuals[r][i]);
    }
  }
  return DescribeResiduals(records);
}

TEST(ResidualStatistics, AreThoseComputedByHand) {
  // r = 1, 2, −1, 0: Σr² = 6, Σ(Δr)² = 1 + 9 + 1 = 11; forces 0, 4, 8, 4: mean 4, Σ(T − 4)² = 32.
  const ResidualStatistics s = Describe(Series{{1, 2, -1, 0}}, Series{{0, 4, 8, 4}});
  EXPECT_EQ(s.samples, 4u);
  EXPECT_NEAR(s.rms, std::sqrt(6.0 / 4), kRounding);
  EXPECT_EQ(s.max_abs, 2.0);
  EXPECT_NEAR(s.r_squared, 1 - 6.0 / 32, kRounding);
  EXPECT_NEAR(s.durbin_watson, 11.0 / 6, kRounding);
}

TEST(ResidualStatistics, DifferencesAreTakenWithinARecordOnly) {
  // Across the join 1 → −1 the difference would add 4.
  const ResidualStatistics s = Describe(Series{{1, 1}, {-1, -1}}, Series{{0, 1}, {2, 3}});
  EXPECT_EQ(s.samples, 4u);
  EXPECT_EQ(s.durbin_watson, 0.0);
  // Forces 0 … 3 over both records: mean 3/2, Σ = 5.
  EXPECT_NEAR(s.r_squared, 1 - 4.0 / 5, kRounding);
}

TEST(ResidualStatistics, PerfectFitIsWhite) {
  const ResidualStatistics s = Describe(Series{{0, 0, 0}}, Series{{1, 2, 3}});
  EXPECT_EQ(s.rms, 0.0);
  EXPECT_EQ(s.r_squared, 1.0);
  EXPECT_EQ(s.durbin_watson, 2.0);
}

TEST(ResidualStatistics, ConstantForceExplainsNothing) {
  const ResidualStatistics s = Describe(Series{{1, -1}}, Series{{5, 5}});
  EXPECT_EQ(s.r_squared, 0.0);
}

// ---
// Tests that residuals which repeat in every stroke are distinguished from noise.

ResidualStructure StructureOf(const History& displacement, const std::vector<double>& residual) {
  const std::vector<std::size_t> reversals = FindReversals(displacement, 0.0);
  ScaledRecord record;
  record.displacement.assign(displacement.begin(), displacement.end());
  record.force.resize(displacement.size());
  record.counts.assign(displacement.size(), 1);
  record.reversals = reversals;
  return DescribeStructure(record, residual, {});
}

/// Residuals from displacement and direction of motion, +1 or −1, which the sample ends.
std::vector<double> ResidualsOf(const History& displacement,
                                const std::function<double(double, int)>& residual) {
  std::vector<double> values;
  int direction = 1;
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    if (i > 0 && displacement[i] != displacement[i - 1]) {
      direction = displacement[i] > displacement[i - 1] ? 1 : -1;
    }
    values.push_back(residual(displacement[i], direction));
  }
  return values;
}

TEST(ResidualStructure, NoiseRepeatsNothing) {
  // The F test finds something in noise in 0.1 % of the records: in more than 4 of 200 with a
  // probability of 2e-6.
  constexpr int kSeeds = 200;
  constexpr int kMost = 4;
  const History displacement = Cycling(Wave::kSine, 1.0, 4.0, 200);
  int found = 0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    Generator generator(static_cast<std::uint64_t>(seed));
    std::vector<double> residual;
    for (std::size_t i = 0; i < displacement.size(); ++i) residual.push_back(Normal(generator));
    if (StructureOf(displacement, residual).repeatable_share > 0) ++found;
  }
  EXPECT_LE(found, kMost);
}

TEST(ResidualStructure, ARippleOfAFewSamplesRepeats) {
  // 100 samples a stroke, and 13 periods in it.
  const History displacement = Cycling(Wave::kTriangle, 1.0, 4.0, 200);
  Generator generator(3);
  std::vector<double> residual;
  for (const double x : displacement) {
    residual.push_back(std::sin(13 * M_PI * x) + 0.3 * Normal(generator));
  }
  EXPECT_NEAR(StructureOf(displacement, residual).repeatable_share, 0.5 / (0.5 + 0.09), 0.05);
}

TEST(ResidualStructure, FractionIsVarianceThatRepeats) {
  // Triangles, so that every part of a stroke has as many samples. The variance of noise
  // over 2000 samples is known to √(2/2000) = 3 %.
  constexpr double kShareError = 0.05;
  const History displacement = Cycling(Wave::kTriangle, 1.0, 10.0, 200);
  for (const double noise : {0.1, 0.7, 2.0}) {
    Generator generator(7);
    double mean = 0.0;
    double squares = 0.0;
    std::vector<double> residual =
        ResidualsOf(displacement, [](double x, int) { return std::sin(3 * x); });
    for (double& value : residual) {
      mean += value / static_cast<double>(residual.size());
      squares += value * value / static_cast<double>(residual.size());
      value += noise * Normal(generator);
    }
    ASSERT_NEAR(mean, 0.0, 0.01);
    const ResidualStructure structure = StructureOf(displacement, residual);
    EXPECT_NEAR(structure.repeatable_share, squares / (squares + noise * noise), kShareError)
        << noise;
    // The way in and the way out are half strokes.
    EXPECT_EQ(structure.strokes, (std::array<std::size_t, 2>{9, 10}));
  }
}

TEST(ResidualStructure, WhatIsMissedBesideTheMainStrokesIsNoNoise) {
  // The way in, a quarter cycle of 50 samples and the turn, misses 10; the others have noise of 1,
  // known to √(2/750) = 5 %.
  constexpr double kShareError = 0.2;
  const History displacement = Cycling(Wave::kSine, 1.0, 4.0, 200);
  Generator generator(7);
  std::vector<double> residual;
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    residual.push_back(i < 50 ? 10.0 : Normal(generator));
  }
  const auto samples = static_cast<double>(residual.size());
  const double all = (50 * 100.0 + samples - 50) / samples;
  EXPECT_NEAR(StructureOf(displacement, residual).noise_share * all, 1.0, kShareError);
}

}  // namespace
}  // namespace mindahl::identification::residuals_test
