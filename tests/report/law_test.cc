
#include <nlohmann/json.hpp>

#include "mindahl/report/report.h"
#include "report/made_report.h"
#include "support/prelude.h"

// Masing's law or Dahl's own, in the JSON and in the text.
namespace mindahl::report::law_test {
namespace {

using nlohmann::json;

/// σ three quarters of the fitted, so that a is three quarters and ρ 27/64.
identification::LawChoice Undecided() {
  return {.decided = false,
          .preferred = nullptr,
          .alternative = models::FindFrictionModel("dahl"),
          .law = {0.75 * kSigma, 1.0 / 3, 1.25 * kSlipForce},
          .delta_aicc = std::nullopt,
          .likelihood_ratio = std::nullopt};
}

ReportInput InputOf(const identification::LawChoice& choice) {
  ReportInput input = MadeInput();
  input.fit.law_choice = choice;
  return input;
}

/// Of steel on steel under a load.
ReportInput WithBodies(ReportInput input) {
  for (auto* body : {&input.known.body_1, &input.known.body_2}) {
    body->youngs_modulus = contact::UncertainValue{210e9};
    body->poisson_ratio = contact::UncertainValue{0.3};
  }
  input.known.normal_load = contact::UncertainValue{50.0};
  return input;
}

json LawOf(ReportInput input) { return json::parse(ToJson(MakeReport(std::move(input))))["law"]; }

TEST(Law, ThatIsUndecidedHasTheOthersNumbers) {
  const json law = LawOf(InputOf(Undecided()));
  EXPECT_EQ(law["decided"], false);
  EXPECT_TRUE(law["preferred"].is_null());
  EXPECT_TRUE(law["delta_aicc"].is_null());
  EXPECT_TRUE(law["likelihood_ratio"].is_null());
  ASSERT_EQ(law["alternatives"].size(), 1U);
  EXPECT_EQ(law["alternatives"][0], json({{"law", "dahl"},
                                          {"sigma", 0.75 * kSigma},
                                          {"alpha", 1.0 / 3},
                                          {"slip_force", 1.25 * kSlipForce}}));
}

TEST(Law, ReportsContactUnderTheAlternativeLaw) {
  const Report report = MakeReport(WithBodies(InputOf(Undecided())));
  const json whole = json::parse(ToJson(report));
  const json& other = whole["law"]["alternatives"][0];
  const json& contact = whole["contact"];
  EXPECT_DOUBLE_EQ(other["contact_radius"].get<double>(),
                   0.75 * contact["contact_radius"]["value"].get<double>());
  EXPECT_DOUBLE_EQ(other["equivalent_radius"].get<double>(),
                   0.75 * 0.75 * 0.75 * contact["equivalent_radius"]["value"].get<double>());
  const std::string text = ToText(report);
  EXPECT_THAT(text, AllOf(HasSubstr("law:  sigma and slip_force are for Masing's law"),
                          HasSubstr("distinguish from it"), HasSubstr("30 N/µm"), HasSubstr("50 N"),
                          HasSubstr("contact radius"), HasSubstr("equivalent")));
}

TEST(Law, ThatIsDecidedNamesTheOneThatIsPreferred) {
  identification::LawChoice choice = Undecided();
  choice.decided = true;
  choice.delta_aicc = 250.0;
  choice.likelihood_ratio = 248.0;
  choice.preferred = models::FindFrictionModel("mindlin-dahl");
  const json law = LawOf(InputOf(choice));
  EXPECT_EQ(law["decided"], true);
  EXPECT_EQ(law["preferred"], "mindlin-dahl");
  EXPECT_EQ(law["delta_aicc"], 250.0);
  EXPECT_EQ(law["likelihood_ratio"], 248.0);
  EXPECT_THAT(ToText(MakeReport(InputOf(choice))),
              HasSubstr("law:  Masing's law, not Dahl's own law (ΔAICc = 250)"));

  choice.preferred = choice.alternative;
  choice.delta_aicc = -250.0;
  EXPECT_EQ(LawOf(InputOf(choice))["preferred"], "dahl");
  EXPECT_THAT(ToText(MakeReport(InputOf(choice))), HasSubstr("--model dahl"));
}

TEST(Law, ThatWasNotLookedForIsNullWithTheReason) {
  const Report report = MakeReport(MadeInput());
  const json whole = json::parse(ToJson(report));
  EXPECT_TRUE(whole["law"]["decided"].is_null());
  EXPECT_TRUE(whole["law"]["alternatives"].empty());
  bool said = false;
  for (const json& null : whole["nulls"]) said = said || null["path"] == "law.decided";
  EXPECT_TRUE(said);
  EXPECT_THAT(ToText(report), Not(HasSubstr("law:  ")));
}

}  // namespace
}  // namespace mindahl::report::law_test
