#include "identification/diagnosis/diagnosis.h"

#include "identification/stages.h"
#include "support/prelude.h"

// Findings from results made by hand.
namespace mindahl::identification::diagnosis_test {
namespace {

/// Far below slip.
FitResult Made() { return testing::MadeFit(/*peak_force=*/2.0); }

TEST(FindMisfit, IsOfTheForceThatWasMeasuredAndNotOfTheLaws) {
  FitResult result = Made();
  result.residuals.rms = 0.06;
  result.records[0].structure.repeatable_share = 0.8;
  for (const double slip_force : {10.0, 0.1}) {
    result.law.slip_force = slip_force;
    const auto far_from_slip = FindMisfit(result, {});
    ASSERT_TRUE(far_from_slip);
    EXPECT_DOUBLE_EQ(*far_from_slip->Number("misfit"), 0.06 / 2.0);
    EXPECT_DOUBLE_EQ(*far_from_slip->Number("repeatable_share"), 0.8);
  }
  loop::LoopFacts& facts = result.records[0].facts;
  facts.closed = true;
  facts.peak_force = 2.0;
  facts.energy_ratio = 0.8;
  facts.half_gap = 1.5;
  EXPECT_DOUBLE_EQ(*FindMisfit(result, {})->Number("misfit"), 0.06 / 1.5)
      << "of a loop that slides";
  result.records[0] = {};
  EXPECT_FALSE(FindMisfit(result, {}));
}

TEST(FindMisfit, SaysWhereItIsLargestAndWhomItConcerns) {
  FitResult result = Made();
  result.residuals.rms = 0.1;
  ResidualStructure& structure = result.records[0].structure;
  structure.repeatable_share = 0.8;
  structure.directions[0].direction = 1;
  structure.directions[1].direction = -1;
  structure.directions[0].bins = {{0.1, 0.2, 0}, {0.6, -0.3, 0}};
  structure.directions[1].bins = {{0.1, 0.1, 0}, {0.6, -0.7, 0}};
  const auto poor = FindMisfit(result, {});
  ASSERT_TRUE(poor);
  EXPECT_EQ(poor->code, "systematic_residual");
  EXPECT_TRUE(poor->parameters.empty());
  EXPECT_EQ(poor->Number("largest"), 0.7);
  EXPECT_EQ(poor->Number("position"), 0.6);
  EXPECT_EQ(poor->Number("direction"), -1.0);
  structure.directions[0].bins[0].mean = 0.9;
  EXPECT_EQ(FindMisfit(result, {})->Number("direction"), 1.0);
  result.residuals.rms = 0.5;
  const auto failing = FindMisfit(result, {});
  EXPECT_EQ(failing->code, "no_model_fits");
  EXPECT_THAT(failing->parameters, ElementsAre("sigma", "alpha"));
}

TEST(FindOpenSlipForce, NamesTheShapeToo) {
  FitResult result = Made();
  EXPECT_TRUE(FindOpenSlipForce(result, {.open_above = false}).empty());
  auto findings = FindOpenSlipForce(result, {.open_above = true});
  ASSERT_EQ(findings.size(), 2U);
  EXPECT_EQ(findings[0].code, "slip_force_bounded_below");
  EXPECT_EQ(findings[0].Number("peak_force"), 2.0);
  EXPECT_EQ(findings[0].Number("amplitude"), 1e-6);
  EXPECT_THAT(findings[0].parameters, ElementsAre("slip_force"));
  EXPECT_EQ(findings[1].code, "alpha_not_identifiable");
  EXPECT_EQ(findings[1].kind, "with_slip_force");
  EXPECT_THAT(findings[1].parameters, ElementsAre("alpha"));
  result.records[0].facts.closed = true;
  result.records[0].facts.peak_force = 1.75;
  result.records[0].facts.amplitude = 0.5e-6;
  findings = FindOpenSlipForce(result, {.open_above = true});
  EXPECT_EQ(findings[0].Number("peak_force"), 1.75) << "as the report has it";
  EXPECT_EQ(findings[0].Number("amplitude"), 0.5e-6);
  result.parameters[1].status = ParameterStatus::kFixed;
  EXPECT_EQ(FindOpenSlipForce(result, {.open_above = true}).size(), 1U);
}

}  // namespace
}  // namespace mindahl::identification::diagnosis_test
