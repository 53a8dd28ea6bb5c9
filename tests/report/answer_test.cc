#include <sstream>

#include "mindahl/identification/finding.h"
#include "mindahl/identification/model_comparison.h"
#include "report/json.h"
#include "report/made_report.h"
#include "report/statements.h"
#include "support/prelude.h"

// Answers that would mislead, each made by hand: what a line says must not contradict another.
namespace mindahl::report::answer_test {
namespace {

using identification::AdequacyVerdict;
using identification::Finding;
using identification::Identifiability;
using identification::ParameterStatus;
using testing::MadeInput;
using testing::MadeParameter;

std::string Answer(const ReportInput& input) { return ToText(MakeReport(input)); }

std::string Details(const ReportInput& input) { return ToText(MakeReport(input), Detail::kAll); }

/// Returns a line by its label; "" where there is none.
std::string LineOf(const ReportInput& input, std::string_view label) {
  for (const Line& line : AnswerLines(MakeReport(input))) {
    if (line.label == label) return line.text;
  }
  return "";
}

loop::LoopFacts Facts(double half_gap) {
  loop::LoopFacts facts;
  facts.closed = true;
  facts.half_gap = half_gap;
  facts.half_gap_standard_deviation = 0.01 * half_gap;
  facts.amplitude = 2e-6;
  facts.peak_force = half_gap;
  facts.energy_per_cycle = 3.6 * 2e-6 * half_gap;
  facts.energy_ratio = 0.9;
  return facts;
}

TEST(Answer, SaysWhichMaterialsTheContactRadiusStillNeeds) {
  ReportInput input = MadeInput();
  input.known = {};
  EXPECT_THAT(LineOf(input, "stiffness"), Not(HasSubstr("needs")));
  input.known.body_1.youngs_modulus = 210e9;
  EXPECT_THAT(LineOf(input, "stiffness"),
              HasSubstr("a needs --poisson-1, --youngs-modulus-2, --poisson-2"));
  input.known.body_1.poisson_ratio = 0.3;
  input.known.body_2 = input.known.body_1;
  EXPECT_THAT(LineOf(input, "stiffness"), AllOf(HasSubstr(", a "), Not(HasSubstr("needs"))));
  input.known = {.tangential_compliance = 4e-11};
  input.known.body_1.youngs_modulus = 210e9;
  EXPECT_THAT(LineOf(input, "stiffness"), Not(HasSubstr("needs")));
}

ReportInput Doubtful() {
  ReportInput input = MadeInput();
  auto& adequacy = input.fit.adequacy;
  adequacy.verdict = AdequacyVerdict::kDoubtful;
  adequacy.use = identification::Use::kIndicative;
  adequacy.misfit = 2.0;
  adequacy.misfit_over_half_gap = 0.05;
  adequacy.p_value = 1.0;
  for (auto& estimate : input.fit.parameters) {
    estimate.identifiability = Identifiability::kEffective;
    estimate.includes_discrepancy = true;
  }
  input.fit.records[0].facts = Facts(40.0);
  return input;
}

ReportInput Inadequate() {
  ReportInput input = Doubtful();
  input.fit.adequacy.verdict = AdequacyVerdict::kInadequate;
  input.fit.adequacy.misfit_over_half_gap = 0.6;
  for (auto& estimate : input.fit.parameters) {
    estimate.identifiability = Identifiability::kNotIdentifiable;
    estimate.includes_discrepancy = false;
  }
  input.fit.findings = {
      {.code = "model_inadequate", .parameters = {"sigma", "alpha", "slip_force"}}};
  return input;
}

using testing::kSphereOnPlane;

TEST(Answer, NamesTheColumnsFirst) {
  ReportInput input = MadeInput();
  input.fit.force_sense = -1;
  input.records[0].displacement = {.name = "Position [mm]", .index = 3, .unit = "mm"};
  input.records[0].force = {.name = "", .index = 4, .unit = "N"};
  EXPECT_THAT(Answer(input),
              StartsWith("columns       loop_1.csv: displacement 'Position [mm]' (3), force (4, "
                         "opposite sign) in N\n"));
}

TEST(Answer, HasOneLineAQuantityWithItsIntervalAndNoOtherUncertainty) {
  ReportInput input = MadeInput();
  input.known.normal_load = 50.0;
  EXPECT_EQ(LineOf(input, "friction"),
            "μ 0.800 (0.784 … 0.816), Tc 40.00 N (39.20 … 40.80), at N = 50 N");
  EXPECT_THAT(LineOf(input, "stiffness"), StartsWith("σ 40.00 N/µm (39.20 … 40.80)"));
  EXPECT_THAT(LineOf(input, "shape"), StartsWith("α 0.333 (0.313 … 0.353), Mindlin's 1/3 fits"));
  EXPECT_THAT(Answer(input), Not(HasSubstr("Tc 40.00 N ±")));
}

TEST(Answer, OfATorqueHasItsUnitsAndNoContact) {
  ReportInput input = MadeInput();
  input.records[0].is_torsional = true;
  EXPECT_EQ(LineOf(input, "friction"), "Tc 40.00 N m (39.20 … 40.80)");
  EXPECT_EQ(LineOf(input, "stiffness"), "σ 40.00 MN m/rad (39.20 … 40.80)");
  EXPECT_EQ(LineOf(input, "shape"), "α 0.333 (0.313 … 0.353)");
}

TEST(Answer, DoesNotSayThatNoiseExplainsAMisfit) {
  EXPECT_THAT(Answer(Doubtful()), Not(HasSubstr("p = 1")));
  EXPECT_THAT(LineOf(Doubtful(), "misfit"), HasSubstr("5 % of the half gap"));
  EXPECT_THAT(LineOf(Doubtful(), "misfit"), HasSubstr("the intervals include it"));
  EXPECT_THAT(LineOf(MadeInput(), "misfit"), HasSubstr("like noise"));
}

TEST(Answer, OfAnInadequateModelSaysNothingOfParametersThatItDoesNotKnow) {
  for (const char* label : {"friction", "stiffness", "shape", "law"}) {
    EXPECT_EQ(LineOf(Inadequate(), label), "") << label;
  }
  ReportInput input = Inadequate();
  EXPECT_THAT(Answer(input),
              AllOf(HasSubstr("the law does not describe the record; use what is measured"),
                    HasSubstr("half gap 40.00 ± 0.40 N")));
  input.fit.parameters[2].identifiability = Identifiability::kEffective;
  EXPECT_THAT(LineOf(input, "friction"), StartsWith("Tc 40.00 N (39.20 … 40.80)"));
  EXPECT_THAT(LineOf(input, "misfit"), Not(HasSubstr("use what is measured")));
}

TEST(Answer, GivesAReasonInPlaceOfANumberOnce) {
  ReportInput input = MadeInput();
  for (auto& estimate : input.fit.parameters) {
    estimate.identifiability = Identifiability::kNotIdentifiable;
  }
  input.fit.findings = {
      {.code = "not_identifiable", .parameters = {"sigma", "alpha"}, .kind = "combination"}};
  const std::string text = Answer(input);
  EXPECT_THAT(LineOf(input, "stiffness"), HasSubstr("σ not determined: only a combination"));
  EXPECT_THAT(LineOf(input, "shape"), StartsWith("α not determined"));
  EXPECT_EQ(text.find("a combination"), text.rfind("a combination"));
  EXPECT_THAT(text, Not(HasSubstr("40.00 N/µm")));
}

TEST(Answer, OfALowerLimitHasThatAlone) {
  ReportInput input = MadeInput();
  input.known.normal_load = 50.0;
  auto& slip_force = input.fit.parameters[2];
  slip_force.identifiability = Identifiability::kBoundedBelow;
  slip_force.upper95.reset();
  input.fit.findings = {{.code = "bounded_below", .parameters = {"slip_force"}}};
  EXPECT_THAT(LineOf(input, "friction"),
              StartsWith("μ > 0.784, Tc > 39.2 N: the force does not level off"));
  input.fit.findings.front().kind = "slides";
  EXPECT_THAT(LineOf(input, "friction"), HasSubstr("keeps changing while the contact slides"));
}

/// An input whose slip force is effective and at a bound, under a known load.
ReportInput WithSlipForce(ParameterStatus status) {
  ReportInput input = MadeInput();
  input.known.normal_load = 50.0;
  input.fit.parameters[2].status = status;
  input.fit.parameters[2].identifiability = Identifiability::kEffective;
  return input;
}

TEST(Answer, OfALowerBoundSaysNoMoreOfWhatFollows) {
  const ReportInput input = WithSlipForce(ParameterStatus::kAtLowerBound);
  EXPECT_THAT(LineOf(input, "friction"), StartsWith("μ < 0.816, Tc < 40.8 N"));
}

TEST(Answer, OfAnUpperBoundHasTheIntervalOfWhatFollows) {
  ReportInput input = WithSlipForce(ParameterStatus::kAtUpperBound);
  auto& slip_force = input.fit.parameters[2];
  slip_force.upper95 = slip_force.value;
  EXPECT_THAT(LineOf(input, "friction"),
              HasSubstr("μ 0.8000 (0.7840 … 0.8000), Tc 40.00 N (39.20 … 40.00)"));
}

TEST(Answer, SaysThatAValueIsAtTheBoundThatWasGiven) {
  ReportInput input = WithSlipForce(ParameterStatus::kAtUpperBound);
  auto& slip_force = input.fit.parameters[2];
  slip_force.bounds = {0.0, slip_force.value};
  EXPECT_EQ(LineOf(input, "friction"), "Tc 40 N (at the bound that was given)");
  input.fit.adequacy.verdict = identification::AdequacyVerdict::kInadequate;
  input.fit.parameters[0].identifiability = Identifiability::kNotIdentifiable;
  input.fit.parameters[1].identifiability = Identifiability::kNotIdentifiable;
  EXPECT_THAT(LineOf(input, "misfit"), HasSubstr("; use what is measured"));
}

TEST(Answer, TestsNoThirdThatTheBoundsExclude) {
  ReportInput input = MadeInput();
  auto& alpha = input.fit.parameters[1];
  alpha.value = 0.4;
  alpha.lower95 = 0.4;
  alpha.upper95 = 0.41;
  alpha.status = ParameterStatus::kAtLowerBound;
  alpha.bounds = {0.4, 0.9};
  EXPECT_EQ(LineOf(input, "shape"),
            "α 0.4 (at the bound that was given), Mindlin's 1/3 is not tested");
  alpha.bounds = {0.3, 0.9};  // where the data alone exclude it
  alpha.status = ParameterStatus::kFree;
  EXPECT_THAT(LineOf(input, "shape"), HasSubstr("Mindlin's 1/3 is rejected"));
}

TEST(Answer, AsksForTheGainOfAnAmplitudeThatNoLoopHas) {
  ReportInput input = MadeInput();
  input.fit.records[0].facts.amplitude = 300.0;
  EXPECT_EQ(LineOf(input, "check"), "");
  input.records[0].displacement = {.name = "enc", .index = 2, .unit = "m", .has_no_unit = true};
  EXPECT_EQ(LineOf(input, "check"),
            "the displacement names no unit, and ±300 m is no loop: give its unit, or the gain of "
            "counts and volts, --displacement '#2*GAIN [m]'");
  EXPECT_THAT(LineOf(input, "columns"), HasSubstr("displacement 'enc' (2) in m (assumed)"));
}

TEST(Answer, ListsTheModelsThatWereCompared) {
  ReportInput input = MadeInput();
  const auto* const dahl = models::FindFrictionModel("dahl");
  input.compared = {{.model = dahl, .rig = true, .rms = 0.5, .delta_aicc = 70.0},
                    {.model = input.fit.model, .rms = 0.4, .held_out_rms = 0.45}};
  const std::string text = Answer(input);
  EXPECT_THAT(text, HasSubstr("\n  mindlin-dahl  no            0  0.4          0.45\n"
                              "  dahl          yes          70  0.5             -\n"));
  const Json rows = ComparedModels(MakeReport(input));
  ASSERT_THAT(rows, SizeIs(2));
  EXPECT_EQ(rows[0]["held_out_rms"], 0.45);
}

TEST(Answer, ShowsNoValueAtALimitOfTheSearch) {
  ReportInput input = MadeInput();
  input.fit.parameters.push_back(MadeParameter("slip_speed", "-", 1.0, 0.5));
  input.fit.parameters.back().status = ParameterStatus::kAtUpperBound;
  input.fit.parameters.back().identifiability = Identifiability::kNotIdentifiable;
  input.fit.findings = {{.code = "search_limit", .parameters = {"slip_speed"}}};
  EXPECT_THAT(LineOf(input, "terms"), StartsWith("slip_speed not determined: the search stopped"));
}

TEST(Answer, SaysOneThingOfTheLaw) {
  ReportInput input = MadeInput();
  identification::LawChoice choice;
  choice.alternative = models::FindFrictionModel("dahl");
  choice.law = {6e7, 0.5, 41.0};
  input.fit.law_choice = choice;
  EXPECT_EQ(LineOf(input, "law"), "Masing's; Dahl's own fits as well (σ 60 N/µm, Tc 41 N)");
  input.fit.law_choice->delta_aicc = -64.0;
  EXPECT_EQ(LineOf(input, "law"),
            "Masing's; Dahl's own fits better (σ 60 N/µm, Tc 41 N), unless the first stroke began "
            "at a turn that is not recorded");
  input.fit.law_choice->preferred = input.fit.model;
  EXPECT_EQ(LineOf(input, "law"), "Masing's, not Dahl's own");
}

TEST(Answer, PutsWhatCannotBeFirst) {
  ReportInput input = MadeInput();
  input.known = kSphereOnPlane;
  input.known.body_1.radius = 50.0;
  EXPECT_EQ(LineOf(input, "check"), "--radius-1 50 is 50 m: in mm it would be 50 mm");
  // 3N/(2πa²) is 239 GPa, and a quarter of it at twice the radius.
  input.known = {.normal_load = 50.0, .contact_radius = 1e-5};
  EXPECT_THAT(LineOf(input, "check"), HasSubstr("more than any solid bears"));
  input.known.contact_radius = 2e-5;
  EXPECT_EQ(LineOf(input, "check"), "");
  input.known = kSphereOnPlane;
  input.fit.law.tangential_stiffness *= 1e-3;  // µm read as mm
  input.fit.parameters[0].value *= 1e-3;
  input.records[0].displacement = {.name = "x", .index = 1, .unit = "mm"};
  EXPECT_THAT(Answer(input), StartsWith("check"));
  EXPECT_THAT(LineOf(input, "check"),
              HasSubstr(" times smaller than Hertz's: look at the unit of the displacement, mm"));
}

TEST(Answer, ChecksTheUnitsOfAFrictionThatNoContactHas) {
  ReportInput input = MadeInput();
  input.records[0].force.unit = "kN";
  for (const auto& [load, check] :
       {std::pair(4.0, "μ is 10: look at the unit of the force, kN, or of the load"),
        {8.1, ""},      // μ = 4.94
        {39000.0, ""},  // μ = 0.00103
        {8e4, "μ is 0.0005: look at the unit of the force, kN, or of the load"}}) {
    input.known.normal_load = load;
    EXPECT_EQ(LineOf(input, "check"), check) << load;
  }
  input.fit.parameters[2].identifiability = Identifiability::kBoundedBelow;
  EXPECT_EQ(LineOf(input, "check"), "") << "of a slip force that is a limit";
}

TEST(Answer, AsksForTheLoadsOfFilesWhoseHalfGapsDiffer) {
  ReportInput input =
      testing::MadeInput({testing::MadeRecord(2e-6), testing::MadeRecord(2e-6)}, 2e-6);
  input.fit.records[0].facts = Facts(10.0);
  input.fit.records[1].facts = Facts(60.0);
  input.next = testing::MadeStep("--terms viscous");
  input.fit.adequacy.verdict = identification::AdequacyVerdict::kAdequate;
  EXPECT_EQ(LineOf(input, "check"), "") << "of a partial and a full slip";
  input.fit.adequacy.verdict = identification::AdequacyVerdict::kInadequate;
  EXPECT_THAT(LineOf(input, "check"), HasSubstr("different loads? --normal-load N1,N2"));
  EXPECT_THAT(LineOf(input, "check"), HasSubstr("mindahl batch"));
  EXPECT_EQ(LineOf(input, "next"), "");
  input.fit.normal_load = 50.0;
  EXPECT_THAT(LineOf(input, "check"), HasSubstr("different loads?")) << "than the one for all";
}

TEST(Answer, AsksForTheOrderOfLoadsUnderWhichLoopsAsFullHaveOtherGaps) {
  ReportInput input =
      testing::MadeInput({testing::MadeRecord(2e-6), testing::MadeRecord(2e-6)}, 2e-6);
  input.fit.records[0].facts = Facts(10.0);
  input.fit.records[1].facts = Facts(60.0);
  for (auto& record : input.fit.records) record.facts.energy_ratio = 0.4;
  input.fit.records[0].normal_load = 120.0;
  input.fit.records[1].normal_load = 20.0;
  input.fit.normal_load = 70.0;
  input.fit.parameters.emplace_back().name = "load_exponent";
  input.fit.adequacy.verdict = identification::AdequacyVerdict::kDoubtful;
  EXPECT_THAT(LineOf(input, "check"), HasSubstr("half gaps over the loads from 0.0833 to 3"));
  input.fit.records[1].facts.energy_ratio = 0.6;
  EXPECT_EQ(LineOf(input, "check"), "") << "of loops that slip by less and by more";
  input.fit.records[1].facts.energy_ratio = 0.4;
  input.fit.records[1].normal_load = 600.0;
  EXPECT_EQ(LineOf(input, "check"), "") << "in proportion to the loads, within a factor of two";
}

TEST(Answer, NamesAModulusThatNoSolidHasBeforeTheUnitOfTheDisplacement) {
  ReportInput input = MadeInput();
  input.known = kSphereOnPlane;
  for (auto* body : {&input.known.body_1, &input.known.body_2}) body->youngs_modulus = 210e3;
  EXPECT_THAT(LineOf(input, "check"),
              StartsWith("Young's modulus of body 1 = 2.1e+05 Pa is below"));
}

TEST(Answer, OfALoadSeriesThatARigMayBendDoesNotRejectHertz) {
  ReportInput input = MadeInput();
  auto& exponent = testing::AddParameter(input.fit, "load_exponent", "-", 0.216, 0.002);
  EXPECT_THAT(LineOf(input, "load"), HasSubstr("Hertz's 1/3 is rejected"));
  exponent.upper95 = 0.334;
  input.fit.findings = {{.code = "shape_or_rig", .numbers = {{"rig_stiffness", 8e7}}}};
  EXPECT_THAT(LineOf(input, "load"), HasSubstr("Hertz's 1/3 fits in a compliant rig"));
  input.fit.parameters.back().upper95 = 0.3;
  EXPECT_THAT(LineOf(input, "load"), HasSubstr("Hertz's 1/3 is rejected"));
}

TEST(Answer, HasTheNextStepThatWasTried) {
  ReportInput input = Doubtful();
  input.next =
      testing::MadeStep("--terms slip_position", "a slip force that depends on the position");
  EXPECT_EQ(
      LineOf(input, "next"),
      "--terms slip_position: a slip force that depends on the position, misfit 20 % → 10 % of "
      "the half gap (tried)");
  EXPECT_EQ(LineOf(Doubtful(), "next"), "");
  input.next->is_over_amplitude = true;
  EXPECT_THAT(LineOf(input, "next"),
              HasSubstr("misfit 20 % of the half gap → 10 % of the amplitude (tried)"));
}

TEST(Answer, SaysOfASearchThatEndedAtALimitWhatTheResidualsAre) {
  ReportInput input = Doubtful();
  input.fit.adequacy.p_value = 1.0;
  EXPECT_THAT(LineOf(input, "misfit"), HasSubstr("not the whole story"));
  input.fit.findings = {{.code = "search_limit", .parameters = {"speed_exponent"}}};
  EXPECT_THAT(LineOf(input, "misfit"), HasSubstr("like noise, but the search stopped at a limit"));
  input.fit.adequacy.p_value = 1e-6;
  EXPECT_THAT(LineOf(input, "misfit"), HasSubstr("not the whole story"));
}

TEST(Answer, StatesAMisfitAsAFractionOfTheHalfGap) {
  ReportInput input = Doubtful();
  input.fit.records[0].facts = Facts(10.0);
  EXPECT_THAT(LineOf(input, "misfit"), HasSubstr("5 % of the half gap"));
  input.fit.adequacy.misfit_over_half_gap = 3.4e-8;
  EXPECT_THAT(LineOf(input, "misfit"), HasSubstr("< 0.01 % of the half gap"));
  input.fit.records[0].structure.repeatable_share = 0.3;
  EXPECT_THAT(Answer(input), Not(HasSubstr("alike in every stroke")));
  input.fit.records[0].structure.repeatable_share = 0.7;
  EXPECT_THAT(Answer(input), HasSubstr("alike in every stroke"));
}

TEST(Answer, HasATermOnceInAnswerAndDetails) {
  ReportInput input = Doubtful();
  testing::AddParameter(input.fit, "viscous", "N s/m", 12.5, 0.5);
  const std::string text = Details(input);
  EXPECT_NE(text.find("viscous"), std::string::npos);
  EXPECT_EQ(text.find("viscous"), text.rfind("viscous")) << text;
}

TEST(Answer, SaysThatStiffnessAndSlipForceIncludeADrag) {
  ReportInput input = Doubtful();
  const std::string clause = "σ and Tc include the drag: times 1 − drag_fraction without it";
  EXPECT_THAT(LineOf(input, "stiffness"), Not(HasSubstr(clause)));
  testing::AddParameter(input.fit, "drag_fraction", "-", 0.3, 0.01);
  EXPECT_THAT(LineOf(input, "stiffness"), HasSubstr(clause));
  // The clause is omitted if sigma has no value.
  input.fit.parameters.front().identifiability = Identifiability::kNotIdentifiable;
  EXPECT_THAT(LineOf(input, "stiffness"), Not(HasSubstr(clause)));
}

TEST(Answer, NamesACauseWithoutATermInPlaceOfANextStep) {
  ReportInput input = Doubtful();
  identification::Cause cause;
  cause.code = "displacement_sensor";
  cause.explains = 0.92;
  input.fit.adequacy.causes = {cause};
  EXPECT_EQ(LineOf(input, "looks like"), "displacement sensor, 92 % of the misfit");
  input.fit.adequacy.causes.front().explains = 0.4;
  EXPECT_EQ(LineOf(input, "looks like"), "");
  input.fit.adequacy.causes = {cause};
  input.next = testing::MadeStep("--terms viscous");
  EXPECT_EQ(LineOf(input, "looks like"), "");
}

TEST(Answer, HasNoFractionAboveTheWhole) {
  ReportInput input = Doubtful();
  input.fit.adequacy.misfit_over_half_gap = 3.66;
  identification::Cause cause;
  cause.code = "running_in";
  cause.explains = 3.66;
  input.fit.adequacy.causes = {cause};
  EXPECT_THAT(Details(input), Not(HasSubstr("366")));
}

TEST(Answer, OfNoLoopSaysSo) {
  ReportInput input = Inadequate();
  input.fit.findings = {
      {.code = "model_inadequate", .numbers = {{"r_squared", -0.52}}, .kind = "no_loop"}};
  EXPECT_THAT(LineOf(input, "misfit"), StartsWith("no loop is seen: the fit explains 0 %"));
}

TEST(Answer, SaysEveryWarningOnce) {
  ReportInput input = MadeInput();
  input.fit.findings = {
      {.code = "reversals_uncertain", .numbers = {{"count", 7.0}, {"gate", 1e-7}}},
      {.code = "load_varies",
       .severity = identification::Severity::kNote,
       .numbers = {{"variation", 0.1}},
       .kind = "followed"}};
  EXPECT_THAT(LineOf(input, "note"), StartsWith("7 reversals, under a gate of 100 nm"));
  EXPECT_THAT(Answer(input), Not(HasSubstr("which the law follows")));
  EXPECT_THAT(Details(input), HasSubstr("which the law follows"));
}

TEST(Answer, SaysWhatWasAssumedOfTheFile) {
  ReportInput input = MadeInput();
  input.notes = {"loop.csv:4: 2 rows above the header skipped"};
  EXPECT_EQ(LineOf(input, "read as"), input.notes[0]);
  input.notes.emplace_back("loop.csv: force 'F' names no unit: taken as N");
  EXPECT_EQ(LineOf(input, "read as"), "2 assumptions: --details");
  EXPECT_THAT(Details(input), HasSubstr("names no unit: taken as N"));
}

TEST(Sentence, AsksForSamplesOnlyWhereNoiseIsAllThatIsLeft) {
  const identification::Finding wide{.code = "not_identifiable",
                                     .parameters = {"sigma"},
                                     .numbers = {{"lower", 1e6}, {"upper", 1e9}},
                                     .kind = "wide"};
  EXPECT_EQ(Sentence(wide, MadeInput().fit),
            "95 % interval 1 N/µm … 1 N/nm is too wide; more samples or less noise");
  EXPECT_EQ(Sentence(wide, Doubtful().fit), "95 % interval 1 N/µm … 1 N/nm is too wide");
}

TEST(Answer, IsAtMostAHundredColumnsWide) {
  ReportInput input = Doubtful();
  input.known = kSphereOnPlane;
  input.next = testing::MadeStep("--terms slip_position", std::string(60, 'x'));
  std::istringstream lines(Details(input));
  for (std::string line; std::getline(lines, line);) {
    const auto characters =
        std::ranges::count_if(line, [](char byte) { return (byte & 0xC0) != 0x80; });
    EXPECT_LE(characters, 100) << line;
  }
}

TEST(Judgement, IsGoodOnlyOfWhatMayBeQuoted) {
  auto estimate = MadeParameter("sigma", "N/m", 4e7, 4e5);
  EXPECT_EQ(JudgementOf(estimate), kGood);
  estimate.identifiability = Identifiability::kEffective;
  EXPECT_EQ(JudgementOf(estimate), kPoor);
  estimate.identifiability = Identifiability::kNotIdentifiable;
  EXPECT_EQ(JudgementOf(estimate), kBad);
  estimate.status = ParameterStatus::kFixed;
  EXPECT_EQ(JudgementOf(estimate), kPlain);
}

TEST(Sentence, ThereIsOneForEveryFinding) {
  for (const identification::FindingRow& row : identification::kFindings) {
    const identification::Finding finding{.code = identification::FindingCode(row)};
    EXPECT_NE(Sentence(finding, {}), row.code);
  }
}

}  // namespace
}  // namespace mindahl::report::answer_test
