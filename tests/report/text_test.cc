

#include "mindahl/report/report.h"
#include "report/made_report.h"
#include "report/style.h"
#include "support/prelude.h"

namespace mindahl::report::text_test {
namespace {

using identification::Identifiability;
using mindahl::testing::MadeInput;

TEST(Text, BeginsWithSummaryFollowedByEvidence) {
  const std::string text = ToText(MakeReport(MadeInput()));
  const std::size_t parameters = text.find("\nparameter ");
  const std::size_t contact = text.find("\ncontact (Mindlin-Dahl mapping)");
  const std::size_t measured = text.find("\nmeasured: ");
  const std::size_t mapping = text.find("\nis it Mindlin's contact?");
  EXPECT_LT(parameters, contact);
  EXPECT_LT(contact, measured);
  EXPECT_LT(measured, mapping);
  EXPECT_LT(mapping, text.size());
}

/// The first lines of a text.
std::string Screen(const std::string& text, std::size_t lines) {
  std::size_t end = 0;
  for (std::size_t line = 0; line < lines && end < text.size(); ++line) {
    end = std::min(text.find('\n', end), text.size() - 1) + 1;
  }
  return text.substr(0, end);
}

/// A doubtful fit that is of use, with eight more terms than the law has.
ReportInput DoubtfulInput() {
  ReportInput input = MadeInput();
  identification::Adequacy& adequacy = input.fit.adequacy;
  adequacy.verdict = identification::AdequacyVerdict::kDoubtful;
  adequacy.use = identification::Use::kQuantitative;
  adequacy.tried = 21;
  adequacy.p_value = 1e-4;
  adequacy.misfit = 1.2;
  adequacy.misfit_over_half_gap = 0.03;
  for (const auto& [code, option] :
       {std::pair("viscous_force", "--viscous fit"), std::pair("running_in", "--slip-trend fit")}) {
    identification::Cause& cause = adequacy.causes.emplace_back();
    cause.code = code;
    cause.option = option;
    cause.explains = 0.3;
  }
  for (const char* name : {"plateau_slope", "viscous", "slip_slope", "slip_curvature", "slip_trend",
                           "plateau_curvature", "force_offset", "displacement_offset"}) {
    input.fit.parameters.push_back(mindahl::testing::MadeParameter(name, "N", 1.0, 0.01));
  }
  const std::size_t count = input.fit.parameters.size();
  input.fit.correlation.assign(count * count, 0.0);
  for (identification::ParameterEstimate& estimate : input.fit.parameters) {
    estimate.includes_discrepancy = true;
    estimate.identifiability = Identifiability::kEffective;
  }
  input.known.tangential_compliance = 4.2e-11;
  input.known.normal_load = 100.0;
  return input;
}

TEST(Text, OfAUsableFitHasVerdictUseParametersContactAndNextStepOnTheFirstScreen) {
  constexpr std::size_t kLines = 24;  // of a terminal
  const std::string text = ToText(MakeReport(DoubtfulInput()));
  const std::string screen = Screen(text, kLines);
  for (const char* shown : {"doubtful, quantitative: ", "(3 % of the half gap)",
                            "\nnext: ", "--viscous fit", "\nsigma ", "\nalpha ", "\nslip_force ",
                            "\ncontact (Mindlin-Dahl mapping)", "\nfriction coefficient"}) {
    EXPECT_THAT(screen, HasSubstr(shown));
  }
  for (const char* later : {"\nslip_trend ", "\nor like ", "\nmeasured: ", "\nresiduals"}) {
    EXPECT_THAT(screen, Not(HasSubstr(later)));
    EXPECT_THAT(text, HasSubstr(later));
  }
}

TEST(Text, OfAFitThatIsOfNoUseHasTenLines) {
  constexpr std::ptrdiff_t kLines = 10;
  ReportInput input = DoubtfulInput();
  input.fit.adequacy.verdict = identification::AdequacyVerdict::kInadequate;
  input.fit.adequacy.use = identification::Use::kNone;
  input.fit.adequacy.misfit_over_half_gap = 1.7;
  for (identification::ParameterEstimate& estimate : input.fit.parameters) {
    estimate.includes_discrepancy = false;
    estimate.identifiability = Identifiability::kNotIdentifiable;
  }
  const std::string text = ToText(MakeReport(std::move(input)));
  EXPECT_LE(std::ranges::count(text, '\n'), kLines) << text;
  EXPECT_THAT(text, StartsWith("inadequate"));
  for (const char* shown :
       {"(170 % of the", "\nnext: ", "--viscous fit", "\nmeasured: ", "\nreversals: "}) {
    EXPECT_THAT(text, HasSubstr(shown));
  }
  EXPECT_THAT(text, Not(HasSubstr("slip_force")));
}

TEST(Text, HasParametersInUnitsThatSuitThem) {
  ReportInput input = MadeInput();  // 4e7 ± 4e5 N/m, 40 ± 0.4 N
  EXPECT_THAT(ToText(MakeReport(std::move(input))),
              ::testing::AllOf(HasSubstr("40.00 ± 0.40 N/µm"), HasSubstr("40.00 ± 0.40 N ")));
}

TEST(Text, HasNoValueOfUnidentifiableParameters) {
  ReportInput input = MadeInput();
  input.fit.parameters[2].identifiability = Identifiability::kNotIdentifiable;
  input.fit.parameters[2].standard_error.reset();
  const std::string text = ToText(MakeReport(std::move(input)));
  EXPECT_THAT(text, Not(HasSubstr("40.00 ± 0.40 N ")));
  EXPECT_THAT(text, Not(HasSubstr("3Tc/(2σ)")));  // a length that Tc is in
}

TEST(Text, NamesWhatIsOpenAndWhatIsHeld) {
  ReportInput input = MadeInput();
  input.fit.parameters[1].status = identification::ParameterStatus::kFixed;
  input.fit.parameters[1].standard_error.reset();
  input.fit.parameters[2].identifiability = Identifiability::kNotIdentifiable;
  input.fit.parameters[2].standard_error.reset();
  const std::string text = ToText(MakeReport(std::move(input)));
  const auto after = [&](std::string_view words) {
    const std::size_t at = text.find(words);
    return at == std::string::npos ? "" : text.substr(at + words.size(), 12);
  };
  EXPECT_THAT(after("not identifiable: "), StartsWith("slip_force"));
  EXPECT_THAT(after("fixed, not fitted: "), StartsWith("alpha"));
}

TEST(Text, HasNoContactIfStiffnessIsOpen) {
  ReportInput input = MadeInput();
  input.known.tangential_compliance = 4.2e-11;
  input.known.normal_load = 100.0;
  const std::string known = ToText(MakeReport(input));
  EXPECT_THAT(known, HasSubstr("\ncontact radius"));
  input.fit.parameters[0].identifiability = Identifiability::kNotIdentifiable;
  const std::string open = ToText(MakeReport(std::move(input)));
  for (const char* of_sigma : {"\ncontact radius", "\nmaximum pressure", "3Tc/(2σ)"}) {
    EXPECT_THAT(open, Not(HasSubstr(of_sigma)));
  }
  EXPECT_THAT(open, HasSubstr("\nfriction coefficient"));
  EXPECT_THAT(open, HasSubstr("not identified: everything that follows from sigma"));
}

TEST(Text, SaysInOneLineWhatWouldTellMoreOfTheContact) {
  const std::string text = ToText(MakeReport(MadeInput()));
  EXPECT_THAT(text, HasSubstr("with the normal load, E and ν of both bodies given, more would be "
                              "known: friction coefficient"));
}

TEST(Text, AsksForNoInputThatIsGiven) {
  // With the load the friction coefficient lacks the slip force, which no input gives.
  ReportInput input = MadeInput();
  input.known.normal_load = 50.0;
  input.fit.parameters[2].identifiability = identification::Identifiability::kBoundedBelow;
  const std::string text = ToText(MakeReport(std::move(input)));
  const std::size_t at = text.find("more would be known:");
  ASSERT_NE(at, std::string::npos);
  EXPECT_EQ(text.find("friction coefficient", at), std::string::npos) << text;
}

TEST(Text, SaysWhyAnIntervalIsFarWiderThanItsErrorMakesIt) {
  const auto text_of = [](double times, bool gap_is_lower_end) {
    ReportInput input = MadeInput();
    identification::ParameterEstimate& slip_force = input.fit.parameters[2];
    slip_force.lower95 = slip_force.value - times * 1.96 * *slip_force.standard_error;
    slip_force.upper95 = slip_force.value + times * 1.96 * *slip_force.standard_error;
    input.fit.adequacy.verdict = identification::AdequacyVerdict::kDoubtful;
    input.fit.adequacy.tried = 1;
    input.fit.adequacy.causes.push_back(
        {.code = "channel_lag", .unit = "s", .option = "--lag fit"});
    slip_force.interval = {{.source = identification::IntervalSource::kOmittedTerms,
                            .lower = slip_force.lower95,
                            .upper = slip_force.upper95}};
    const double half_gap = gap_is_lower_end ? *slip_force.lower95 : 20.0;
    if (gap_is_lower_end) {
      slip_force.interval.push_back({identification::IntervalSource::kPlateau, half_gap, half_gap});
    }
    input.fit.records[0].facts.half_gap = half_gap;
    return ToText(MakeReport(std::move(input)));
  };
  EXPECT_THAT(text_of(50, false),
              HasSubstr("the intervals of slip_force are extended to include the effect of omitted "
                        "terms\n"));
  EXPECT_THAT(text_of(50, true), HasSubstr("the effect of omitted terms and the measured\n"
                                           "  half gap, 800 mN\n"));
  EXPECT_THAT(text_of(2, false), Not(HasSubstr("are extended")));
}

TEST(Text, OfAnOpenShapeHasNoSlipOfMindlins) {
  ReportInput input = MadeInput();
  EXPECT_THAT(ToText(MakeReport(MadeInput())), HasSubstr("gross slip (α = 1/3)"));
  input.fit.parameters[1].identifiability = identification::Identifiability::kNotIdentifiable;
  EXPECT_THAT(ToText(MakeReport(std::move(input))), Not(HasSubstr("gross slip (α = 1/3)")));
}

TEST(Text, ReportsMissingLoopFirst) {
  ReportInput input = MadeInput();
  input.fit.adequacy.verdict = identification::AdequacyVerdict::kInadequate;
  input.fit.adequacy.tried = 1;
  input.fit.findings = {{.code = "loop_not_seen",
                         .parameters = {"sigma", "alpha", "slip_force"},
                         .numbers = {{"r_squared", 0.031}}}};
  EXPECT_THAT(ToText(MakeReport(std::move(input))),
              StartsWith("inadequate: the force shows no loop, since the model explains only 3.1 % "
                         "of its variance;"));
}

TEST(Text, HasNoChanceThatIsZero) {
  ReportInput input = MadeInput();
  identification::ParameterEstimate& alpha = input.fit.parameters[1];
  alpha.value = 0.5;
  alpha.lower95 = 0.48;
  alpha.upper95 = 0.52;
  identification::MindlinTest& test = input.fit.mindlin_test.emplace();
  test.likelihood_ratio = 5340.0;
  test.p_value = 0.0;
  EXPECT_THAT(ToText(MakeReport(std::move(input))),
              HasSubstr("likelihood ratio of α = 1/3: 5.34e+03, p < 1e-12"));
}

TEST(Text, HasColoursOnlyWhereAskedFor) {
  const Report report = MakeReport(MadeInput());
  EXPECT_THAT(ToText(report), Not(HasSubstr("\x1b[")));
  EXPECT_THAT(ToText(report, {.has_colours = true}), HasSubstr("\x1b["));
}

TEST(Wrapped, KeepsANumberWithItsErrorAndItsUnit) {
  const std::string words(94, 'x');
  EXPECT_EQ(Wrapped(words + " 1.5 ± 0.2 mm", 2), words + "\n  1.5 ± 0.2 mm\n");
  EXPECT_EQ(Wrapped(words + " 0.15 %", 2), words + "\n  0.15 %\n");
  EXPECT_EQ(Wrapped(words + " of mms", 2), words + " of\n  mms\n");
}

}  // namespace
}  // namespace mindahl::report::text_test
