
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <stdexcept>

#include "mindahl/report/report.h"
#include "report/made_report.h"
#include "support/prelude.h"

namespace mindahl::report::sentences_test {
namespace {

using namespace models;
using namespace identification;

using report::Sentence;

/// Every number that a finding has, each unlike the others.
Finding Complete(FindingCode code, std::string_view kind = "") {
  Finding finding{.code = code};
  finding.kind = kind;
  finding.parameters = {"alpha", "force_offset"};
  const std::string_view name(code);
  if (name == "law_undecided" || name == "other_law_fits_better") {
    finding.parameters = {"sigma", "slip_force"};
  }
  finding.numbers = {{"overshoot", 1.25e-7},
                     {"rig_stiffness", 4.5e4},
                     {"alpha", 0.0625},
                     {"peak_force", 12.5},
                     {"amplitude", 1.75e-6},
                     {"lower", 0.5},
                     {"upper", 21.0},
                     {"misfit", 0.04},
                     {"repeatable_share", 0.83},
                     {"largest", -2.5},
                     {"position", 0.24},
                     {"direction", -1.0},
                     {"count", 19},
                     {"gate", 8.5e-4},
                     {"other_count", 148},
                     {"other_gate", 2.5e-6},
                     {"record", 2},
                     {"path_ratio", 1.75},
                     {"spikes", 3},
                     {"dropouts", 0},
                     {"held", 1},
                     {"share", 0.36},
                     {"places", 9},
                     {"samples", 144},
                     {"row", 17},
                     {"row", 240},
                     {"sigma", 3.25e7},
                     {"slip_force", 43.5},
                     {"delta_aicc", -31.5},
                     {"measured", 0.015},
                     {"model", 0.0325},
                     {"r_squared", 0.0625},
                     {"variation", 0.055},
                     {"bound", 0.99},
                     {"strokes", 2.5},
                     {"of_displacement", 0.045},
                     {"of_force", 0.005},
                     {"deviation", 2.4e-9},
                     {"p_value", 0.0035},
                     {"dahl_p_value", 0.25},
                     {"never_slips", 0.12},
                     {"distance", 4.5}};
  return finding;
}

std::string Say(const Finding& finding) {
  FitResult fit;
  fit.model = FindFrictionModel("jenkins");
  fit.solver.message = "no start led anywhere";
  return Sentence(finding, fit);
}

struct Form {
  FindingCode code;
  const char* kind;
  std::vector<std::string> words;  // that the numbers and names must turn up in
};

TEST(Sentence, OfACombinationAsksForNoLargerAmplitudeWhereTheStiffnessIsNotSeen) {
  Finding finding{.code = "undetermined_combination", .parameters = {"sigma", "alpha"}};
  FitResult fit;
  fit.parameters = {testing::MadeParameter("slip_force", "N", 40, 0.1)};
  EXPECT_THAT(Sentence(finding, fit, kUnitsOfForce),
              AllOf(HasSubstr("sample more densely"), Not(HasSubstr("amplitude"))));
  // In partial slip it would tell them apart.
  fit.parameters[0].identifiability = identification::Identifiability::kBoundedBelow;
  EXPECT_THAT(Sentence(finding, fit, kUnitsOfForce), HasSubstr("record a larger amplitude"));
}

TEST(Sentence, OfAnIntervalThatTheModelWidensAsksForNoMoreSamples) {
  const Finding finding{.code = "sigma_not_identifiable",
                        .parameters = {"sigma"},
                        .numbers = {{"lower", 1e6}, {"upper", 4e7}},
                        .kind = "wide"};
  FitResult fit;
  fit.parameters = {testing::MadeParameter("sigma", "N/m", 8e6, 1e5)};
  fit.parameters[0].lower95 = 1e6;
  fit.parameters[0].upper95 = 4e7;
  EXPECT_THAT(Sentence(finding, fit, kUnitsOfForce), HasSubstr("record more samples"));
  fit.parameters[0].interval = {
      {.source = identification::IntervalSource::kDiscrepancy, .lower = 1e6, .upper = 4e7}};
  EXPECT_THAT(Sentence(finding, fit, kUnitsOfForce),
              AllOf(HasSubstr("1 N/µm … 40 N/µm"), HasSubstr("what the model misses"),
                    Not(HasSubstr("record"))));
}

TEST(Sentence, OfTwoLawsHasNoSlipForceThatDoesNotDependOnThem) {
  Finding finding = Complete("law_undecided", "dahl");
  finding.parameters = {"sigma"};
  EXPECT_THAT(Say(finding),
              AllOf(StartsWith("sigma: "), HasSubstr("32.5 N/µm"), Not(HasSubstr("43.5 N"))));
}

TEST(Sentence, HasTheNumbersAndNamesOfItsFinding) {
  const std::vector<Form> forms = {
      {"shape_or_rig", "", {"45 N/mm", "0.0625", "does not distinguish"}},
      {"slip_force_bounded_below", "", {"12.5 N", "1.75 µm"}},
      {"alpha_not_identifiable", "with_slip_force", {"only the ratio alpha/slip_force"}},
      {"alpha_not_identifiable", "wide", {"alpha: ", "0.5 … 21"}},
      {"sigma_not_identifiable", "wide", {"sigma: ", "0.5 N/m … 21 N/m"}},
      {"slip_force_not_identifiable", "wide", {"slip_force: ", "500 mN … 21 N"}},
      {"sigma_bounded_below", "", {"rigid contact"}},
      {"undetermined_parameter", "", {"alpha, force_offset", "any of them"}},
      {"undetermined_combination", "", {"combination of alpha, force_offset"}},
      {"reversals_uncertain",
       "",
       {"record 2: ", "19 if excursions up to 850 µm", "148 if those up to 2.5 µm",
        "--reversal-gate"}},
      {"glitches_left_out",
       "",
       {"record 2: ", "3 spikes, 1 held values", "first in data rows 17, 240"}},
      {"path_too_long", "", {"record 2: ", "1.75 times"}},
      {"no_closed_cycle", "", {"record 2: no cycle is closed"}},
      {"energy_contradiction", "", {"15 mJ", "32.5 mJ", "1.75 µm", "jenkins"}},
      {"model_inadequate", "", {"jenkins does not describe this record"}},
      {"slip_force_extrapolated", "", {"slip_force: ", "alpha = 0.0625", "36 %"}},
      {"search_limit",
       "",
       {"alpha, force_offset: the search stopped at its limit, 0.99", "--bound alpha=LO:HI"}},
      {"few_places", "", {"sigma, alpha: ", "144 samples", "9 places"}},
      {"asymmetry_not_identifiable",
       "",
       {"alpha, force_offset: the loop stays 12 % of slip_force below slip",
        "the whole contact slips"}},
      {"loop_not_seen", "", {"sigma, alpha, slip_force: ", "6.2 % of the force's variance"}},
      {"unknown_past", "cut", {"alpha, slip_force: ", "--initial-state virgin"}},
      {"unknown_past", "one_stroke", {"sigma, alpha, slip_force: ", "--initial-state virgin"}},
      {"initial_state_undecided", "", {"alpha, force_offset: ", "--initial-state"}},
      {"several_minima", "", {"alpha, force_offset: ", "a second minimum"}},
      {"slow_residuals", "", {"strokes", "--cycles"}},
      {"law_undecided",
       "dahl",
       {"sigma, slip_force: ", "from Dahl's own law", "32.5 N/µm", "43.5 N", "ΔAICc = -31.5"}},
      {"other_law_fits_better",
       "dahl",
       {"sigma, slip_force: Dahl's own law", "Masing's law", "ΔAICc = -31.5", "32.5 N/µm", "43.5 N",
        "--model dahl"}},
      {"rig_not_tried", "", {"alpha = 0.0625", "--load-window"}},
      {"prior_contradicted", "", {"4.5 standard deviations", "check the prior"}},
      {"rig_not_tried", "imposed_force", {"alpha = 0.0625", "subtract its deflection"}},
      {"noise_in_displacement", "", {"4.5 % of X", "0.5 % of T*", "--noise-in displacement"}},
      {"load_followed", "", {"record 2: ", "±5.5 %", "the law follows it"}},
      {"load_not_followed", "", {"record 2: ", "±5.5 %", "jenkins", "--load-window"}},
      {"alpha_limited_by_load", "", {"0.99 or more", "--load-window"}},
      {"weights_not_settled", "", {"weights"}},
      {"fit_failed", "", {"no start led anywhere"}},
  };
  std::set<std::string> codes;
  for (const Form& form : forms) {
    const std::string sentence = Say(Complete(form.code, form.kind));
    for (const std::string& words : form.words) EXPECT_THAT(sentence, HasSubstr(words));
    codes.emplace(std::string_view(form.code));
  }
  codes.insert({"no_model_fits", "systematic_residual"});  // below
  for (const FindingRow& row : kFindings) {
    EXPECT_TRUE(codes.contains(std::string(row.code))) << row.code << " is not tested";
  }
}

TEST(Sentence, OfAGlitchSaysItsRowAndOfOneRecordNotWhich) {
  const Finding one{.code = "glitches_left_out",
                    .numbers = {{"spikes", 0}, {"dropouts", 1}, {"held", 0}, {"row", 8}}};
  EXPECT_EQ(Say(one), "measurement faults left out: 1 dropouts, in data row 8");
}

TEST(Sentence, OfAMisfitSaysWhereItIsAndOfWhatKind) {
  std::set<std::string> endings;
  for (const char* kind :
       {"same_on_return", "mirrored_early", "one_sided_early", "mirrored", "asymmetric"}) {
    const std::string poor = Say(Complete("systematic_residual", kind));
    EXPECT_THAT(poor, AllOf(StartsWith("jenkins leaves a repeatable residual"),
                            HasSubstr("rms 4 % of the force"), HasSubstr("83 %"),
                            HasSubstr("up to 2.5 N at 24 % of the down stroke, ")));
    const std::string failing = Say(Complete("no_model_fits", kind));
    EXPECT_THAT(failing, StartsWith("jenkins cannot follow this record"));
    const std::string ending = poor.substr(poor.find("down stroke, "));
    EXPECT_TRUE(endings.insert(ending).second) << kind;
  }
  Finding up = Complete("systematic_residual", "mirrored");
  std::ranges::replace(up.numbers, std::pair<std::string_view, double>("direction", -1.0),
                       std::pair<std::string_view, double>("direction", 1.0));
  EXPECT_THAT(Say(up), HasSubstr("of the up stroke, "));
}

TEST(Sentence, OfOneParameterIsInTheSingular) {
  Finding finding = Complete("undetermined_parameter");
  finding.parameters = {"plateau_slope"};
  EXPECT_EQ(Say(finding),
            "plateau_slope: the record does not depend on it; fix it, or record another amplitude");
}

TEST(Sentence, SpeaksOneLineWithoutAnEnd) {
  for (const FindingRow& row : kFindings) {
    const FindingCode code(row);
    for (const char* kind : {"", "wide", "with_slip_force", "mirrored"}) {
      try {
        EXPECT_THAT(Say(Complete(code, kind)), Not(HasSubstr("\n")));
      } catch (const std::logic_error&) {  // not a kind of this code
      }
    }
  }
}

TEST(Sentence, OfAnUnknownKindOrWithoutANumberIsARefusal) {
  EXPECT_THROW(Say(Complete("alpha_not_identifiable", "bad_weather")), std::logic_error);
  EXPECT_THROW(Say(Complete("no_model_fits")), std::logic_error);
  const Finding bare{.code = "shape_or_rig"};
  EXPECT_THROW(Say(bare), std::logic_error);
}

std::string Content(const std::filesystem::path& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::set<std::string> Matches(const std::string& text, const std::regex& pattern) {
  std::set<std::string> found;
  for (std::sregex_iterator match(text.begin(), text.end(), pattern), end; match != end; ++match) {
    found.insert((*match)[1]);
  }
  return found;
}

/// Returns the codes that the sources of the identification make findings of: `.code = "…"`,
/// `FindingCode("…")` and the table of names and codes of wide intervals.
std::set<std::string> EmittedCodes() {
  std::set<std::string> codes;
  const std::regex member("\\.code = \"([a-z_]+)\"");
  const std::regex chosen("FindingCode\\(\"([a-z_]+)\"\\)");
  const std::regex wide("Row\\{\"[a-z_]+\", \"([a-z_]+_not_identifiable)\"\\}");
  const std::filesystem::path sources =
      std::filesystem::path(MINDAHL_SOURCE_DIR) / "src" / "identification";
  for (const auto& entry : std::filesystem::recursive_directory_iterator(sources)) {
    // Departures have codes of their own, which are those of causes.
    const std::string stem = entry.path().stem().string();
    if (entry.path().extension() != ".cc" || stem == "departures") {
      continue;
    }
    const std::string text = Content(entry.path());
    codes.merge(Matches(text, member));
    codes.merge(Matches(text, chosen));
    codes.merge(Matches(text, wide));
  }
  return codes;
}

TEST(FindingCodes, AreThoseThatTheIdentificationFinds) {
  std::set<std::string> codes;
  for (const FindingRow& row : kFindings) codes.emplace(row.code);
  EXPECT_EQ(EmittedCodes(), codes);
}

// --- whole sentences of the other branches

/// A fit whose loop slides, or has not been seen to.
FitResult FitThat(bool slides) {
  FitResult fit;
  fit.model = FindFrictionModel("jenkins");
  loop::LoopFacts& facts = fit.records.emplace_back().facts;
  facts.closed = true;
  facts.amplitude = 1e-6;
  facts.peak_force = 40.0;
  facts.half_gap = 40.0;
  facts.energy_ratio = slides ? 0.95 : 0.2;
  facts.sliding_fraction = slides ? 0.9 : 0.0;
  facts.plateau_slope = 0.0;
  facts.slope_after_reversal = 4e7;
  facts.energy_per_cycle = facts.energy_ratio * 4 * 1e-6 * 40.0;
  facts.sliding_amplitude = facts.energy_per_cycle / (4 * 40.0);
  return fit;
}

TEST(Sentence, AsksForALargerAmplitudeOnlyWhereTheLoopDoesNotSlide) {
  const FitResult sliding = FitThat(true);
  const FitResult sticking = FitThat(false);
  ASSERT_TRUE(loop::Slides(sliding.records[0].facts));
  ASSERT_FALSE(loop::Slides(sticking.records[0].facts));
  const auto both = [&](FindingCode code, const char* kind, const char* where_it_slides,
                        const char* elsewhere) {
    EXPECT_EQ(Sentence(Complete(code, kind), sliding, kUnitsOfForce), where_it_slides);
    EXPECT_EQ(Sentence(Complete(code, kind), sticking, kUnitsOfForce), elsewhere);
  };
  both("slip_force_bounded_below", "",
       "slip_force: the contact slides, but its force keeps changing meanwhile (T* = 12.5 N), as "
       "if slip were not reached: any larger slip force fits as well; the measured half gap "
       "remains valid",
       "slip_force: the loop (T* = 12.5 N at X = 1.75 µm) does not approach gross slip and fits "
       "any larger slip force as well; raise the amplitude until the force levels off (mindahl "
       "plan --record says how far)");
  both("alpha_not_identifiable", "with_slip_force",
       "alpha: the record determines only its combination with slip_force, since the force keeps "
       "changing while the contact slides; fix one of them",
       "alpha: the record determines only the ratio alpha/slip_force; raise the amplitude until "
       "the force levels off (mindahl plan --record says how far), or fix one of them");
  both("slip_force_extrapolated", "",
       "slip_force: it is the asymptote of a law with alpha = 0.0625, and the measured force "
       "reaches only 36 % of it although the contact slides; the measured half gap remains valid",
       "slip_force: it is the asymptote of a law with alpha = 0.0625, and the measured force "
       "reaches only 36 % of it; raise the amplitude until the force levels off");
  both("undetermined_combination", "",
       "the record determines only a combination of alpha, force_offset: fix one of them, or "
       "sample more densely after the reversals",
       "the record determines only a combination of alpha, force_offset: fix one of them, or "
       "record a larger amplitude");
  both("sigma_not_identifiable", "wide",
       "sigma: the 95 % interval 0.5 N/m … 21 N/m is too wide for a usable value; record more "
       "samples, or less noise (mindahl plan --record says which)",
       "sigma: the 95 % interval 0.5 N/m … 21 N/m is too wide for a usable value; record more "
       "samples, less noise or a larger amplitude (mindahl plan --record says which)");
}

TEST(Sentence, OfALoadSaysWhatFollowsItAndWhatDoesNot) {
  FitResult fit = FitThat(false);
  fit.model = FindFrictionModel("mindlin-dahl");
  const auto said = [&](FindingCode code) { return Sentence(Complete(code), fit, kUnitsOfForce); };
  EXPECT_EQ(said("load_followed"),
            "record 2: the normal load varies by ±5.5 %: the law follows it, with Tc = μN and σ ∝ "
            "N^α within the record; σ and Tc are given at its mean");
  EXPECT_EQ(said("load_not_followed"),
            "record 2: the normal load varies by ±5.5 %, which mindlin-dahl does not model: the "
            "fit takes the load as constant; keep to one load with --load-window, or use --model "
            "mindlin-dahl without a rig");
  fit.rig.stiffness = 8e7;
  fit.parameters = {testing::MadeParameter("asymmetry", "-", 0.1, 0.01)};
  EXPECT_THAT(said("load_not_followed"), HasSubstr("which mindlin-dahl behind a rig does not"));
  EXPECT_THAT(said("load_not_followed"), EndsWith("without a rig or an asymmetry"));
  fit.model = FindFrictionModel("dahl");
  EXPECT_THAT(said("load_followed"), EndsWith("with the force in proportion to it; σ and Tc are "
                                              "given at its mean magnitude"));
}

TEST(Sentence, OfAnInadequateModelNamesWhatIsNotToBeUsed) {
  FitResult fit = FitThat(false);
  fit.parameters = {testing::MadeParameter("sigma", "N/m", 4e7, 1e5)};
  Finding finding = Complete("model_inadequate");
  EXPECT_THAT(Sentence(finding, fit), HasSubstr(": its parameters are not to be used; what was"));
  fit.parameters[0].includes_discrepancy = true;
  EXPECT_THAT(Sentence(finding, fit), HasSubstr(": alpha, force_offset are not to be used"));
  finding.parameters = {"alpha"};
  EXPECT_THAT(Sentence(finding, fit), HasSubstr(": alpha is not to be used"));
}

TEST(Sentence, OfTheInitialStateSaysWhichIsAssumed) {
  FitResult fit = FitThat(false);
  const Finding finding = Complete("initial_state_undecided");
  fit.initial_state = InitialState::kVirgin;
  EXPECT_THAT(Sentence(finding, fit), HasSubstr("the values assume an unloaded contact, the"));
  fit.initial_state = InitialState::kSteady;
  EXPECT_THAT(Sentence(finding, fit), HasSubstr("the values assume a steady loop, the"));
}

TEST(Sentence, OfALoopThatExplainsNothingHasNoFraction) {
  Finding finding = Complete("loop_not_seen");
  for (const double r_squared : {0.0, -3.0}) {
    for (auto& [name, number] : finding.numbers) {
      if (name == "r_squared") number = r_squared;
    }
    EXPECT_THAT(Say(finding), HasSubstr("the fitted loop explains nothing of the force: the"));
  }
}

TEST(Sentence, OfTwoLawsHasTheEvidenceThatThereIs) {
  Finding finding = Complete("law_undecided", "dahl");
  EXPECT_EQ(Say(finding),
            "sigma, slip_force: the record does not distinguish Masing's law from Dahl's own law "
            "(ΔAICc = -31.5); the latter gives sigma = 32.5 N/µm and slip_force = 43.5 N; start "
            "from an unloaded contact, or record a second amplitude");
  std::erase_if(finding.numbers, [](const auto& number) { return number.first == "delta_aicc"; });
  finding.parameters = {"alpha"};
  EXPECT_THAT(Say(finding), HasSubstr("(they give the same steady loop at any one amplitude); "
                                      "start from"));
  // The sentence gives no numbers of a law whose slip force is not known.
  finding.parameters = {"sigma", "slip_force"};
  FitResult fit = FitThat(false);
  fit.parameters = {testing::MadeParameter("slip_force", "N", 40, 0.1)};
  fit.parameters[0].identifiability = Identifiability::kBoundedBelow;
  EXPECT_THAT(Sentence(finding, fit, kUnitsOfForce),
              AllOf(HasSubstr("gives sigma = 32.5 N/µm;"), Not(HasSubstr("slip_force ="))));
}

TEST(Sentence, OfAMisfitOfTheDisplacementSaysSo) {
  FitResult fit = FitThat(false);
  fit.response = loop::Channel::kDisplacement;
  const std::string said =
      Sentence(Complete("systematic_residual", "same_on_return"), fit, kUnitsOfForce);
  EXPECT_THAT(said, HasSubstr("rms 4 % of the displacement"));
  EXPECT_THAT(said, EndsWith("a nonlinear spring in series. The intervals include it"));
  EXPECT_THAT(Say(Complete("systematic_residual", "same_on_return")),
              EndsWith("a force that depends on the position. The intervals include it; compare "
                       "with --model auto"));
}

TEST(Sentence, OfASearchLimitHasTheUnitOfItsParameter) {
  FitResult fit = FitThat(false);
  Finding finding = Complete("search_limit");
  fit.parameters = {testing::MadeParameter("alpha", "N", 1, 0.1)};
  EXPECT_THAT(Sentence(finding, fit), HasSubstr("at its limit, 990 mN: "));
}

}  // namespace
}  // namespace mindahl::report::sentences_test
