
#include <nlohmann/json.hpp>

#include "mindahl/report/report.h"
#include "report/made_report.h"
#include "support/prelude.h"

// The JSON from the library's side. tests/cli walks that of many runs of the program.
namespace mindahl::report::json_test {
namespace {

using namespace contact;

using nlohmann::json;
using report::MakeReport;
using report::ToJson;

json Parsed(report::ReportInput input) { return json::parse(ToJson(MakeReport(std::move(input)))); }

TEST(Json, HasTheNumbersOfTheFit) {
  const json fit = Parsed(MadeInput());
  EXPECT_EQ(fit["parameters"]["sigma"]["value"], testing::kSigma);
  EXPECT_EQ(fit["parameters"]["sigma"]["standard_error"], 0.01 * testing::kSigma);
  EXPECT_EQ(fit["parameters"]["sigma"]["ci95"][1], 1.02 * testing::kSigma);
  EXPECT_EQ(fit["input"]["files"][0], "loop_1.csv");
  EXPECT_EQ(fit["input"]["samples"], 9);
  EXPECT_EQ(fit["loop"]["amplitude"], testing::kMadeAmplitude);
}

TEST(InitialState, OfRecordsThatDifferIsMixedAndInTheTextThatOfEach) {
  const loop::Record record = testing::MadeRecord(1e-6);
  report::ReportInput input = testing::MadeInput({record, record}, 1e-6);
  input.fit.initial_state = input.fit.records[0].initial_state = models::InitialState::kSteady;
  input.fit.records[1].initial_state = models::InitialState::kVirgin;
  const report::Report report = MakeReport(std::move(input));
  EXPECT_EQ(json::parse(ToJson(report))["initial_state"], "mixed");
  EXPECT_THAT(ToText(report), HasSubstr("steady, virgin initial state"));
}

TEST(Json, NamesTheParameterForWhichThereIsNoCorrelation) {
  report::ReportInput input = MadeInput();
  const double none = std::numeric_limits<double>::quiet_NaN();
  input.fit.correlation = {1, none, 0, none, none, none, 0, none, 1};  // alpha is at its bound
  const json nulls = Parsed(std::move(input))["nulls"];
  for (const char* path : {"correlation.sigma.alpha", "correlation.alpha.sigma"}) {
    const json expected = {{"path", path}, {"why", "alpha is at a bound or undetermined"}};
    EXPECT_THAT(nulls, ::testing::Contains(expected));
  }
}

TEST(Json, HasEachPartThatIsTrimmed) {
  report::ReportInput input = MadeInput();
  input.trims = {{.samples = 9, .parts = {{.first = 1, .last = 5, .at_start = true}}}};
  const json trimmed = Parsed(std::move(input))["input"]["trimmed"];
  ASSERT_EQ(trimmed.size(), 1U);
  EXPECT_EQ(trimmed[0], json({{"file", "loop_1.csv"},
                              {"reason", "rest"},
                              {"first_line", 2},
                              {"last_line", 5},
                              {"samples", 4}}));
}

TEST(Json, HasTheTestsOfTheMapping) {
  report::ReportInput input = MadeInput();
  input.fit.parameters[1] = testing::MadeParameter("alpha", "-", 0.35, 0.01);
  const report::Report report = MakeReport(std::move(input));
  const json mapping = json::parse(ToJson(report))["mapping"];
  ASSERT_TRUE(report.alpha.z && report.alpha.p_value && report.alpha.minus_third);
  EXPECT_EQ(mapping["alpha_minus_third"], 0.35 - 1.0 / 3);
  EXPECT_EQ(mapping["z"], *report.alpha.z);
  EXPECT_GT(*report.alpha.z, 1.0) << "of an error of a hundredth or so";
  EXPECT_EQ(mapping["p_value"], *report.alpha.p_value);
}

TEST(Json, OfAnOpenIntervalNamesItsEnd) {
  report::ReportInput input = MadeInput();
  input.fit.parameters[2].upper95.reset();
  const json fit = Parsed(std::move(input));
  EXPECT_TRUE(fit["parameters"]["slip_force"]["ci95"][1].is_null());
  const json expected = {{"path", "parameters.slip_force.ci95[1]"},
                         {"why", "the record sets no limit there"}};
  EXPECT_THAT(fit["nulls"], ::testing::Contains(expected));
}

TEST(Json, OfAFitThatFailedIsNullForThatReason) {
  const json fit = Parsed(FailedInput());
  ASSERT_EQ(fit["warnings"].size(), 1u);
  EXPECT_EQ(fit["warnings"][0]["code"], "fit_failed");
  std::size_t of_the_fit = 0;
  std::size_t of_the_record = 0;
  for (const json& null : fit["nulls"]) {
    const bool is_measured = null["path"].get<std::string>().starts_with("measured.");
    of_the_record += is_measured && null["why"] == "the record closes no cycle" ? 1 : 0;
    of_the_fit += null["why"] == "the fit failed: no start led anywhere" ? 1 : 0;
  }
  // All but the normal load, which was not given, and what needs no fit.
  EXPECT_GT(of_the_record, 0u);
  EXPECT_EQ(of_the_fit + of_the_record + 1, fit["nulls"].size());
}

TEST(Json, EndsWithAnEndOfLine) { EXPECT_EQ(ToJson(MakeReport(MadeInput())).back(), '\n'); }

TEST(Json, ListsFirstFindingFirst) {
  report::ReportInput input = MadeInput();
  input.fit.findings.push_back(
      {.code = "shape_or_rig", .numbers = {{"rig_stiffness", 1e6}, {"alpha", 0.1}}});
  input.known.contact_radius = 2e-4;
  input.known.normal_load = 50.0;
  for (KnownBody* body : {&input.known.body_1, &input.known.body_2}) {
    *body = {.youngs_modulus = 2e11, .poisson_ratio = 0.3, .radius = 0.1};
  }
  const json warnings = Parsed(std::move(input))["warnings"];
  ASSERT_GE(warnings.size(), 2u);
  EXPECT_EQ(warnings[0]["code"], "shape_or_rig");
  EXPECT_EQ(warnings[1]["code"], "contact_redundant");
}

TEST(Json, HasNotesApartFromWhatToActOn) {
  report::ReportInput input = MadeInput();
  input.fit.findings = {{.code = "no_closed_cycle", .severity = identification::Severity::kNote},
                        {.code = "weights_not_settled"}};
  const json fit = Parsed(std::move(input));
  ASSERT_EQ(fit["notes"].size(), 1u);
  EXPECT_EQ(fit["notes"][0]["code"], "no_closed_cycle");
  ASSERT_EQ(fit["warnings"].size(), 1u);
  EXPECT_EQ(fit["warnings"][0]["code"], "weights_not_settled");
}

TEST(Json, HasTheGateOfTheWidestRecordAndTheOtherWhereItIsNotCertain) {
  report::ReportInput input = MadeInput();
  input.fit.records[0].gate = {.gate = 1e-7, .count = 1};
  json fit = Parsed(input);
  EXPECT_EQ(fit["reversals"], json({{"count", 1}, {"gate", 1e-7}, {"certain", true}}));
  input.fit.records[0].gate = {1e-7, 1, false, 40, 1e-9};
  input.fit.records[0].glitches = {.spikes = 2, .dropouts = 1, .held = 5};
  fit = Parsed(input);
  EXPECT_EQ(fit["reversals"]["other_count"], 40);
  EXPECT_EQ(fit["reversals"]["other_gate"], 1e-9);
  EXPECT_EQ(fit["input"]["glitches"], json({{"spikes", 2}, {"dropouts", 1}, {"held", 5}}));
}

/// The second of two records is the wider one; what a test sets is another number everywhere.
report::Report TwoRecords() {
  report::ReportInput input =
      testing::MadeInput({testing::MadeRecord(1e-6), testing::MadeRecord(2e-6, 7)}, 2e-6);
  input.fit.records[0].measures.amplitude = 1e-6;
  return MakeReport(std::move(input));
}

json JsonOf(const report::Report& report) { return json::parse(ToJson(report)); }

/// Nine twenty-fifths of whose variance are of the fit.
PropagatedValue MadeQuantity(double value, std::string_view input) {
  return {{value, 1.25}, 0.75, 1.0, input};
}

json MadeQuantityJson(double value, std::string_view input, std::string_view unit) {
  return {{"value", value},   {"standard_error", 1.25}, {"unit", unit},
          {"from_fit", 0.36}, {"from_inputs", 0.64},    {"largest_input", input}};
}

identification::ParameterEstimate Estimate(double value, double lower, double upper) {
  identification::ParameterEstimate estimate;
  estimate.value = value;
  estimate.lower95 = lower;
  estimate.upper95 = upper;
  return estimate;
}

TEST(Json, HasWhatWasReadOfEveryRecord) {
  report::Report report = TwoRecords();
  report.records[0].piece = {.normal_load = 20.5, .first_line = 2, .last_line = 10, .left_out = 3};
  report.records[1].piece = {.normal_load = 50.5, .first_line = 14, .last_line = 21, .left_out = 4};
  report.records[0].displacement.unit = "mm";
  report.records[0].force.unit = "kN";
  report.records[0].time.emplace().unit = "ms";
  report.records[0].normal_load.emplace().unit = "MN";
  report.fit.force_sense = -1;
  for (std::size_t r = 0; r < 2; ++r) {
    identification::RecordFit& record = report.fit.records[r];
    record.measures.cycles = 5 + 3 * r;
    record.reversals.resize(2 + 5 * r);
    record.left_out = 11 + 20 * r;
    record.gate = {.gate = 0.5 + static_cast<double>(r),
                   .count = 4,
                   .certain = false,
                   .other_count = 30 + r,
                   .other_gate = 2.5 + static_cast<double>(r)};
    record.glitches = {.spikes = 1 + r, .dropouts = 10 + r, .held = 100 + r};
    record.displacement_noise = 0.125 * static_cast<double>(r + 1);
    record.response_noise = 0.75 * static_cast<double>(r + 1);
    record.initial_state = r == 0 ? models::InitialState::kSteady : models::InitialState::kVirgin;
  }
  const json fit = JsonOf(report);
  EXPECT_EQ(fit["input"], json::parse(R"({
      "files": ["loop_1.csv", "loop_2.csv"], "samples": 23,
      "load_pieces": [{"file": "loop_1.csv", "normal_load": 20.5, "first_line": 2, "last_line": 10,
                       "samples": 9},
                      {"file": "loop_2.csv", "normal_load": 50.5, "first_line": 14, "last_line": 21,
                       "samples": 7}],
      "between_loads": 7, "cycles": 13, "reversals": 9,
      "units": {"displacement": "mm", "force": "kN", "time": "ms", "normal_load": "MN"},
      "left_out": 49, "reversal_gate": [0.5, 1.5], "displacement_noise": [0.125, 0.25],
      "initial_state": ["steady", "virgin"], "response_noise": [0.75, 1.5],
      "force_sign": "opposite", "glitches": {"spikes": 3, "dropouts": 21, "held": 201}})"));
  EXPECT_EQ(fit["reversals"], json::parse(R"({"count": 7, "gate": 1.5, "certain": false,
                                             "other_count": 31, "other_gate": 3.5})"));
}

TEST(Json, HasWhatTheWidestRecordMeasures) {
  report::Report report = TwoRecords();
  report.fit.records[0].facts.closed = true;
  report.fit.records[0].facts.half_gap = 99.0;
  report.fit.records[1].facts = {
      .closed = true,
      .cycles = {{.start = 3,
                  .amplitude = 1.5,
                  .peak_force = 2.5,
                  .energy = 3.5,
                  .energy_ratio = 0.25,
                  .half_gap = 4.5,
                  .centre_force = 5.5,
                  .sliding_amplitude = 6.5}},
      .steady_cycles = 1,
      .amplitude = 11.5,
      .peak_force = 12.5,
      .energy_per_cycle = 13.5,
      .energy_ratio = 0.125,
      .sliding_amplitude = 14.5,
      .sliding_fraction = 0.375,
      .half_gap = 15.5,
      .half_gap_standard_deviation = 16.5,
      .slope_after_reversal = 17.5,
      .plateau_slope = 18.5,
      .asymmetry = 0.0625,
      .path_ratio = 1.75,
      .energy_friction_coefficient = 0.625,
      .backlash = {{.width = 19.5, .force = 20.5}},
      .half_gap_trend = {{.slope = 21.5, .standard_error = 22.5, .p_value = 0.75}},
      .energy_trend = {{.slope = 23.5, .standard_error = 24.5, .p_value = 0.875}}};
  EXPECT_EQ(JsonOf(report)["measured"], json::parse(R"({
      "half_gap": {"value": 15.5, "standard_deviation": 16.5}, "sliding_amplitude": 14.5,
      "sliding_fraction": 0.375, "backlash": 19.5, "slope_after_reversal": 17.5,
      "plateau_slope": 18.5, "asymmetry": 0.0625, "energy_per_cycle": 13.5, "energy_ratio": 0.125,
      "path_ratio": 1.75, "energy_friction_coefficient": 0.625, "closed": true,
      "cycles": [{"start": 3, "amplitude": 1.5, "peak_force": 2.5, "half_gap": 4.5, "energy": 3.5,
                  "energy_ratio": 0.25, "sliding_amplitude": 6.5}],
      "trend": {"half_gap": {"slope": 21.5, "standard_error": 22.5, "p_value": 0.75},
                "energy": {"slope": 23.5, "standard_error": 24.5, "p_value": 0.875}}})"));
}

TEST(Json, HasTheLoopAsItIsDescribed) {
  report::Report report = TwoRecords();
  report.fit.records[1].measures = {
      .cycles = 1, .amplitude = 2.5, .centre = 3.5, .peak_force = 4.5, .energy_per_cycle = 5.5};
  report::LoopDescription& loop = report.loop.emplace();
  loop.model_energy = 6.5;
  loop.energy_ratio = 0.25;
  loop.gross_slip_displacement = 7.5;
  loop.gross_slip_energy_ratio = 0.375;
  loop.stick_radius_ratio = 0.5;
  loop.regime = report::SlipRegime::kPartial;
  EXPECT_EQ(JsonOf(report)["loop"], json::parse(R"({
      "amplitude": 2.5, "centre": 3.5, "peak_force": 4.5, "energy_per_cycle_measured": 5.5,
      "energy_per_cycle_model": 6.5, "energy_ratio": 0.25, "slip_regime": "partial",
      "gross_slip_displacement": 7.5, "gross_slip_energy_ratio": 0.375,
      "stick_radius_ratio": 0.5})"));
}

TEST(Json, HasTheResidualsAndWhatTheyLookLike) {
  report::Report report = TwoRecords();
  report.fit.residuals = {.rms = 1.5,
                          .max_abs = 2.5,
                          .normalized_rms = 0.25,
                          .r_squared = 0.5,
                          .durbin_watson = 0.75,
                          .effective_samples = 3.5,
                          .degrees_of_freedom = 4.5,
                          .samples = 16};
  report.fit.force_noise = 5.5;
  report.fit.outliers = 6;
  report.fit.adequacy = {
      .verdict = identification::AdequacyVerdict::kDoubtful,
      .misfit_over_noise = 7.5,
      .misfit = 8.5,
      .p_value = 0.125,
      .causes = {{.code = "lag",
                  .delta_aicc = -9.5,
                  .explains = 0.875,
                  .size = 10.5,
                  .unit = "s",
                  .option = "--lag fit",
                  .moves = 11.5},
                 {.code = "covariate", .size = 12.5, .unit = "", .option = "--gain x=C"}},
      .misfit_over_half_gap = 0.375,
      .use = identification::Use::kIndicative,
      .tried = 13};
  identification::ResidualStructure& structure = report.fit.records[1].structure;
  structure.repeatable_share = 0.4375;
  structure.directions[0] = {1, 3, 15.5, 16.5, {}};
  structure.directions[1] = {-1, 4, 17.5, 18.5, {{0.25, 19.5, 20.5}}};
  const json fit = JsonOf(report);
  EXPECT_EQ(fit["residuals"], json::parse(R"({
      "rms": 1.5, "max_abs": 2.5, "normalized_rms": 0.25, "r_squared": 0.5, "durbin_watson": 0.75,
      "effective_samples": 3.5, "degrees_of_freedom": 4.5, "channel": "force", "force_noise": 5.5,
      "outliers": 6})"));
  EXPECT_EQ(fit["adequacy"], json::parse(R"({
      "verdict": "doubtful", "misfit_over_noise": 7.5, "misfit_over_half_gap": 0.375,
      "use": "indicative", "p_value": 0.125,
      "causes": [{"code": "lag", "try": "--lag fit", "delta_aicc": -9.5, "explains": 0.875,
                  "size": 10.5, "unit": "s", "moves": 11.5},
                 {"code": "covariate", "try": null, "delta_aicc": 0.0, "explains": 0.0,
                  "size": null, "unit": null, "moves": 0.0}]})"));
  EXPECT_EQ(fit["residual_structure"][1],
            json::parse(R"({"repeatable_share": 0.4375, "directions": [
      {"direction": "up", "strokes": 3, "mean": 15.5, "rms": 16.5, "along_stroke": []},
      {"direction": "down", "strokes": 4, "mean": 17.5, "rms": 18.5,
       "along_stroke": [{"position": 0.25, "mean": 19.5, "standard_error": 20.5}]}]})"));
}

TEST(Json, HasNoNumbersOfAnAdequacyThatWasNotJudged) {
  report::Report report = TwoRecords();
  report.fit.adequacy.misfit_over_noise = 7.5;
  report.fit.adequacy.misfit_over_half_gap = 0.5;
  const json fit = JsonOf(report);
  ASSERT_EQ(fit["adequacy"].size(), 6U);
  for (const auto& [key, value] : fit["adequacy"].items()) {
    EXPECT_TRUE(value.is_null()) << key;
  }
}

TEST(Json, HasTheOtherLawAndTheModelsThatWereCompared) {
  report::Report report = TwoRecords();
  report.fit.law_choice = {.decided = true,
                           .preferred = models::FindFrictionModel("dahl"),
                           .alternative = models::FindFrictionModel("jenkins"),
                           .law = {1.5, 0.25, 2.5},
                           .delta_aicc = 3.5,
                           .likelihood_ratio = 4.5};
  report.contact_by_other_law.contact_radius = MadeQuantity(5.5, "");
  report.contact_by_other_law.equivalent_radius = MadeQuantity(6.5, "");
  identification::ModelSelection& selection = report.selection.emplace();
  selection.scores = {{.model = models::FindFrictionModel("dahl"),
                       .rig = true,
                       .free_parameters = 5,
                       .rms = 7.5,
                       .aicc = 8.5,
                       .delta_aicc = 9.5,
                       .akaike_weight = 0.125,
                       .held_out_rms = 10.5,
                       .held_out_standard_error = 11.5,
                       .converged = true,
                       .at_bound = false,
                       .redundant = true,
                       .remark = "as good"},
                      {}};
  selection.scores[1].model = models::FindFrictionModel("jenkins");
  selection.scores[1].at_bound = true;
  selection.chosen = 1;
  selection.indistinguishable = {1, 0};
  selection.effective_samples = 12.5;
  selection.held_out_cycles = 13;
  selection.verdict = "it is";
  identification::TermSelection& terms = report.terms.emplace();
  terms.considered = {{"lag", 0.25, 0.375, true, false, "unphysical"},
                      {"offset", 0.5, 0.625, false, true, ""}};
  terms.added = {"offset"};
  terms.held_out_parts = 14;
  terms.estimates = 15;
  const json fit = JsonOf(report);
  EXPECT_EQ(fit["law"], json::parse(R"({
      "decided": true, "preferred": "dahl", "delta_aicc": 3.5, "likelihood_ratio": 4.5,
      "alternatives": [{"law": "jenkins", "sigma": 1.5, "alpha": 0.25, "slip_force": 2.5,
                        "contact_radius": 5.5, "equivalent_radius": 6.5}]})"));
  json models = fit["model_selection"];
  ASSERT_EQ(models["models"].size(), 2U);
  EXPECT_EQ(models["models"][0], json::parse(R"({
      "model": "dahl", "rig": true, "free_parameters": 5, "rms": 7.5, "aicc": 8.5,
      "delta_aicc": 9.5, "akaike_weight": 0.125, "held_out_rms": 10.5,
      "held_out_standard_error": 11.5, "converged": true, "at_bound": false, "redundant": true,
      "remark": "as good"})"));
  EXPECT_EQ(models["models"][1]["at_bound"], true);
  EXPECT_EQ(models["models"][1]["converged"], false);
  models.erase("models");
  EXPECT_EQ(models, json::parse(R"({"chosen": 1, "indistinguishable": [1, 0],
      "effective_samples": 12.5, "held_out_cycles": 13, "verdict": "it is"})"));
  EXPECT_EQ(fit["terms"], json::parse(R"({
      "mode": "auto", "added": ["offset"], "held_out_parts": 14, "fits": 15,
      "considered": [{"name": "lag", "gain": 0.25, "p": 0.375, "predicted": true, "added": false,
                      "obstacle": "unphysical"},
                     {"name": "offset", "gain": 0.5, "p": 0.625, "predicted": false, "added": true,
                      "obstacle": ""}]})"));
}

TEST(Json, HasTheSolverAndEveryStart) {
  report::Report report = TwoRecords();
  report.fit.solver = {"solve", "CONVERGENCE", "done", 17, 1.5, 2.5};
  report.fit.starts = {{true, {3.5, 0.25, 4.5}, 5.5, {6.5, 0.375, 7.5}, 8.5, true}, {}};
  json solver = JsonOf(report)["solver"];
  ASSERT_EQ(solver["starts"].size(), 2U);
  EXPECT_EQ(solver["starts"][0], json::parse(R"({
      "from": "seed", "start": {"sigma": 3.5, "alpha": 0.25, "slip_force": 4.5},
      "initial_rms": 5.5, "reached": {"sigma": 6.5, "alpha": 0.375, "slip_force": 7.5},
      "final_rms": 8.5, "converged": true})"));
  EXPECT_EQ(solver["starts"][1]["from"], "grid");
  EXPECT_EQ(solver["starts"][1]["converged"], false);
  solver.erase("starts");
  EXPECT_EQ(solver, json::parse(R"({"converged": true, "iterations": 17, "solver": "solve",
      "termination": "CONVERGENCE", "message": "done", "initial_cost": 1.5, "final_cost": 2.5})"));
}

TEST(Json, HasEverythingOfAParameter) {
  report::Report report = TwoRecords();
  identification::ParameterEstimate& sigma = report.fit.parameters[0];
  sigma.value = 40.0;
  sigma.standard_error = 1.5;
  sigma.lower95 = 30.5;
  sigma.upper95 = 50.5;
  sigma.repeat_error = 2.5;
  sigma.interval = {{identification::IntervalSource::kProfile, 31.5, 41.5}};
  sigma.prior = {{.value = 35.5, .standard_uncertainty = 3.5}};
  sigma.without_priors = {{.value = 42.0, .standard_error = 0.5}};
  sigma.identifiability = identification::Identifiability::kEffective;
  report.fit.correlation = {1, 0.25, 0.5, 0.25, 1, 0.75, 0.5, 0.75, 1};
  report.fit.regions = {
      {{.parameters = {"sigma", "alpha"}, .boundary = {{1.5, 2.5}, {3.5, 4.5}}, .closed = false}}};
  report.fit.confidence = 0.875;
  const json fit = JsonOf(report);
  EXPECT_EQ(fit["parameters"]["sigma"], json::parse(R"({
      "value": 40.0, "unit": "N/m", "standard_error": 1.5, "repeat_error": 2.5,
      "ci95": [30.5, 50.5], "ci95_parts": [{"source": "profile", "ci95": [31.5, 41.5]}],
      "prior": {"value": 35.5, "standard_uncertainty": 3.5},
      "without_priors": {"value": 42.0, "standard_error": 0.5, "moved": -4.0},
      "status": "free", "identifiability": "effective"})"));
  EXPECT_EQ(fit["correlation"], json::parse(R"({
      "sigma": {"sigma": 1.0, "alpha": 0.25, "slip_force": 0.5},
      "alpha": {"sigma": 0.25, "alpha": 1.0, "slip_force": 0.75},
      "slip_force": {"sigma": 0.5, "alpha": 0.75, "slip_force": 1.0}})"));
  EXPECT_EQ(fit["regions"], json::parse(R"([{"parameters": ["sigma", "alpha"], "closed": false,
                                            "boundary": [[1.5, 2.5], [3.5, 4.5]]}])"));
  EXPECT_EQ(fit["confidence"], 0.875);
}

