#include "mindahl/identification/mapping_validation.h"

#include "support/prelude.h"

namespace mindahl::identification::mapping_validation_test {
namespace {

TEST(MappingValidation, LoopsReturnTheContactAtEveryAmplitude) {
  const ValidationOptions options{.cases = 28, .seed = 77};
  const ValidationReport report = ValidateMapping(options);
  EXPECT_THAT(report.failed_cases, IsEmpty());
  ASSERT_EQ(report.rows.size(), kLambdas.size() * kNoiseLevels.size());
  std::size_t cases = 0;
  std::size_t intervals = 0;
  std::size_t covering = 0;
  for (const ValidationRow& row : report.rows) {
    cases += row.cases;
    if (row.noise > 0) {
      EXPECT_GT(row.worst_standardized, 0.0);
      EXPECT_GT(row.errors[0], 1e-3 * row.noise) << "the loops are fitted, not copied";
      intervals += row.intervals;
      covering += row.covering;
      continue;
    }
    for (const double error : row.errors) EXPECT_LE(error, row.lambda >= 0.5 ? 1e-8 : 1e-6);
    EXPECT_EQ(row.undetermined, 0u);
  }
  EXPECT_EQ(cases, options.cases * kNoiseLevels.size());
  // The number of 95 % intervals that miss the truth exceeds np + 4√(3npq) once in 30 000 runs; the
  // factor 3 allows for the correlation of the three intervals of a fit.
  const auto count = static_cast<double>(intervals);
  EXPECT_GT(intervals, 50u);
  EXPECT_LE(count - static_cast<double>(covering),
            0.05 * count + 4 * std::sqrt(3 * 0.05 * 0.95 * count));
}

TEST(MappingValidation, SameSeedGivesTheSameReportAndAnotherSeedAnother) {
  const auto worst = [](std::uint64_t seed) {
    return ValidateMapping({.cases = 2, .seed = seed}).rows[kLambdas.size()].errors[0];
  };
  EXPECT_EQ(worst(1), worst(1));
  EXPECT_NE(worst(1), worst(2));
}

TEST(MappingValidation, NoCaseIsRefused) {
  EXPECT_THROW(ValidateMapping({.cases = 0}), InvalidArgument);
}

}  // namespace
}  // namespace mindahl::identification::mapping_validation_test
