
#include <nlohmann/json.hpp>

#include "mindahl/report/report.h"
#include "report/made_report.h"
#include "support/prelude.h"

// The backbone without a law, as a table and in words.
namespace mindahl::report::backbone_test {
namespace {

using identification::BackboneEstimate;

BackboneEstimate Made() {
  BackboneEstimate backbone;
  backbone.points = {{.displacement = 0.0, .force = {}, .law = 0.0},
                     {.displacement = 5e-7, .force = {10.0, 9.5, 10.5}, .law = 10.25},
                     {.displacement = 1e-6, .force = {16.0, 15.5, 16.5}, .law = 17.0}};
  backbone.first_stiffness = {3e7, 2.5e7, 3.5e7};
  backbone.elastic = {1e6, 0.0, 2e6};
  return backbone;
}

std::string TextOf(const BackboneEstimate& backbone) {
  return BackboneText(backbone, MadeInput().fit, kUnitsOfForce);
}

TEST(BackboneCsv, HasTheConfidenceBandAndTheLaw) {
  EXPECT_EQ(BackboneCsv(Made(), kUnitsOfForce),
            "displacement [m],force [N],lower95 [N],upper95 [N],law [N]\n"
            "0,0,0,0,0\n"
            "4.9999999999999998e-07,10,9.5,10.5,10.25\n"
            "9.9999999999999995e-07,16,15.5,16.5,17\n");
}

TEST(BackboneJson, IsThereWhereItWasAskedFor) {
  EXPECT_FALSE(nlohmann::json::parse(ToJson(MakeReport(MadeInput()))).contains("backbone"));
  ReportInput input = MadeInput();
  input.backbone = Made();
  const auto backbone = nlohmann::json::parse(ToJson(MakeReport(std::move(input))))["backbone"];
  EXPECT_EQ(backbone["first_stiffness"]["value"], 3e7);
  EXPECT_EQ(backbone["elastic"]["ci95"][1], 2e6);
  EXPECT_EQ(backbone["reaches_plateau"], false);
  ASSERT_EQ(backbone["points"].size(), 3U);
  EXPECT_EQ(backbone["points"][2]["ci95"][0], 15.5);
  EXPECT_EQ(backbone["points"][2]["law"], 17.0);
}

TEST(BackboneText, NamesTheNearestLaw) {
  EXPECT_THAT(TextOf(Made()), AllOf(HasSubstr("first hundredth 30 N/µm (25 … 35)"),
                                    HasSubstr("force at 1 µm: 16 N (15.5 … 16.5)"),
                                    HasSubstr("sigma = 40 N/µm, alpha = 0.333, slip_force = 40 N"),
                                    HasSubstr("leaves the band at 1 of 3 displacements")));
}

TEST(BackboneText, HasFourDigitsOfTheLastDisplacement) {
  BackboneEstimate backbone = Made();
  backbone.points.back().displacement = 1.23456e-6;
  EXPECT_THAT(TextOf(backbone), HasSubstr("force at 1.235 µm: "));
}

TEST(BackboneText, CountsALawOnEitherSideOfTheBand) {
  BackboneEstimate backbone = Made();
  backbone.points[1].law = 9.25;
  EXPECT_THAT(TextOf(backbone), HasSubstr("leaves the band at 2 of 3 displacements"));
}

TEST(BackboneText, SaysThatTheSlipForceIsTheLawsUnlessThereIsAPlateau) {
  BackboneEstimate backbone = Made();
  EXPECT_THAT(TextOf(backbone), HasSubstr("slip_force is the law's extrapolation"));
  backbone.reaches_plateau = true;
  EXPECT_THAT(TextOf(backbone),
              AllOf(HasSubstr("levels off within the record"), Not(HasSubstr("extrapolation"))));
}

TEST(BackboneText, OfATorqueIsInItsUnits) {
  const std::string text = BackboneText(Made(), MadeInput().fit, kUnitsOfTorque);
  EXPECT_THAT(text, AllOf(HasSubstr("N m/rad"), HasSubstr("force at 1 µrad: 16 N m")));
}

TEST(BackboneText, SaysThatItsBranchesAreNoCopiesWhereTheirMemoryIsNotMasings) {
  using identification::MemoryVerdict;
  for (const MemoryVerdict verdict : {MemoryVerdict::kMasing, MemoryVerdict::kDahl,
                                      MemoryVerdict::kNeither, MemoryVerdict::kUndecided}) {
    identification::FitResult fit = MadeInput().fit;
    fit.memory.emplace().verdict = verdict;
    const bool is_denied = verdict == MemoryVerdict::kDahl || verdict == MemoryVerdict::kNeither;
    EXPECT_EQ(BackboneText(Made(), fit, kUnitsOfForce).find("not of Masing's memory") !=
                  std::string::npos,
              is_denied);
  }
  EXPECT_THAT(TextOf(Made()), Not(HasSubstr("memory")));
}

}  // namespace
}  // namespace mindahl::report::backbone_test
