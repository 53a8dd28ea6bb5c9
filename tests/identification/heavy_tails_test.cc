

#include "identification/inference/irregularities.h"
#include "identification/inference/noise.h"
#include "support/histories.h"
#include "support/prelude.h"

// Readings that are far off, counted by hand.
namespace mindahl::identification::heavy_tails_test {
namespace {

TEST(FindHeavyTails, OfOneStrayHaveTheChanceOfOneOrMore) {
  constexpr std::size_t kSamples = 206;
  constexpr double kChance = 1e-5;  // that a reading is so far off
  testing::Generator generator(3);
  std::vector<FittedSample> samples;
  for (std::size_t i = 0; i < kSamples; ++i) {
    samples.push_back({.response = 1e-3 * static_cast<double>(i),
                       .residual = testing::Normal(generator),
                       .counts = true});
  }
  samples[100].residual = 40.0;
  const auto count = static_cast<double>(kSamples);
  const std::optional<IrregularityFit> fit = FindHeavyTails(samples, Evidence(kSamples, count));
  ASSERT_TRUE(fit);
  EXPECT_DOUBLE_EQ(fit->size, 1 / count);
  // The three samples at either end, where the record turns, are not looked at.
  EXPECT_NEAR(fit->p_value / -std::expm1(-kChance * (count - 6)), 1.0, 1e-9);
}

}  // namespace
}  // namespace mindahl::identification::heavy_tails_test