/// Rounds fractions of a variance.
json Rounded(json value) {
  for (json& member : value) {
    if (member.is_structured()) member = Rounded(member);
    if (member.is_number_float()) member = std::round(1e9 * member.get<double>()) / 1e9;
  }
  return value;
}

TEST(Json, HasTheContactAndTheTestsOfTheMapping) {
  report::Report report = TwoRecords();
  report.slip_forces = {.positive = {1.5, 2.5, 3.5, 4.5}, .negative = {5.5, 6.5, 7.5, 8.5}};
  report.fit.parameters.push_back(testing::MadeParameter("asymmetry", "-", 0.25, 0.01));
  report.fit.correlation.assign(16, 0.0);
  report.contact.contact_radius = MadeQuantity(9.5, "nu1");
  report.contact.maximum_pressure = MadeQuantity(10.5, "R1");
  report.contact.equivalent_radius = MadeQuantity(11.5, "R2");
  report.contact.tangential_compliance = MadeQuantity(12.5, "a");
  report.contact.gross_slip_displacement = MadeQuantity(13.5, "E1");
  report.known.normal_load = 14.5;
  contact::HertzPrediction hertz;
  hertz.contact_radius = MadeQuantity(15.5, "");
  hertz.tangential_stiffness = {{16.5, 2.25}, 0, 0, ""};
  hertz.gross_slip_displacement = MadeQuantity(17.5, "E1");
  hertz.equivalent_radius = {{18.5, 3.25}, 0, 0, ""};
  hertz.maximum_pressure = {{19.5, 4.25}, 0, 0, ""};
  hertz.sigma_over_hertz_mindlin = MadeQuantity(20.5, "E2");
  hertz.gross_slip_displacement_ratio = MadeQuantity(21.5, "nu2");
  report.contact.hertz = hertz;
  report.alpha = {.minus_third = 0.125,
                  .is_rejected = true,
                  .z = 22.5,
                  .p_value = 0.25,
                  .likelihood = {{23.5, 0.375, {}}}};
  report.fit.mindlin_test = {.likelihood_ratio = 0.0, .p_value = 0.0, .rig_stiffness = 24.5};
  report.stiffness = {{.radius = "given",
                       .ratio = MadeQuantity(26.5, "a"),
                       .interval95 = {{27.5, 28.5}},
                       .z = 29.5,
                       .p_value = 0.75},
                      {.radius = "hertz", .ratio = {{30.5, 0.0}, 0, 0, ""}}};
  const json fit = JsonOf(report);
  EXPECT_EQ(fit["slip_forces"], json::parse(R"({
      "positive": {"value": 1.5, "standard_error": 2.5, "ci95": [3.5, 4.5]},
      "negative": {"value": 5.5, "standard_error": 6.5, "ci95": [7.5, 8.5]}})"));
  const json contact = Rounded(fit["contact"]);
  EXPECT_EQ(contact["contact_radius"], MadeQuantityJson(9.5, "nu1", "m"));
  EXPECT_EQ(contact["maximum_pressure"], MadeQuantityJson(10.5, "R1", "Pa"));
  EXPECT_EQ(contact["equivalent_radius"], MadeQuantityJson(11.5, "R2", "m"));
  EXPECT_EQ(contact["compliance"], MadeQuantityJson(12.5, "a", "1/Pa"));
  EXPECT_EQ(contact["mindlin_gross_slip_displacement"], MadeQuantityJson(13.5, "E1", "m"));
  EXPECT_EQ(contact["normal_load"], 14.5);
  json predicted = contact["hertz_mindlin"];
  const json ratios = predicted["measured_over_predicted"];
  EXPECT_EQ(ratios["contact_radius"], MadeQuantityJson(20.5, "E2", "-"));
  EXPECT_EQ(ratios["sigma"], MadeQuantityJson(20.5, "E2", "-"));
  EXPECT_EQ(ratios["gross_slip_displacement"], MadeQuantityJson(21.5, "nu2", "-"));
  EXPECT_EQ(predicted["gross_slip_displacement"], MadeQuantityJson(17.5, "E1", "m"));
  predicted.erase("measured_over_predicted");
  predicted.erase("gross_slip_displacement");
  EXPECT_EQ(predicted, json::parse(R"({
      "contact_radius": 15.5, "contact_radius_standard_error": 1.25, "sigma": 16.5,
      "sigma_standard_error": 2.25, "equivalent_radius": 18.5,
      "equivalent_radius_standard_error": 3.25, "maximum_pressure": 19.5,
      "maximum_pressure_standard_error": 4.25})"));
  json mapping = Rounded(fit["mapping"]);
  json tests = mapping["stiffness_tests"];
  mapping.erase("stiffness_tests");
  EXPECT_EQ(mapping, json::parse(R"({
      "alpha_minus_third": 0.125, "z": 22.5, "p_value": 0.25, "likelihood_ratio": 23.5,
      "likelihood_ratio_p_value": 0.375, "tenable_with_rig_stiffness": 24.5,
      "sigma_over_hertz_mindlin": 26.5, "sigma_over_hertz_mindlin_standard_error": 1.25})"));
  ASSERT_EQ(tests.size(), 2U);
  EXPECT_EQ(tests[1]["radius"], "hertz");
  EXPECT_EQ(tests[1]["value"], 30.5);
  json given = MadeQuantityJson(26.5, "a", "-");
  given.update({{"radius", "given"}, {"ci95", {27.5, 28.5}}, {"z", 29.5}, {"p_value", 0.75}});
  EXPECT_EQ(tests[0], given);
}

