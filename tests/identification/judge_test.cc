#include "identification/diagnosis/adequacy.h"
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
    {"undetermined_parameter", Identifiability::kNotIdentifiable},
    {"undetermined_combination", Identifiability::kNotIdentifiable},
    {"sigma_not_identifiable", Identifiability::kNotIdentifiable},
    {"alpha_not_identifiable", Identifiability::kNotIdentifiable},
    {"slip_force_not_identifiable", Identifiability::kNotIdentifiable},
    {"slip_force_bounded_below", Identifiability::kBoundedBelow},
    {"loop_not_seen", Identifiability::kNotIdentifiable},
    {"reversals_uncertain", Identifiability::kIdentifiable},
});

TEST(Judge, VerdictsAreInTheOrderOfPrecedence) {
  using enum Identifiability;
  EXPECT_GT(kNotIdentifiable, kBoundedBelow);
  EXPECT_GT(kBoundedBelow, kEffective);
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
  EXPECT_EQ(JudgedWith(open, {{.code = "loop_not_seen", .parameters = {"slip_force"}}}),
            Identifiability::kNotIdentifiable);
  EXPECT_EQ(JudgedWith(open, {{.code = "reversals_uncertain", .parameters = {"slip_force"}}}),
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

}  // namespace
}  // namespace mindahl::identification::judge_test
