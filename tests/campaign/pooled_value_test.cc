

#include "mindahl/campaign/test_summary.h"
#include "support/histories.h"
#include "support/prelude.h"

namespace mindahl::campaign::pooled_value_test {
namespace {

TEST(PooledValue, OfOneIsThatOne) {
  PooledValue pooled;
  pooled.Add(0.3, 0.02);
  EXPECT_EQ(pooled.count(), 1U);
  EXPECT_DOUBLE_EQ(pooled.mean(), 0.3);
  EXPECT_DOUBLE_EQ(pooled.standard_error(), 0.02);
  EXPECT_EQ(pooled.scatter(), 0.0);
  EXPECT_EQ(pooled.p_value(), 1.0);
}

TEST(PooledValue, WeighsByErrors) {
  // w = 1, 4: mean (1 + 4·2)/5, Q = 4/5·(2 − 1)² = 0.8 < 1: no scatter; of χ²₁, erfc(√0.4).
  PooledValue pooled;
  pooled.Add(1.0, 1.0);
  pooled.Add(2.0, 0.5);
  EXPECT_DOUBLE_EQ(pooled.mean(), 1.8);
  EXPECT_DOUBLE_EQ(pooled.standard_error(), std::sqrt(0.2));
  EXPECT_EQ(pooled.scatter(), 0.0);
  EXPECT_NEAR(pooled.p_value(), std::erfc(std::sqrt(0.4)), 1e-14);
}

TEST(PooledValue, ReportsScatterBeyondTheErrors) {
  // Equal errors e: Q = Σ(y − ȳ)²/e² = 8, τ² = (8 − 1)·e²/(2 − 1), e(ȳ)² = e²/2 + τ²/2.
  PooledValue pooled;
  pooled.Add(0.0, 1.0);
  pooled.Add(4.0, 1.0);
  EXPECT_DOUBLE_EQ(pooled.mean(), 2.0);
  EXPECT_DOUBLE_EQ(pooled.scatter(), std::sqrt(7.0));
  EXPECT_DOUBLE_EQ(pooled.standard_error(), 2.0);
}

TEST(PooledValue, LosesNoDigitsToALargeMean) {
  PooledValue pooled;
  constexpr double kMean = 1e9;
  for (int k = 0; k < 1000; ++k) pooled.Add(kMean + (k % 2 == 0 ? 1.0 : -1.0), 0.5);
  EXPECT_DOUBLE_EQ(pooled.mean(), kMean);
  // Q = 4000, τ² = (4000 − 999)/(4·999).
  EXPECT_NEAR(pooled.scatter(), std::sqrt(3001.0 / 3996.0), 1e-12);
}

// Over campaigns of 50 cycles whose errors differ by ten times.
TEST(PooledValue, HasTheErrorThatItsMeanHas) {
  constexpr int kCampaigns = 400;
  for (const double scatter : {0.0, 0.05}) {
    double squares = 0.0;
    double between = 0.0;
    int few = 0;
    for (int k = 0; k < kCampaigns; ++k) {
      Generator generator(static_cast<std::uint64_t>(k));
      PooledValue pooled;
      for (int i = 0; i < 50; ++i) {
        const double error = testing::LogUniform(generator, 0.01, 0.1);
        pooled.Add(scatter * Normal(generator) + error * Normal(generator), error);
      }
      squares += std::pow(pooled.mean() / pooled.standard_error(), 2);
      between += pooled.scatter() * pooled.scatter();
      few += pooled.p_value() < 0.01 ? 1 : 0;
    }
    // A mean of 400 squares of standard normal deviates, to four of its deviations √(2/400).
    EXPECT_NEAR(squares / kCampaigns, 1.0, 4 * std::sqrt(2.0 / kCampaigns)) << scatter;
    if (scatter == 0) {
      EXPECT_LE(few, 4 + 3 * 2);  // one in a hundred, and three deviations
    } else {
      EXPECT_EQ(few, kCampaigns);
      EXPECT_NEAR(std::sqrt(between / kCampaigns), scatter, 0.1 * scatter);
    }
  }
}

TEST(PooledValue, RefusesWhatHasNoWeight) {
  PooledValue pooled;
  EXPECT_THROW(pooled.Add(1.0, 0.0), InvalidArgument);
  EXPECT_THROW(pooled.Add(std::numeric_limits<double>::quiet_NaN(), 1.0), InvalidArgument);
}

}  // namespace
}  // namespace mindahl::campaign::pooled_value_test
