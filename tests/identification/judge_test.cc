#include "identification/judge/judge.h"

#include "support/prelude.h"

// Verdicts from estimates and findings alone, by precedence.
namespace mindahl::identification::judge_test {
namespace {

ParameterEstimate Known(const char* name) {
  return {.name = name,
          .unit = "-",
          .value = 2.0,
          .standard_error = 0.1,
          .lower95 = 1.8,
          .upper95 = 2.2,
          .status = ParameterStatus::kFree};
}

struct Verdict {
  FindingCode code;
  Identifiability verdict;
};

/// What each finding says of the parameters that it names, as docs/contract.md has it.
constexpr auto kVerdicts = std::to_array<Verdict>({
    {"no_model_fits", Identifiability::kNotIdentifiable},
    {"energy_contradiction", Identifiability::kNotIdentifiable},
    {"undetermined_parameter", Identifiability::kNotIdentifiable},
    {"undetermined_combination", Identifiability::kNotIdentifiable},
    {"sigma_not_identifiable", Identifiability::kNotIdentifiable},
    {"alpha_not_identifiable", Identifiability::kNotIdentifiable},
    {"slip_force_not_identifiable", Identifiability::kNotIdentifiable},
    {"shape_or_rig", Identifiability::kNotIdentifiable},
    {"slip_force_bounded_below", Identifiability::kBoundedBelow},
    {"sigma_bounded_below", Identifiability::kBoundedBelow},
    {"systematic_residual", Identifiability::kIdentifiable},
});

TEST(Judge, VerdictsAreInTheOrderOfPrecedence) {
  using enum Identifiability;
  EXPECT_GT(kNotIdentifiable, kBoundedBelow);
  EXPECT_GT(kBoundedBelow, kExtrapolated);
  EXPECT_GT(kExtrapolated, kEffective);
  EXPECT_GT(kEffective, kIdentifiable);
}

Identifiability JudgedWith(ParameterEstimate estimate, std::vector<Finding> findings) {
  Judge({&estimate, 1}, findings);
  return estimate.identifiability;
}

TEST(Judge, FindingSetsTheVerdictOnWhatItNamesOnly) {
  for (const auto& [code, verdict] : kVerdicts) {
    std::array estimates = {Known("sigma"), Known("alpha"), Known("slip_force")};
    const Finding finding{.code = code, .parameters = {"alpha"}};
    Judge(estimates, {&finding, 1});
    EXPECT_EQ(estimates[1].identifiability, verdict) << code.row().code;
    EXPECT_EQ(estimates[0].identifiability, Identifiability::kIdentifiable) << code.row().code;
    EXPECT_EQ(estimates[2].identifiability, Identifiability::kIdentifiable) << code.row().code;
  }
}

TEST(Judge, OfTwoFindingsTheWorseHoldsInEitherOrder) {
  for (const auto& [one, verdict_of_one] : kVerdicts) {
    for (const auto& [other, verdict_of_other] : kVerdicts) {
      const Finding first{.code = one, .parameters = {"sigma", "alpha"}};
      const Finding second{.code = other, .parameters = {"alpha"}};
      const Identifiability worse = std::max(verdict_of_one, verdict_of_other);
      EXPECT_EQ(JudgedWith(Known("alpha"), {first, second}), worse)
          << one.row().code << ", " << other.row().code;
      EXPECT_EQ(JudgedWith(Known("alpha"), {second, first}), worse)
          << one.row().code << ", " << other.row().code;
      EXPECT_EQ(JudgedWith(Known("sigma"), {second, first}), verdict_of_one) << one.row().code;
    }
  }
}

TEST(Judge, FindingWithoutParametersChangesNone) {
  for (const auto& [code, verdict] : kVerdicts) {
    EXPECT_EQ(JudgedWith(Known("alpha"), {{.code = code}}), Identifiability::kIdentifiable)
        << code.row().code;
  }
  EXPECT_EQ(JudgedWith(Known("alpha"), {{.code = "weights_not_settled"}}),
            Identifiability::kIdentifiable);
}

TEST(Judge, FixedParameterIsIdentifiableWhateverTheFindings) {
  ParameterEstimate held = Known("alpha");
  held.status = ParameterStatus::kFixed;
  held.standard_error = held.lower95 = held.upper95 = std::nullopt;
  EXPECT_EQ(JudgedWith(held, {{.code = "undetermined_parameter", .parameters = {"alpha"}}}),
            Identifiability::kIdentifiable);
}

TEST(Judge, OpenIntervalIsALimitAndNoIntervalIsNothing) {
  ParameterEstimate open = Known("slip_force");
  open.upper95.reset();
  EXPECT_EQ(JudgedWith(open, {}), Identifiability::kBoundedBelow);
  EXPECT_EQ(JudgedWith(open, {{.code = "no_model_fits", .parameters = {"slip_force"}}}),
            Identifiability::kNotIdentifiable);
  EXPECT_EQ(JudgedWith(open, {{.code = "systematic_residual", .parameters = {"slip_force"}}}),
            Identifiability::kBoundedBelow)
      << "a finding makes nothing better";
  open.lower95.reset();
  EXPECT_EQ(JudgedWith(open, {}), Identifiability::kNotIdentifiable);
  // At a bound there is an interval and no error.
  ParameterEstimate at_bound = Known("alpha");
  at_bound.status = ParameterStatus::kAtLowerBound;
  at_bound.standard_error.reset();
  EXPECT_EQ(JudgedWith(at_bound, {}), Identifiability::kIdentifiable);
}

TEST(Judge, IntervalThatIncludesTheDiscrepancyIsEffective) {
  ParameterEstimate estimate = Known("slip_force");
  estimate.includes_discrepancy = true;
  EXPECT_EQ(JudgedWith(estimate, {}), Identifiability::kEffective);
  EXPECT_EQ(
      JudgedWith(estimate, {{.code = "slip_force_not_identifiable", .parameters = {"slip_force"}}}),
      Identifiability::kNotIdentifiable)
      << "a wide one is no answer";
  estimate.upper95.reset();
  EXPECT_EQ(JudgedWith(estimate, {}), Identifiability::kBoundedBelow);
}

TEST(Judge, EarlierVerdictIsForgotten) {
  ParameterEstimate estimate = Known("alpha");
  estimate.identifiability = Identifiability::kNotIdentifiable;
  EXPECT_EQ(JudgedWith(estimate, {}), Identifiability::kIdentifiable);
}

std::vector<std::string> KeptOf(std::span<const ParameterEstimate> estimates,
                                std::vector<Finding> findings) {
  std::vector<std::string> kept;
  for (const Finding& finding : WithoutNeedless(estimates, std::move(findings)))
    kept.emplace_back(finding.code);
  return kept;
}

TEST(WithoutNeedless, KeepsAWideIntervalUnlessAnotherFindingSaysAsMuchOfIt) {
  const std::array estimates = {Known("sigma"), Known("alpha"), Known("slip_force")};
  const Finding wide{.code = "alpha_not_identifiable", .parameters = {"alpha"}, .kind = "wide"};
  const Finding rig{.code = "shape_or_rig", .parameters = {"sigma", "alpha"}};
  const Finding law{.code = "law_undecided", .parameters = {"alpha"}};
  const Finding of_other{.code = "few_places", .parameters = {"sigma"}};
  EXPECT_THAT(KeptOf(estimates, {wide}), ElementsAre("alpha_not_identifiable"));
  EXPECT_THAT(KeptOf(estimates, {wide, rig}), ElementsAre("shape_or_rig"));
  EXPECT_THAT(KeptOf(estimates, {rig, wide}), ElementsAre("shape_or_rig")) << "in either order";
  EXPECT_THAT(KeptOf(estimates, {wide, of_other}),
              ElementsAre("alpha_not_identifiable", "few_places"));
  EXPECT_THAT(KeptOf(estimates, {law, wide}),
              ElementsAre("law_undecided", "alpha_not_identifiable"))
      << "which calls α identifiable";
}

TEST(WithoutNeedless, KeepsAnEnergyThatContradictsAnAnswer) {
  std::array estimates = {Known("sigma"), Known("alpha"), Known("slip_force")};
  const Finding energy{.code = "energy_contradiction",
                       .parameters = {"sigma", "alpha", "slip_force"}};
  const Finding shape{.code = "no_model_fits", .parameters = {"sigma", "alpha"}};
  EXPECT_THAT(KeptOf(estimates, {shape, energy}),
              ElementsAre("no_model_fits", "energy_contradiction"))
      << "the slip force is still claimed";
  estimates[2].upper95.reset();
  EXPECT_THAT(KeptOf(estimates, {shape, energy}), ElementsAre("no_model_fits"));
}

TEST(WithoutNeedless, KeepsAnOpenSlipForceUnlessItsIntervalIncludesTheDiscrepancy) {
  std::array estimates = {Known("sigma"), Known("alpha"), Known("slip_force")};
  const Finding open{.code = "slip_force_bounded_below", .parameters = {"slip_force"}};
  EXPECT_THAT(KeptOf(estimates, {open}), ElementsAre("slip_force_bounded_below"));
  estimates[2].includes_discrepancy = true;
  EXPECT_THAT(KeptOf(estimates, {open}), ElementsAre());
}

TEST(WithoutInadequate, IsNeverReportedWithZeroMisfit) {
  // No omitted term explains it, and what comes back in every stroke is 0.8 of the variance.
  FitResult result;
  result.rms = 3.0;
  result.records.resize(1);
  result.records[0].structure.repeatable_share = 0.8;
  result.findings = {{.code = "no_model_fits", .parameters = {"sigma", "alpha"}}};
  result = WithoutInadequate(std::move(result), {});
  EXPECT_EQ(result.adequacy.verdict, AdequacyVerdict::kInadequate);
  EXPECT_NEAR(result.adequacy.misfit, 3.0 * std::sqrt(0.8), 1e-12);
  EXPECT_NEAR(result.adequacy.misfit_over_noise, std::sqrt(0.8 / 0.2), 1e-12);
  EXPECT_LE(result.adequacy.p_value, Thresholds().repeat_chance);
}

}  // namespace
}  // namespace mindahl::identification::judge_test
