#include "report/adequacy.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "mindahl/report/json.h"
#include "mindahl/report/text.h"
#include "report/made_report.h"
#include "support/contract.h"

// The verdict on the model and what the residuals look like, in words and in the JSON.
namespace mindahl::report::adequacy_test {
namespace {

using namespace identification;

using nlohmann::json;
using ::testing::HasSubstr;
using testing::MadeInput;
using ::testing::Not;
using ::testing::StartsWith;

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

/// Codes in the tables of departures and irregularities.
std::set<std::string> TriedCodes() {
  std::string text;
  for (const char* file : {"departures.cc", "irregularities.cc"}) {
    std::ifstream in(std::filesystem::path(MINDAHL_SOURCE_DIR) / "src/identification/inference" /
                     file);
    text.append(std::istreambuf_iterator<char>(in), {});
  }
  return testing::Matches(text, "\\.code = \"([a-z_]+)\"");
}

TEST(CauseSentence, IsThereForEveryDepartureThatIsTriedAndNoOther) {
  std::set<std::string> spoken;
  for (const std::string_view code : CauseCodes()) spoken.emplace(code);
  EXPECT_EQ(spoken, TriedCodes());
}

TEST(CauseSentence, HasALineInTheContractForEveryCode) {
  const std::string contract = testing::PageText("docs/contract.md");
  for (const std::string_view code : CauseCodes()) {
    EXPECT_THAT(contract, HasSubstr("| `" + std::string(code) + "` |")) << code;
  }
}

TEST(CauseSentence, OfAReadingThatLosesMoreThanThereIsSaysAll) {
  const Cause saturates{
      .code = "force_saturates", .explains = 0.7, .size = 4.09, .unit = "-", .option = ""};
  EXPECT_THAT(Sentence(saturates), HasSubstr("loses all of what is beyond"));
}

TEST(CauseSentence, HasSizeUnitShareAndRemedy) {
  EXPECT_EQ(Sentence(Lag()),
            "a force that is read 2.5 ms after the displacement, which explains 93 % of the "
            "residuals' variance: compare the delays and filters of the two channels");
  Cause early = Lag();
  early.size = -0.0025;
  EXPECT_THAT(Sentence(early), StartsWith("a displacement that is read 2.5 ms after the force"));
  EXPECT_EQ(Sentence(Viscous()),
            "a viscous force of -12 N s/m beside the contact's, which explains 93 % of the "
            "residuals' variance: give --viscous fit");
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
  AdaptCauses(kUnitsOfTorque, /*has_time=*/true, causes);
  EXPECT_EQ(causes[0].unit, "N m s/rad");
  EXPECT_EQ(causes[1].unit, "rad/(N m)");
  EXPECT_EQ(causes[2].unit, "kg m²");
  EXPECT_EQ(causes[3].unit, "N m/sample");
  EXPECT_EQ(causes[4].unit, "N m/unit");
  EXPECT_EQ(causes[0].option, "--viscous fit");
}

TEST(AdaptedCauses, OfferNoOptionThatNeedsATimeWhereThereIsNone) {
  std::vector<Cause> causes = {Viscous(), MadeCause("force_drift", 1, "N/s", "--drift")};
  AdaptCauses(kUnitsOfForce, /*has_time=*/false, causes);
  EXPECT_EQ(causes[0].option, "");
  EXPECT_EQ(WhyNoOption(causes[0]), "needs a column of the time");
  EXPECT_EQ(causes[1].option, "--drift");
}

TEST(AdequacyText, OfAnInadequateModelHasNothingOfItsCurve) {
  const std::string text = ToText(ReportWith(AdequacyVerdict::kInadequate, {}));
  for (const char* of_the_curve : {"J of the model", "energy ratio of", "σ = 8a/G*", "Mindlin's"}) {
    EXPECT_THAT(text, Not(HasSubstr(of_the_curve)));
  }
  EXPECT_THAT(text, HasSubstr("no loop of the model, and no contact"));
  EXPECT_THAT(ToText(ReportWith(AdequacyVerdict::kDoubtful, {})), HasSubstr("energy ratio of"));
}

TEST(AdequacyText, SharesOfTcAreThoseOfATcThatIsKnown) {
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

TEST(AdequacyText, IsTheFirstLineOfTheReport) {
  EXPECT_THAT(ToText(ReportWith(AdequacyVerdict::kAdequate, {})),
              StartsWith("adequate: what the model misses is 1.8 times the noise (p = 1e-09)"));
  const std::string doubtful =
      VerdictSentence(ReportWith(AdequacyVerdict::kDoubtful, {Lag(), Viscous()}));
  EXPECT_THAT(doubtful, StartsWith("doubtful, indicative: the model misses the force by 1.6 N rms, "
                                   "8 % of the half gap, 1.8 times the noise (p = 1e-09)"));
  EXPECT_THAT(doubtful, HasSubstr("It looks like a force that is read 2.5 ms after"));
  EXPECT_THAT(doubtful, Not(HasSubstr("viscous")));
  const std::string text = ToText(ReportWith(AdequacyVerdict::kDoubtful, {Lag(), Viscous()}));
  EXPECT_THAT(text, HasSubstr("\n  or a viscous force of -12 N s/m"));
  EXPECT_THAT(ToText(ReportWith(AdequacyVerdict::kInadequate, {})),
              StartsWith("inadequate, of no use for the law's shape: the model misses the force"));
  EXPECT_THAT(VerdictSentence(ReportWith(AdequacyVerdict::kInadequate, {})),
              HasSubstr("It looks like nothing that was tried"));
}

TEST(AdequacyText, OfARecordTooShortToTryAnythingSaysSo) {
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

}  // namespace
}  // namespace mindahl::report::adequacy_test
