#include "identification/diagnosis/diagnosis.h"

#include "identification/stages.h"
#include "support/prelude.h"

// Findings from results made by hand.
namespace mindahl::identification::diagnosis_test {
namespace {

/// Far below slip.
FitResult Made() { return testing::MadeFit(/*peak_force=*/2.0); }

TEST(FindOpenSlipForce, NamesTheShapeToo) {
  FitResult result = Made();
  EXPECT_TRUE(FindOpenSlipForce(result).empty());
  result.parameters[2].upper95.reset();
  auto findings = FindOpenSlipForce(result);
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
  findings = FindOpenSlipForce(result);
  EXPECT_EQ(findings[0].Number("peak_force"), 1.75) << "as the report has it";
  EXPECT_EQ(findings[0].Number("amplitude"), 0.5e-6);
  result.parameters[1].status = ParameterStatus::kFixed;
  EXPECT_EQ(FindOpenSlipForce(result).size(), 1U);
}

}  // namespace
}  // namespace mindahl::identification::diagnosis_test
