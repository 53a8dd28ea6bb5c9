#include "report/adequacy.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "mindahl/report/report.h"
#include "report/made_report.h"
#include "support/contract.h"
#include "support/prelude.h"

// The verdict on the model and what the residuals look like, in words and in the JSON.
namespace mindahl::report::adequacy_test {
namespace {

using namespace identification;

using nlohmann::json;

Cause MadeCause(std::string_view code, double size = 0.0, std::string_view unit = "",
                std::string_view option = "") {
  Cause cause;
  cause.code = code;
  cause.size = size;
  cause.unit = unit;
  cause.option = option;
  cause.delta_aicc = -320;
  cause.explains = 0.93;
  cause.moves = 4.5;
  return cause;
}

Cause Lag() { return MadeCause("channel_lag", 0.0025, "s"); }
Cause Viscous() { return MadeCause("viscous_force", -12, "N s/m", "--viscous fit"); }

ReportInput InputWith(AdequacyVerdict verdict, std::vector<Cause> causes) {
  ReportInput input = MadeInput();
  input.fit.adequacy = {.verdict = verdict,
                        .misfit_over_noise = 1.75,
                        .misfit = 1.6,
                        .p_value = 1e-9,
                        .causes = std::move(causes),
                        .misfit_over_half_gap = 0.08,
                        .use = verdict == AdequacyVerdict::kInadequate
                                   ? identification::Use::kNone
                                   : identification::Use::kIndicative,
                        .tried = 15};
  return input;
}

Report ReportWith(AdequacyVerdict verdict, std::vector<Cause> causes) {
  return MakeReport(InputWith(verdict, std::move(causes)));
}

/// Codes in the table of departures, and of heavy tails.
std::set<std::string> TriedCodes() {
  std::string text;
  for (const char* file : {"departures.cc", "heavy_tails.h"}) {
    std::ifstream in(std::filesystem::path(MINDAHL_SOURCE_DIR) / "src/identification/inference" /
                     file);
    text.append(std::istreambuf_iterator<char>(in), {});
  }
  std::set<std::string> codes = testing::Matches(text, "\\.code = \"([a-z_]+)\"");
  codes.merge(testing::Matches(text, "kHeavyTails = \"([a-z_]+)\""));
  return codes;
}

TEST(CauseSentence, ExistsForEveryTermThatIsTriedAndNoOther) {
  std::set<std::string> spoken;
  for (const std::string_view code : CauseCodes()) spoken.emplace(code);
  EXPECT_EQ(spoken, TriedCodes());
}

TEST(CauseSentence, OfAReadingThatLosesMoreThanThereIsSaysAll) {
  const Cause saturates{
      .code = "force_saturates", .explains = 0.7, .size = 4.09, .unit = "-", .option = ""};
  EXPECT_THAT(Sentence(saturates), HasSubstr("loses all of its excess"));
}

TEST(CauseSentence, HasSizeUnitFractionAndRemedy) {
  EXPECT_EQ(Sentence(Lag()),
            "a force that is read 2.5 ms after the displacement, which explains 93 % of the "
            "misfit: compare the delays and filters of the two channels");
  Cause early = Lag();
  early.size = -0.0025;
  EXPECT_THAT(Sentence(early), StartsWith("a displacement that is read 2.5 ms after the force"));
  EXPECT_EQ(Sentence(Viscous()),
            "an additional viscous force of -12 N s/m, which explains 93 % of the misfit: give "
            "--viscous fit");
  for (const std::string_view code : CauseCodes()) {
    const Cause cause = MadeCause(code, 0.125, "-");
    EXPECT_FALSE(Sentence(cause).empty());
    EXPECT_THAT(Sentence(cause), Not(HasSubstr("\n")));
  }
  EXPECT_THROW(Sentence(MadeCause("bad_weather")), std::logic_error);
}

TEST(AdaptedCauses, AreInTheUnitsOfATorque) {
  std::vector<Cause> causes = {
      Viscous(), MadeCause("rig_in_series", 1, "m/N"), MadeCause("inertia", 1, "kg"),
      MadeCause("force_drift", 1, "N/sample"), MadeCause("covariate", 1, "N/unit")};
  AdaptCauses(kUnitsOfTorque, causes);
  EXPECT_EQ(causes[0].unit, "N m s/rad");
  EXPECT_EQ(causes[1].unit, "rad/(N m)");
  EXPECT_EQ(causes[2].unit, "kg m²");
  EXPECT_EQ(causes[3].unit, "N m/sample");
  EXPECT_EQ(causes[4].unit, "N m/unit");
  EXPECT_EQ(causes[0].option, "--viscous fit");
}

TEST(CauseSentence, OfAForceOfTheSpeedWithoutAnOptionAsksForATime) {
  Cause untimed = Viscous();
  untimed.option = "";
  EXPECT_EQ(WhyNoOption(untimed), "needs a time column");
  EXPECT_THAT(Sentence(untimed), HasSubstr("record the time"));
}

TEST(AdequacyText, OfAnInadequateModelHasNothingOfItsCurve) {
  const std::string text = ToText(ReportWith(AdequacyVerdict::kInadequate, {}));
  for (const char* of_the_curve : {"model energy", "energy ratio of", "σ = 8a/G*", "Mindlin's"}) {
    EXPECT_THAT(text, Not(HasSubstr(of_the_curve)));
  }
  EXPECT_THAT(ToText(ReportWith(AdequacyVerdict::kDoubtful, {})), HasSubstr("energy ratio of"));
}

TEST(AdequacyText, GivesFractionsOfTcOnlyIfTcIsKnown) {
  ReportInput input = InputWith(AdequacyVerdict::kAdequate, {});
  for (ParameterEstimate& estimate : input.fit.parameters) {
    estimate.identifiability = Identifiability::kIdentifiable;
  }
  EXPECT_THAT(ToText(MakeReport(input)), HasSubstr("% of Tc"));
  for (ParameterEstimate& estimate : input.fit.parameters) {
    estimate.identifiability = Identifiability::kNotIdentifiable;
  }
  EXPECT_THAT(ToText(MakeReport(std::move(input))), Not(HasSubstr("% of Tc")));
}

ReportInput Missing(AdequacyVerdict verdict, std::vector<Cause> causes) {
  ReportInput input = InputWith(verdict, std::move(causes));
  input.fit.residuals.rms = 2.0;
  input.fit.records[0].facts.closed = true;
  input.fit.records[0].facts.half_gap = 40.0;
  input.fit.records[0].structure.repeatable_share = 0.3;
  return input;
}

TEST(AdequacyText, IsTheFirstLineOfTheReportWithTheMisfitOverTheHalfGap) {
  const auto verdict = [](AdequacyVerdict given) {
    return VerdictSentence(MakeReport(Missing(given, {Lag()})));
  };
  constexpr const char* kMisfit =
      "mindlin-dahl misses the force by 1.6 N rms (8 % of the half gap), 30 % of its variance "
      "alike in every stroke, more than noise alone explains (p = 1e-09); no parameter is usable";
  EXPECT_EQ(verdict(AdequacyVerdict::kAdequate),
            "adequate: the residuals, 2 N rms, look like noise (p = 1e-09)");
  EXPECT_EQ(verdict(AdequacyVerdict::kDoubtful), "doubtful, indicative: " + std::string(kMisfit));
  EXPECT_EQ(verdict(AdequacyVerdict::kInadequate),
            "inadequate, of no use for the law's shape: " + std::string(kMisfit));
  EXPECT_THAT(ToText(MakeReport(Missing(AdequacyVerdict::kDoubtful, {}))),
              StartsWith("doubtful, indicative: mindlin-dahl misses the force by"));
}

TEST(AdequacyText, HasTheFirstCauseAsTheNextStepAndTheOthersBelow) {
  const std::string text =
      ToText(MakeReport(Missing(AdequacyVerdict::kDoubtful, {Viscous(), Lag()})));
  EXPECT_THAT(text, HasSubstr("\nnext: it looks like an additional viscous force of -12 N s/m"));
  EXPECT_LT(text.find("\nparameter"), text.find("\nor like a force that is read 2.5 ms after"));
  EXPECT_THAT(ToText(MakeReport(Missing(AdequacyVerdict::kDoubtful, {}))),
              Not(HasSubstr("it looks like")));
}

TEST(AdequacyText, OfAFitThatIsNotUsableHasTenLinesAndNoDashes) {
  ReportInput input = Missing(AdequacyVerdict::kInadequate, {Viscous(), Lag()});
  loop::LoopFacts& facts = input.fit.records[0].facts;
  facts.energy_ratio = 0.9;
  facts.sliding_fraction = 0.97;
  facts.slope_after_reversal = facts.plateau_slope = 1e6;
  facts.asymmetry = 0.1;
  facts.sliding_amplitude = 1e-6;
  facts.half_gap_standard_deviation = 0.1;
  facts.backlash = {.width = 1e-7, .force = 0.0};
  const std::string text = ToText(MakeReport(std::move(input)));
  EXPECT_LE(std::ranges::count(text, '\n'), 10);
  for (const char* needed :
       {"inadequate, ", "\nnext: it looks like an additional viscous force", "--viscous fit",
        "\nmeasured: ", "half gap", "it slides over 97 %", "\nreversals: "}) {
    EXPECT_THAT(text, HasSubstr(needed));
  }
  for (const char* left_out : {"\nparameter", " - ", "residuals: ", "\ncontact"}) {
    EXPECT_THAT(text, Not(HasSubstr(left_out)));
  }
}

TEST(AdequacyText, AsksForALargerAmplitudeWhereNothingSlidesAndNoOptionHelps) {
  const auto next = [](const Cause& cause, double energy) {
    ReportInput input = Missing(AdequacyVerdict::kInadequate, {cause});
    loop::LoopFacts& facts = input.fit.records[0].facts;
    facts.closed = true;
    facts.amplitude = 1e-6;
    facts.half_gap = 2.0;  // 4X times it: 8 µJ
    facts.energy_per_cycle = energy;
    facts.energy_ratio = 0.16;
    input.fit.parameters[2].identifiability = identification::Identifiability::kNotIdentifiable;
    return NextStep(MakeReport(std::move(input)));
  };
  const Cause sensor = MadeCause("displacement_sensor");
  EXPECT_THAT(next(sensor, 13e-6), StartsWith("raise the amplitude"));
  EXPECT_THAT(next(sensor, 8e-6), StartsWith("it looks like")) << "a spring beside one that slides";
  EXPECT_THAT(next(Viscous(), 13e-6), HasSubstr("--viscous fit"));
}

TEST(AdequacyText, OfAColumnThatFollowsTheContactAsksForItsFactor) {
  const Cause cause = MadeCause("covariate", 6.0, "N/unit", "--covariate a2=C");
  EXPECT_THAT(Sentence(cause, loop::Channel::kForce),
              HasSubstr("give --covariate a2=C where its factor is known"));
  EXPECT_EQ(WhyNoOption(cause), "--covariate a2=C, where the factor C is known");
}

TEST(AdequacyText, SaysThatRecordIsTooShortToTryTerms) {
  ReportInput input = MadeInput();
  EXPECT_THAT(ToText(MakeReport(std::move(input))),
              StartsWith("not judged: the record has too few samples"));
}

TEST(AdequacyJson, HasVerdictMisfitAndCauses) {
  const json adequacy =
      json::parse(ToJson(ReportWith(AdequacyVerdict::kDoubtful, {Lag(), Viscous()})))["adequacy"];
  EXPECT_EQ(adequacy["verdict"], "doubtful");
  EXPECT_EQ(adequacy["misfit_over_noise"], 1.75);
  EXPECT_EQ(adequacy["misfit_over_half_gap"], 0.08);
  EXPECT_EQ(adequacy["use"], "indicative");
  EXPECT_EQ(adequacy["p_value"], 1e-9);
  ASSERT_EQ(adequacy["causes"].size(), 2u);
  EXPECT_EQ(adequacy["causes"][0], json({{"code", "channel_lag"},
                                         {"try", nullptr},
                                         {"delta_aicc", -320.0},
                                         {"explains", 0.93},
                                         {"size", 0.0025},
                                         {"unit", "s"},
                                         {"moves", 4.5}}));
  EXPECT_EQ(adequacy["causes"][1]["try"], "--viscous fit");
}

TEST(AdequacyJson, SaysWhyThereIsNoOptionNoSizeAndNoVerdict) {
  const Cause shape = MadeCause("shape_of_law");
  const json fit = json::parse(ToJson(ReportWith(AdequacyVerdict::kDoubtful, {shape})));
  EXPECT_TRUE(fit["adequacy"]["causes"][0]["size"].is_null());
  const auto has = [](const json& report, const char* path, const char* why) {
    return ::testing::Value(report["nulls"],
                            ::testing::Contains(json{{"path", path}, {"why", why}}));
  };
  EXPECT_TRUE(has(fit, "adequacy.causes[0].try", "no option takes it into account yet"));
  const json unjudged = json::parse(ToJson(MakeReport(MadeInput())));
  EXPECT_TRUE(unjudged["adequacy"]["verdict"].is_null());
  EXPECT_TRUE(has(unjudged, "adequacy.verdict", kWhyNotJudged));
  const json failed = json::parse(ToJson(MakeReport(testing::FailedInput())));
  EXPECT_TRUE(has(failed, "adequacy.verdict", "the fit failed: no start led anywhere"));
}

TEST(VerdictSentence, NamesTheParametersWhoseIntervalsIncludeTheMisfit) {
  const auto includes = [](const std::vector<std::string>& effective) {
    ReportInput input = Missing(AdequacyVerdict::kDoubtful, {});
    for (const char* name : {"viscous", "force_offset"}) {
      input.fit.parameters.push_back(mindahl::testing::MadeParameter(name, "N", 1.0, 0.1));
    }
    input.fit.correlation.assign(25, 0.0);
    for (ParameterEstimate& estimate : input.fit.parameters) {
      const bool is_effective = std::ranges::find(effective, estimate.name) != effective.end();
      if (is_effective) estimate.identifiability = Identifiability::kEffective;
    }
    const std::string sentence = VerdictSentence(MakeReport(std::move(input)));
    return sentence.substr(sentence.find("); ") + 3);
  };
  EXPECT_EQ(includes({}), "no parameter is usable");
  EXPECT_EQ(includes({"alpha"}), "the interval of alpha includes this");
  EXPECT_EQ(includes({"sigma", "slip_force"}), "the intervals of sigma, slip_force include this");
  EXPECT_EQ(includes({"sigma", "viscous"}), "the intervals of sigma and 1 more include this");
  EXPECT_EQ(includes({"sigma", "viscous", "force_offset"}),
            "the intervals of sigma and 2 more include this");
  EXPECT_EQ(includes({"viscous"}), "the interval of viscous includes this");
  EXPECT_EQ(includes({"viscous", "force_offset"}),
            "the intervals of viscous, force_offset include this");
}

TEST(VerdictSentence, OfARecordWithoutALoopHasTheFractionThatIsExplained) {
  ReportInput input = Missing(AdequacyVerdict::kInadequate, {});
  input.fit.findings = {{.code = "loop_not_seen", .numbers = {{"r_squared", 0.125}}}};
  EXPECT_EQ(VerdictSentence(MakeReport(input)),
            "inadequate: the force shows no loop, since the model explains only 12 % of its "
            "variance; the parameters mean nothing for this record");
  input.fit.findings[0].numbers = {{"r_squared", -0.5}};
  EXPECT_THAT(VerdictSentence(MakeReport(input)), HasSubstr("explains only 0 % of"));
}

TEST(MisfitSentence, HasTheChannelThatIsFitted) {
  ReportInput input = Missing(AdequacyVerdict::kDoubtful, {});
  input.fit.adequacy.misfit_over_half_gap = 1.25;
  EXPECT_EQ(MisfitSentence(MakeReport(input)),
            "mindlin-dahl misses the force by 1.6 N rms (125 % of the half gap), 30 % of its "
            "variance alike in every stroke");
  input.fit.adequacy.misfit_over_half_gap.reset();
  input.fit.records[0].structure.repeatable_share = 0.0;
  input.fit.response = loop::Channel::kDisplacement;
  EXPECT_EQ(MisfitSentence(MakeReport(input)), "mindlin-dahl misses the displacement by 1.6 m rms");
}

TEST(CauseSentence, OfEachSignAndSizeHasItsWords) {
  const auto said = [](const char* code, double size, const char* unit, const char* option = "") {
    const std::string sentence = Sentence(MadeCause(code, size, unit, option));
    return sentence.substr(0, sentence.find(", which explains"));
  };
  EXPECT_EQ(said("running_in", 0.125, "-"), "a friction that grows by 12.5 % over the record");
  EXPECT_EQ(said("running_in", -0.125, "-"), "a friction that falls by 12.5 % over the record");
  EXPECT_EQ(said("rig_in_series", -2.5e-8, "m/N"),
            "a rig in series that deflects by 25 nm/N less than was subtracted");
  EXPECT_EQ(said("backlash", -2.5e-8, "m"), "an overtravel of 25 nm after each reversal");
  EXPECT_EQ(said("unequal_directions", 0.999, "-"),
            "a friction that differs by 99.9 % from the mean in each direction");
  EXPECT_EQ(said("unequal_directions", 1.0, "-"),
            "a friction that differs by all from the mean in each direction");
  EXPECT_EQ(said("unequal_directions", 0.5, ""),
            "a friction that differs between the two directions");
  EXPECT_EQ(said("plateau_slope", -12.0, "N/m"),
            "an additional force that grows by -12 N/m with the displacement");
  EXPECT_EQ(said("clock_drift", -0.0025, "s"), "a force whose clock gains 2.5 ms over the record");
  Cause measured = MadeCause("backlash", 2.5e-8, "m", "--backlash fit");
  measured.is_measured = true;
  EXPECT_EQ(Sentence(measured),
            "a backlash of 25 nm after each reversal, over which the force stays constant in "
            "every stroke: give --backlash fit");
  const Cause shape = MadeCause("shape_of_law");
  EXPECT_THAT(Sentence(shape, loop::Channel::kForce), EndsWith(": compare the laws with --model "
                                                               "auto"));
  EXPECT_THAT(Sentence(shape, loop::Channel::kDisplacement),
              EndsWith(": fit another law, --model mindlin-dahl or dahl, and compare"));
  EXPECT_THAT(Sentence(MadeCause("covariate", 2, "N/unit", "--covariate p")),
              EndsWith(": give --covariate p, or --covariate p=C where its factor is known"));
}

}  // namespace
}  // namespace mindahl::report::adequacy_test
