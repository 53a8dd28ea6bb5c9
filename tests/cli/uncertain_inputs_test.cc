

#include "cli/command_line.h"
#include "cli/contact_options.h"
#include "io/temporary_directory.h"
#include "support/prelude.h"

// What is known of the contact, with its standard uncertainty: how it is read, and what becomes of
// it in every command that takes it.
namespace mindahl::cli::uncertain_inputs_test {
namespace {

using namespace contact;

using cli::ParseUncertainValue;
using nlohmann::json;
using Words = std::vector<std::string>;

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
// Closed forms of fewer than forty roundings.
constexpr double kRounding = 64 * kEpsilon;

struct Reading {
  const char* text;
  double value;
  double standard_error;
};

TEST(ParseUncertainValue, ReadsANumberWithEverySeparatorAndInPercent) {
  for (const Reading& reading : std::vector<Reading>{{"0.01", 0.01, 0},
                                                     {"1e-2", 0.01, 0},
                                                     {"+5", 5, 0},
                                                     {"0.01±0.0001", 0.01, 1e-4},
                                                     {"0.01+-0.0001", 0.01, 1e-4},
                                                     {"0.01+/-0.0001", 0.01, 1e-4},
                                                     {"0.01 ± 0.0001", 0.01, 1e-4},
                                                     {" 1e-2+-1e-4 ", 0.01, 1e-4},
                                                     {"1e+2+-1e+1", 100, 10},
                                                     {"50±1%", 50, 0.5},
                                                     {"50 +/- 1 %", 50, 0.5},
                                                     {"-0.05±2%", -0.05, 1e-3},
                                                     {"-0.05+-0.001", -0.05, 1e-3},
                                                     {"50±0", 50, 0},
                                                     {"0±0.01", 0, 0.01}}) {
    SCOPED_TRACE(reading.text);
    const UncertainValue value = ParseUncertainValue(reading.text, "--x");
    EXPECT_EQ(value.value, reading.value);
    // A percentage rounds twice.
    EXPECT_NEAR(value.standard_error, reading.standard_error,
                2 * kEpsilon * reading.standard_error);
  }
  EXPECT_TRUE(std::isinf(ParseUncertainValue("inf", "--x").value));
  EXPECT_EQ(ParseUncertainValue("inf", "--x").standard_error, 0.0);
}

TEST(UncertainInput, ThatCannotBeReadIsRefusedWithOneLineThatSaysHowToWriteIt) {
  for (const char* text : {"x", "", "±", "0.01±", "±0.1", "0.01±x", "0.01%", "1±2±3", "1%±2",
                           "0.01 0.001", "1+0.1", "1±1%%", "0,01±0.001"}) {
    SCOPED_TRACE(text);
    const Outcome outcome = RunCommand({"fit", SampleRecord(), "--radius-1", text});
    EXPECT_EQ(outcome.status, cli::kBadInput);
    EXPECT_THAT(outcome.out, IsEmpty());
    EXPECT_EQ(outcome.err,
              "mindahl fit: --radius-1: '" + std::string(text) +
                  "' is not a number, nor a number with its standard uncertainty: write 50, "
                  "50±0.5, 50+-0.5, 50+/-0.5 or 50±1%\n");
  }
}

TEST(UncertainInput, WithAnUncertaintyThatIsNoneIsRefused) {
  const auto message = [](const char* text) {
    const Outcome outcome = RunCommand({"fit", SampleRecord(), "--normal-load", text});
    EXPECT_EQ(outcome.status, cli::kBadInput) << text;
    EXPECT_THAT(outcome.out, IsEmpty());
    return outcome.err;
  };
  const auto expected = [](const std::string& text, const std::string& uncertainty) {
    return "mindahl fit: --normal-load: the standard uncertainty in '" + text + "' is " +
           uncertainty + ": must be finite and >= 0; leave it out where the value is exact\n";
  };
  EXPECT_EQ(message("50±-1"), expected("50±-1", "-1"));
  EXPECT_EQ(message("50+--1%"), expected("50+--1%", "-0.5"));
  EXPECT_EQ(message("50±nan"), expected("50±nan", "nan"));
  EXPECT_EQ(message("50±inf"), expected("50±inf", "inf"));
  EXPECT_EQ(message("1e308±1e3%"), expected("1e308±1e3%", "inf"));
}

TEST(UncertainInput, IsHeldToTheRuleOfItsValue) {
  const auto message = [](const Words& words) {
    Words all = {"fit", SampleRecord()};
    all.insert(all.end(), words.begin(), words.end());
    const Outcome outcome = RunCommand(all);
    EXPECT_EQ(outcome.status, cli::kBadInput);
    return outcome.err;
  };
  EXPECT_EQ(message({"--normal-load", "-50±1"}),
            "mindahl fit: --normal-load [N] = -50 is invalid: must be finite and > 0\n");
  EXPECT_EQ(message({"--poisson-1", "0.6±0.1"}),
            "mindahl fit: --poisson-1 [-] = 0.6 is invalid: must be > -1 and <= 0.5\n");
  EXPECT_EQ(message({"--radius-2", "0±1"}),
            "mindahl fit: --radius-2 [m] = 0 is invalid: must be a number other than 0; inf is a "
            "plane\n");
  EXPECT_EQ(message({"--radius-2", "inf±1"}),
            "mindahl fit: --radius-2: the standard uncertainty 1 of a plane is invalid: a plane is "
            "exact, write inf\n");
}

json FitJson(const Words& words) {
  Words all = {"fit", SampleRecord(), "--json", "-"};
  all.insert(all.end(), words.begin(), words.end());
  const Outcome outcome = RunCommand(all);
  EXPECT_EQ(outcome.status, cli::kDone) << outcome.err;
  return outcome.Json();
}

double Number(const json& value) { return value.get<double>(); }

TEST(UncertainInput, OfAFitAddsItsVarianceToThatOfTheFit) {
  const json exact = FitJson({"--normal-load", "50"})["contact"]["friction_coefficient"];
  const json friction = FitJson({"--normal-load", "50±1%"})["contact"]["friction_coefficient"];
  EXPECT_EQ(friction["value"], exact["value"]);
  const double from_fit = Number(exact["standard_error"]);
  const double from_load = 0.01 * Number(exact["value"]);
  EXPECT_NEAR(Number(friction["standard_error"]) / std::hypot(from_fit, from_load), 1, kRounding);
  const double share = from_fit * from_fit / (from_fit * from_fit + from_load * from_load);
  EXPECT_NEAR(Number(friction["from_fit"]), share, kRounding);
  EXPECT_NEAR(Number(friction["from_inputs"]), 1 - share, kRounding);
  EXPECT_EQ(friction["largest_input"], "normal load");
  EXPECT_EQ(exact["from_fit"], 1.0);
  EXPECT_EQ(exact["from_inputs"], 0.0);
  EXPECT_FALSE(exact.contains("largest_input"));
}

TEST(UncertainInput, MayStandInTheConfigurationFile) {
  const TemporaryDirectory directory;
  const json by_option = FitJson({"--normal-load", "50±0.5", "--compliance", "4.2e-11±2%"});
  for (const char* toml : {"normal-load = \"50±0.5\"\ncompliance = \"4.2e-11 +- 2%\"\n",
                           "[fit]\nnormal-load = \"50 +/- 0.5\"\ncompliance = \"4.2e-11±2%\"\n"}) {
    SCOPED_TRACE(toml);
    const std::string path = directory.Write("options.toml", toml).string();
    EXPECT_EQ(FitJson({"--config", path})["contact"], by_option["contact"]);
  }
  const std::string path = directory.Write("bad.toml", "normal-load = \"50±x\"\n").string();
  const Outcome outcome = RunCommand({"fit", SampleRecord(), "--config", path});
  EXPECT_EQ(outcome.status, cli::kBadInput);
  EXPECT_THAT(outcome.err, HasSubstr("--normal-load: '50±x' is not a number"));
}

TEST(Fit, UsesTheCorrelationOfStiffnessAndSlipForce) {
  const json fit = FitJson({});
  const auto relative_error = [&](const char* name) {
    const json& parameter = fit["parameters"][name];
    return Number(parameter["standard_error"]) / Number(parameter["value"]);
  };
  const double sigma = relative_error("sigma");
  const double slip_force = relative_error("slip_force");
  const double correlation = Number(fit["correlation"]["sigma"]["slip_force"]);
  ASSERT_GT(std::abs(correlation), 0.05) << "or the record tests nothing";
  const json& displacement = fit["contact"]["mindlin_gross_slip_displacement"];
  EXPECT_NEAR(Number(displacement["value"]),
              1.5 * Number(fit["parameters"]["slip_force"]["value"]) /
                  Number(fit["parameters"]["sigma"]["value"]),
              kRounding * Number(displacement["value"]));
  // δc = 3Tc/(2σ)
  const double variance =
      sigma * sigma + slip_force * slip_force - 2 * correlation * sigma * slip_force;
  EXPECT_NEAR(Number(displacement["standard_error"]) /
                  (Number(displacement["value"]) * std::sqrt(variance)),
              1, kRounding);
}

TEST(Fit, TestsTheStiffnessAgainstEveryRadiusThatIsKnown) {
  const Words bodies = {"--normal-load",      "50±1%", "--youngs-modulus-1", "210e9±2%",
                        "--youngs-modulus-2", "210e9", "--poisson-1",        "0.3±0.01",
                        "--poisson-2",        "0.3",   "--radius-1",         "0.05±1%",
                        "--radius-2",         "inf"};
  Words both = bodies;
  both.insert(both.end(), {"--contact-radius", "2.5e-4±1%"});
  const json fit = FitJson(both);
  const json& tests = fit["mapping"]["stiffness_tests"];
  ASSERT_THAT(tests, SizeIs(2));
  EXPECT_EQ(tests[0]["radius"], "hertz");
  EXPECT_EQ(tests[1]["radius"], "given");
  EXPECT_EQ(tests[0]["value"], fit["mapping"]["sigma_over_hertz_mindlin"]);
  EXPECT_EQ(tests[0]["standard_error"], fit["mapping"]["sigma_over_hertz_mindlin_standard_error"]);
  for (const json& test : tests) {
    const double half_width = 0.5 * (Number(test["ci95"][1]) - Number(test["ci95"][0]));
    const double error = Number(test["standard_error"]);
    EXPECT_NEAR(Number(test["z"]), (Number(test["value"]) - 1) / error, 1e-9) << "ratio near 1";
    // Student's quantile for more than a thousand effective degrees of freedom, as the fit has 600
    // of them and a small share: the normal one and at most a quarter of a percent.
    EXPECT_GE(half_width / error, 1.95996);
    EXPECT_LE(half_width / error, 1.0025 * 1.95996);
    const bool covers = Number(test["ci95"][0]) < 1 && 1 < Number(test["ci95"][1]);
    EXPECT_EQ(covers, Number(test["p_value"]) > 0.05);
  }
  EXPECT_THAT(FitJson(bodies)["mapping"]["stiffness_tests"], SizeIs(1));
  EXPECT_THAT(FitJson({})["mapping"]["stiffness_tests"], IsEmpty());
}

TEST(Fit, TakesTheNormalQuantileWhereInputsAloneAreUncertain) {
  // The record was simulated with G* = 4.2e-11 1/Pa and a = 0.25329 mm; here σ is held.
  const json fit = FitJson(
      {"--fix", "sigma=4.8e7", "--contact-radius", "2.5e-4±3%", "--compliance", "4.2e-11±4%"});
  const json& test = fit["mapping"]["stiffness_tests"][0];
  const double ratio = 4.8e7 * 4.2e-11 / (8 * 2.5e-4);
  EXPECT_NEAR(Number(test["value"]), ratio, kRounding);
  EXPECT_NEAR(Number(test["standard_error"]), 0.05 * ratio, kRounding);  // 3² + 4² = 5²
  EXPECT_EQ(test["from_fit"], 0.0);
  EXPECT_EQ(test["from_inputs"], 1.0);
  EXPECT_EQ(test["largest_input"], "tangential compliance");
  constexpr double kNormalQuantile = 1.959963984540054;  // Φ⁻¹(0.975), any table
  // erf is good to a few ulp, its inverse too.
  EXPECT_NEAR(Number(test["ci95"][1]), ratio * (1 + 0.05 * kNormalQuantile), 100 * kEpsilon);
  EXPECT_NEAR(Number(test["p_value"]), std::erfc(std::abs(ratio - 1) / (0.05 * ratio) / M_SQRT2),
              1e-12);
}

TEST(Fit, SaysThatNothingIsTestedWhereNothingIsUncertain) {
  const json fit =
      FitJson({"--fix", "sigma=4.8e7", "--contact-radius", "2.5e-4", "--compliance", "4.2e-11"});
  const json& test = fit["mapping"]["stiffness_tests"][0];
  EXPECT_TRUE(test["z"].is_null());
  EXPECT_TRUE(test["p_value"].is_null());
  EXPECT_TRUE(test["ci95"][0].is_null());
  std::size_t explained = 0;
  for (const json& null : fit["nulls"]) {
    const std::string path = null["path"];
    if (!path.starts_with("mapping.stiffness_tests[0].")) continue;
    EXPECT_EQ(null["why"], "neither sigma nor an input is uncertain") << path;
    ++explained;
  }
  EXPECT_EQ(explained, 4u);  // z, p_value and both ends of the interval
}

TEST(Fit, ComparesWithHertzAndItsUncertainty) {
  const json hertz =
      FitJson({"--normal-load", "50±3%", "--youngs-modulus-1", "210e9", "--youngs-modulus-2",
               "210e9", "--poisson-1", "0.3", "--poisson-2", "0.3", "--radius-1", "0.05±6%",
               "--radius-2", "inf"})["contact"]["hertz_mindlin"];
  // a = ∛(3Nρ/(4E*)), σ ∝ a, ρ = R₁
  const double error = std::hypot(0.03, 0.06) / 3;
  EXPECT_NEAR(Number(hertz["contact_radius_standard_error"]) / Number(hertz["contact_radius"]),
              error, kRounding);
  EXPECT_NEAR(Number(hertz["sigma_standard_error"]) / Number(hertz["sigma"]), error, kRounding);
  EXPECT_NEAR(Number(hertz["equivalent_radius_standard_error"]), 0.06 * 0.05, kRounding);
  const json& ratios = hertz["measured_over_predicted"];
  for (const char* name : {"contact_radius", "sigma", "gross_slip_displacement"}) {
    EXPECT_NEAR(Number(ratios[name]["value"]), 1, 0.01) << name;  // as simulated, noise aside
    EXPECT_GT(Number(ratios[name]["standard_error"]), error * Number(ratios[name]["value"]));
    EXPECT_EQ(ratios[name]["largest_input"], "radius of body 1");
  }
}

TEST(Fit, ReportsErrorAndWhatToMeasureBetter) {
  const std::string text =
      RunCommand({"fit", SampleRecord(), "--normal-load", "50±1%", "--compliance", "4.2e-11"}).out;
  EXPECT_THAT(text, HasSubstr("± 0.003"));
  EXPECT_THAT(text, HasSubstr("variance: fit 0 %, inputs 100 %, mostly the normal load"));
  EXPECT_THAT(RunCommand({"fit", SampleRecord(), "--normal-load", "50"}).out,
              Not(HasSubstr("variance:")));
}

TEST(Compliance, IsDefinedInEveryReportThatUsesIt) {
  const std::string definition = "G* = (2−ν₁)/G₁ + (2−ν₂)/G₂ [1/Pa], a compliance";
  EXPECT_THAT(RunCommand({"fit", SampleRecord(), "--compliance", "4.2e-11"}).out,
              HasSubstr(definition));
  EXPECT_THAT(RunCommand({"fit", SampleRecord()}).out, Not(HasSubstr("a compliance")));
  const json fit = FitJson({});
  EXPECT_EQ(fit["contact"]["compliance_definition"], "G* = (2-nu1)/G1 + (2-nu2)/G2");
  EXPECT_EQ(fit["contact"]["compliance_unit"], "1/Pa");
  const Words contact = {"contact",          "--friction", "0.3",          "--normal-load", "100",
                         "--contact-radius", "1e-3",       "--compliance", "4e-11"};
  EXPECT_THAT(RunCommand(contact).out,
              HasSubstr("1/Pa  G* = (2-nu1)/G1 + (2-nu2)/G2, a compliance"));
  Words to_json = contact;
  to_json.insert(to_json.end(), {"--json", "-"});
  const json contact_json = RunCommand(to_json).Json();
  EXPECT_EQ(contact_json["compliance_definition"], "G* = (2-nu1)/G1 + (2-nu2)/G2");
  EXPECT_EQ(contact_json["compliance_unit"], "1/Pa");
}

TEST(Contact, CarriesUncertaintyToEveryQuantity) {
  const Outcome outcome =
      RunCommand({"contact", "--friction", "0.3±3%", "--normal-load", "100±4%", "--contact-radius",
                  "1e-3±12%", "--compliance", "4e-11±5%", "--json", "-"});
  ASSERT_EQ(outcome.status, cli::kDone) << outcome.err;
  const json contact = outcome.Json();
  const auto relative_error = [&](const char* section, const char* name) {
    const json& quantity = contact[section][name];
    return Number(quantity["standard_error"]) / Number(quantity["value"]);
  };
  EXPECT_NEAR(relative_error("parameters", "slip_force"), 0.05, kRounding);  // 3, 4
  EXPECT_NEAR(relative_error("parameters", "sigma"), 0.13, kRounding);       // 5, 12
  EXPECT_NEAR(relative_error("contact", "maximum_pressure"), std::hypot(0.04, 0.24), kRounding);
  EXPECT_NEAR(relative_error("contact", "gross_slip_displacement"), std::hypot(0.05, 0.13),
              kRounding);
  EXPECT_NEAR(relative_error("contact", "normal_load"), 0.04, kRounding);
  EXPECT_EQ(contact["parameters"]["alpha"]["standard_error"], 0.0);
}

TEST(Contact, CountsTheLoadOnceInSlipForceAndRadius) {
  const json contact =
      RunCommand({"contact", "--friction", "0.3", "--normal-load", "100±3%", "--youngs-modulus-1",
                  "2e11", "--youngs-modulus-2", "2e11", "--poisson-1", "0.3", "--poisson-2", "0.3",
                  "--radius-1", "0.01", "--radius-2", "inf", "--json", "-"})
          .Json();
  // δc = 3μN·G*/(16a) with a ∝ ∛N
  const json& displacement = contact["contact"]["gross_slip_displacement"];
  EXPECT_NEAR(Number(displacement["standard_error"]) / Number(displacement["value"]), 0.02,
              kRounding);
}

TEST(Contact, PrintsErrorsWhereAnInputHasOne) {
  const auto print = [](const char* load) {
    return RunCommand({"contact", "--friction", "0.3", "--normal-load", load, "--contact-radius",
                       "1e-3", "--compliance", "4e-11"})
        .out;
  };
  EXPECT_THAT(print("100±4%"), HasSubstr("30 ± 1.2"));
  EXPECT_THAT(print("100"), Not(HasSubstr("±")));
  EXPECT_EQ(print("100±0"), print("100"));
}

TEST(Simulate, UsesTheValueOfAnUncertainInput) {
  const auto simulate = [](const Words& contact) {
    Words words = {"simulate", "--lambda", "0.5", "--samples-per-cycle", "8"};
    words.insert(words.end(), contact.begin(), contact.end());
    const Outcome outcome = RunCommand(words);
    EXPECT_EQ(outcome.status, cli::kDone) << outcome.err;
    EXPECT_THAT(outcome.err, IsEmpty());
    return outcome.out;
  };
  EXPECT_EQ(simulate({"--friction", "0.3±10%", "--normal-load", "100+-1", "--contact-radius",
                      "1e-3+/-1e-5", "--compliance", "4e-11 ± 3 %"}),
            simulate({"--friction", "0.3", "--normal-load", "100", "--contact-radius", "1e-3",
                      "--compliance", "4e-11"}));
}

TEST(Simulate, RefusesAnUncertaintyOfParametersThatAreNoMeasurement) {
  const Outcome outcome =
      RunCommand({"simulate", "--sigma", "2±1", "--slip-force", "3", "--lambda", "1"});
  EXPECT_EQ(outcome.status, cli::kBadInput);
  EXPECT_THAT(outcome.err, HasSubstr("--sigma"));
}

}  // namespace
}  // namespace mindahl::cli::uncertain_inputs_test
