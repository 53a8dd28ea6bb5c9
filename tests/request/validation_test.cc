#include "mindahl/request/validation.h"

#include <nlohmann/json.hpp>

#include "support/prelude.h"
#include "support/text.h"

// These tests concern the text and the JSON of a validation whose numbers are set by hand.
namespace mindahl::request::validation_test {
namespace {

Validation MadeByHand() {
  Validation validation;
  validation.options.cases = 14;
  validation.options.seed = 9;
  identification::ValidationReport& report = validation.report;
  report.rows = {{.lambda = 0.25,
                  .noise = 0.125,
                  .cases = 7,
                  .failures = 2,
                  .undetermined = 3,
                  .tolerance = 6.5,
                  .median_sigma_error = 1e-1,
                  .worst_sigma_error = 2e-1,
                  .median_alpha_error = 3e-1,
                  .worst_alpha_error = 4e-1,
                  .median_slip_force_error = 5e-1,
                  .worst_slip_force_error = 6e-1,
                  .worst_standardized = 7.5,
                  .coverage = 0.9375,
                  .intervals = {}},
                 {.lambda = 1.5,
                  .cases = 8,
                  .failures = 0,
                  .undetermined = 0,
                  .tolerance = 8.5,
                  .median_sigma_error = 1e-2,
                  .worst_sigma_error = 9e-2,
                  .median_alpha_error = 3e-2,
                  .worst_alpha_error = 4e-2,
                  .median_slip_force_error = 5e-2,
                  .worst_slip_force_error = 6e-2,
                  .worst_standardized = 1.0,
                  .coverage = 0.5,
                  .intervals = {}}};
  report.dahl_rows = {{.lambda = 2.5, .noise = 0.5, .tolerance = 0.5, .intervals = {}}};
  report.fits = 30;
  report.failures = 2;
  report.failed_cases = {"one", "two"};
  report.coverage = {{.parameter = "sigma", .all = {100, 95}, .sliding = {50, 45}, .chance = 0.25},
                     {.parameter = "alpha",
                      .by_dahl = true,
                      .all = {40, 10},
                      .sliding = {},
                      .chance = 0.0625,
                      .passed = false},
                     {.parameter = "slip_force", .all = {}, .sliding = {}}};
  report.failed_coverages = {"three"};
  return validation;
}

TEST(Validation, JsonHasEveryNumberUnderItsName) {
  auto json = nlohmann::json::parse(ToJson(MadeByHand()));
  json.erase("version");
  EXPECT_EQ(json, nlohmann::json::parse(R"({
    "schema": "mindahl.validate/1", "cases": 14, "seed": 9, "fits": 30, "failures": 2,
    "passed": false,
    "rows": [
      {"lambda": 0.25, "noise": 0.125, "cases": 7, "failures": 2, "not_identifiable": 3,
       "tolerance": 6.5, "sigma_error": {"median": 0.1, "worst": 0.2},
       "alpha_error": {"median": 0.3, "worst": 0.4},
       "slip_force_error": {"median": 0.5, "worst": 0.6},
       "worst_standard_errors": 7.5, "coverage": 0.9375},
      {"lambda": 1.5, "noise": 0, "cases": 8, "failures": 0, "not_identifiable": 0,
       "tolerance": 8.5, "sigma_error": {"median": 0.01, "worst": 0.09},
       "alpha_error": {"median": 0.03, "worst": 0.04},
       "slip_force_error": {"median": 0.05, "worst": 0.06}}],
    "dahl_rows": [
      {"lambda": 2.5, "noise": 0.5, "cases": 0, "failures": 0, "not_identifiable": 0,
       "tolerance": 0.5, "sigma_error": {"median": null, "worst": null},
       "alpha_error": {"median": null, "worst": null},
       "slip_force_error": {"median": null, "worst": null},
       "worst_standard_errors": null, "coverage": null}],
    "coverage": [
      {"law": "masing", "parameter": "sigma", "intervals": 100, "coverage": 0.95,
       "sliding_intervals": 50, "sliding_coverage": 0.9, "p_value": 0.25, "passed": true},
      {"law": "dahl", "parameter": "alpha", "intervals": 40, "coverage": 0.25,
       "sliding_intervals": 0, "sliding_coverage": null, "p_value": 0.0625, "passed": false},
      {"law": "masing", "parameter": "slip_force", "intervals": 0, "coverage": null,
       "sliding_intervals": 0, "sliding_coverage": null, "p_value": 1, "passed": true}],
    "failed_cases": ["one", "two"], "failed_coverages": ["three"]})"));
}

}  // namespace
}  // namespace mindahl::request::validation_test