TEST(Json, HasTheLoadSeries) {
  report::Report report = TwoRecords();
  report.fit.normal_load = 1.5;
  report.load_series = {
      .contacts = {{.normal_load = 2.5,
                    .stiffness = {3.5, 4.5},
                    .slip_force = {5.5, 6.5},
                    .contact_radius = {{7.5, 8.5}},
                    .hertz_radius = 9.5,
                    .alone = {{Estimate(10.5, 11.5, 12.5), Estimate(13.5, 14.5, 15.5)}}}},
      .hypotheses = {{"cone", 0.25, 0.375, 16.5, 0.125}},
      .laws = {{.name = "cone",
                .exponent = 0.5,
                .stiffness = {17.5, 18.5},
                .stiffness95 = {{19.5, 20.5}},
                .quantities = {{.key = "equivalent_radius",
                                .unit = "m",
                                .label = "",
                                .formula = "",
                                .value = MadeQuantity(21.5, "E1"),
                                .interval95 = {{22.5, 23.5}},
                                .predicted = 24.5}},
                .unidentified = ""}}};
  for (identification::ParameterEstimate* estimate :
       {&report.load_series->contacts[0].alone->stiffness,
        &report.load_series->contacts[0].alone->slip_force}) {
    estimate->identifiability = identification::Identifiability::kIdentifiable;
  }
  json series = Rounded(JsonOf(report)["load_series"]);
  json quantity = MadeQuantityJson(21.5, "E1", "m");
  quantity.update({{"ci95", {22.5, 23.5}}, {"predicted", 24.5}});
  EXPECT_EQ(series["laws"][0]["quantities"], json({{"equivalent_radius", quantity}}));
  series["laws"][0].erase("quantities");
  EXPECT_EQ(series, json::parse(R"({
      "reference_load": 1.5,
      "records": [{"normal_load": 2.5, "sigma": {"value": 3.5, "standard_error": 4.5},
                   "slip_force": {"value": 5.5, "standard_error": 6.5},
                   "alone": {"sigma": {"value": 10.5, "ci95": [11.5, 12.5]},
                             "slip_force": {"value": 13.5, "ci95": [14.5, 15.5]}},
                   "contact_radius": 7.5, "hertz_contact_radius": 9.5}],
      "hypotheses": [{"name": "cone", "exponent": 0.25, "difference": 0.375, "z": 16.5,
                      "p_value": 0.125}],
      "laws": [{"name": "cone", "exponent": 0.5,
                "sigma": {"value": 17.5, "standard_error": 18.5, "ci95": [19.5, 20.5]}}]})"));
}

TEST(MakeReport, RefusesWhatDoesNotBelongTogether) {
  report::ReportInput unnamed = MadeInput();
  unnamed.files.clear();
  EXPECT_THROW(MakeReport(std::move(unnamed)), InvalidArgument);
  report::ReportInput without_record = MadeInput();
  without_record.records.clear();
  EXPECT_THROW(MakeReport(std::move(without_record)), InvalidArgument);
  report::ReportInput other_record = MadeInput();
  other_record.records[0].record = testing::MadeRecord(1e-6, 5);
  EXPECT_THROW(MakeReport(std::move(other_record)), InvalidArgument);
  report::ReportInput unloaded = MadeInput();
  unloaded.load_window = {1, 2};
  EXPECT_THROW(MakeReport(std::move(unloaded)), InvalidArgument);
  EXPECT_THROW(MakeReport({}), InvalidArgument);
}

}  // namespace
}  // namespace mindahl::report::json_test
