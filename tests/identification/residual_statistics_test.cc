

#include "identification/diagnosis/residuals.h"
#include "support/prelude.h"

namespace mindahl::identification::residual_statistics_test {
namespace {

using Series = std::vector<std::vector<double>>;

// A handful of additions and a division: a few roundings.
constexpr double kRounding = 1e-15;

ResidualStatistics Describe(const Series& residuals, const Series& forces) {
  std::vector<RecordFit> records;
  for (const std::vector<double>& residual : residuals) {
    RecordFit& record = records.emplace_back();
    record.residual = residual;
    record.counts.assign(residual.size(), 1);
  }
  const std::vector<std::span<const double>> measured(forces.begin(), forces.end());
  return DescribeResiduals(records, measured);
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

}  // namespace
}  // namespace mindahl::identification::residual_statistics_test
