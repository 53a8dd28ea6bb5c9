#include "mindahl/identification/mapping_validation.h"

#include "support/prelude.h"

namespace mindahl::identification::mapping_validation_test {
namespace {

TEST(MappingValidation, LoopsOfEitherLawReturnTheContactAtEveryAmplitude) {
  // Dahl's own law on the steady part, through its own mapping: σ = 8a/G*, α = 1/3 and Tc = μN once
  // more, while its own σ is up to 2^{1/3} smaller.
  ValidationOptions options;
  options.cases = 28;
  options.seed = 77;
  options.noise_levels = {0.0, 0.01};
  const ValidationReport report = ValidateMapping(options);
  EXPECT_EQ(report.fits, 2 * options.cases * options.noise_levels.size()) << "by either law";
  EXPECT_EQ(report.failures, 0u) << ::testing::PrintToString(report.failed_cases);
  ASSERT_EQ(report.rows.size(), options.lambdas.size() * options.noise_levels.size());
  ASSERT_EQ(report.dahl_rows.size(), report.rows.size());
  std::size_t cases = 0;
  for (std::size_t i = 0; i < report.rows.size(); ++i) {
    EXPECT_EQ(report.dahl_rows[i].lambda, report.rows[i].lambda);
    EXPECT_EQ(report.dahl_rows[i].noise, report.rows[i].noise);
    EXPECT_EQ(report.dahl_rows[i].cases, report.rows[i].cases);
    cases += report.rows[i].cases;
    for (const ValidationRow& row : {report.rows[i], report.dahl_rows[i]}) {
      EXPECT_LE(row.errors[1].median, row.errors[1].worst);
      if (row.noise > 0) {
        EXPECT_GT(row.worst_standardized, 0.0);
        EXPECT_GT(row.errors[0].median, 1e-5) << "the loops are fitted, not copied";
        continue;
      }
      for (const auto& error : row.errors) EXPECT_LE(error.worst, NoiseFreeTolerance(row.lambda));
      EXPECT_EQ(row.undetermined, 0u);
    }
  }
  EXPECT_EQ(cases, options.cases * options.noise_levels.size());
}

TEST(MappingValidation, SameSeedGivesTheSameReportAndAnotherSeedAnother) {
  ValidationOptions options;
  options.cases = 2;
  options.noise_levels = {0.01};
  const auto worst = [&](std::uint64_t seed) {
    options.seed = seed;
    return ValidateMapping(options).rows[0].errors[0].worst;
  };
  EXPECT_EQ(worst(1), worst(1));
  EXPECT_NE(worst(1), worst(2));
}

TEST(MappingValidation, CoverageOfHonestIntervalsPasses) {
  ValidationOptions options;
  options.cases = 300;
  options.noise_levels = {0.01};
  options.lambdas = {1.2, 2.0};
  const ValidationReport honest = ValidateMapping(options);
  EXPECT_TRUE(honest.passed()) << ::testing::PrintToString(honest.failed_coverages);
  ASSERT_EQ(honest.coverage.size(), 2 * kValidatedParameters.size()) << "two laws";
  for (const CoverageVerdict& verdict : honest.coverage) {
    EXPECT_EQ(verdict.all.intervals, options.cases) << verdict.parameter;
    EXPECT_EQ(verdict.sliding.intervals, options.cases) << verdict.parameter;
  }
}

TEST(MappingValidation, ChancesOfACountAreThoseOfTheBinomialLaw) {
  // Of three intervals: P(at most 1) = 0.07³ + 3·0.93·0.07², P(all) = 0.97³.
  const IntervalCount one{.intervals = 3, .covering = 1};
  EXPECT_NEAR(one.ChanceOfSoFew(), 0.07 * 0.07 * 0.07 + 3 * 0.93 * 0.07 * 0.07, 1e-15);
  const IntervalCount all{.intervals = 3, .covering = 3};
  EXPECT_NEAR(all.ChanceOfSoMany(), 0.97 * 0.97 * 0.97, 1e-15);
  // Of 1000, intervals twice as wide as they should be, 99.99 %, are seen.
  EXPECT_LT((IntervalCount{.intervals = 1000, .covering = 1000}).ChanceOfSoMany(), 1e-12);
  EXPECT_EQ(IntervalCount().ChanceOfSoFew(), 1.0);
  EXPECT_EQ(IntervalCount().ChanceOfSoMany(), 1.0);
  EXPECT_EQ((IntervalCount{.intervals = 3, .covering = 0}).ChanceOfSoMany(), 1.0);
}

TEST(MappingValidation, OptionsOutOfRangeAreRefused) {
  const auto refuses = [](auto spoil) {
    ValidationOptions options;
    options.cases = 1;
    spoil(options);
    EXPECT_THROW(ValidateMapping(options), InvalidArgument);
  };
  refuses([](ValidationOptions& o) { o.cases = 0; });
  refuses([](ValidationOptions& o) { o.lambdas.clear(); });
  refuses([](ValidationOptions& o) { o.lambdas = {-1}; });
  refuses([](ValidationOptions& o) { o.noise_levels.clear(); });
  refuses([](ValidationOptions& o) { o.noise_levels = {-0.1}; });
}

}  // namespace
}  // namespace mindahl::identification::mapping_validation_test
