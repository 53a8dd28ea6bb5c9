

#include "cli/command_line.h"
#include "cli/request_options.h"
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
// Errors are central differences of the quantity.
constexpr double kDifferences = 1e-9;

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
    const UncertainValue value = ParseUncertainValue(reading.text, "--x", "N");
    EXPECT_EQ(value.value, reading.value);
    // A percentage rounds twice.
    EXPECT_NEAR(value.standard_error, reading.standard_error,
                2 * kEpsilon * reading.standard_error);
  }
  EXPECT_TRUE(std::isinf(ParseUncertainValue("inf", "--x", "m").value));
  EXPECT_EQ(ParseUncertainValue("inf", "--x", "m").standard_error, 0.0);
}

TEST(ParseUncertainValue, ReadsUnitsOfItsKind) {
  for (const char* text :
       {"2 N ± 0.01 N", "2±0.01N", "2 N±0.5%", "2000mN±10 mN", "0.002 kN+-0.01"}) {
    SCOPED_TRACE(text);
    const UncertainValue value = ParseUncertainValue(text, "--x", "N");
    EXPECT_DOUBLE_EQ(value.value, 2);
    EXPECT_NEAR(value.standard_error, 0.01, 1e-15);
  }
  EXPECT_EQ(ParseUncertainValue("210GPa", "--x", "Pa").value, 210e9);
  EXPECT_EQ(ParseUncertainValue("50mm", "--x", "m").value, 0.05);
  EXPECT_DOUBLE_EQ(ParseUncertainValue("48 N/um", "--x", "N/m").value, 48e6);
  EXPECT_THROW(ParseUncertainValue("50 mm", "--x", "N"), InputError);
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
                  "' is not a number or a quantity in m, nor one with its standard uncertainty: "
                  "write 50, 50±0.5, 50+-0.5, 50+/-0.5 or 50±1%\n");
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

json FitJson(const Words& words) {
  Words all = {"fit", SampleRecord(), "--json", "-"};
  all.insert(all.end(), words.begin(), words.end());
  const Outcome outcome = RunCommand(all);
  EXPECT_EQ(outcome.status, cli::kDone) << outcome.err;
  return outcome.Json();
}

double Number(const json& value) { return value.get<double>(); }

double HalfWidth(const json& quantity) {
  return std::log(Number(quantity["ci95"][1]) / Number(quantity["value"]));
}

TEST(UncertainInput, OfAFitAddsItsIntervalInQuadrature) {
  const json exact = FitJson({"--normal-load", "50"})["contact"]["friction_coefficient"];
  const json friction = FitJson({"--normal-load", "50±1%"})["contact"]["friction_coefficient"];
  EXPECT_EQ(friction["value"], exact["value"]);
  constexpr double kNormalQuantile = 1.959963984540054;  // Φ⁻¹(0.975), any table
  EXPECT_NEAR(HalfWidth(friction) / std::hypot(HalfWidth(exact), 0.01 * kNormalQuantile), 1,
              kDifferences);
}

TEST(Fit, MapsTheIntervalOfTheSlipForceToFriction) {
  const json fit = FitJson({"--normal-load", "50"});
  const json& slip_force = fit["parameters"]["slip_force"];
  const json& friction = fit["contact"]["friction_coefficient"];
  for (int end : {0, 1}) {
    EXPECT_NEAR(50 * Number(friction["ci95"][end]) / Number(slip_force["ci95"][end]), 1, kRounding);
  }
}

TEST(Fit, ComparesWithHertzAndItsUncertainty) {
  const json ratio =
      FitJson({"--normal-load", "50±3%", "--youngs-modulus-1", "210e9", "--youngs-modulus-2",
               "210e9", "--poisson-1", "0.3", "--poisson-2", "0.3", "--radius-1", "0.05±6%",
               "--radius-2", "inf"})["contact"]["sigma_over_hertz_mindlin"];
  // a = ∛(3Nρ/(4E*)), σ ∝ a, ρ = R₁
  EXPECT_NEAR(Number(ratio["value"]), 1, 0.01);  // as simulated, noise aside
  EXPECT_GT(HalfWidth(ratio), 1.95 * std::hypot(0.03, 0.06) / 3);
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
  EXPECT_NEAR(relative_error("parameters", "slip_force"), 0.05, kDifferences);  // 3, 4
  EXPECT_NEAR(relative_error("parameters", "sigma"), 0.13, kDifferences);       // 5, 12
  EXPECT_NEAR(relative_error("contact", "maximum_pressure"), std::hypot(0.04, 0.24), kDifferences);
  EXPECT_NEAR(relative_error("contact", "gross_slip_displacement"), std::hypot(0.05, 0.13),
              kDifferences);
  EXPECT_NEAR(relative_error("contact", "normal_load"), 0.04, kDifferences);
  EXPECT_EQ(contact["parameters"]["alpha"]["standard_error"], 0.0);
}

TEST(Simulate, RefusesAnUncertaintyOfParametersThatAreNoMeasurement) {
  const Outcome outcome =
      RunCommand({"simulate", "--sigma", "2±1", "--slip-force", "3", "--lambda", "1"});
  EXPECT_EQ(outcome.status, cli::kBadInput);
  EXPECT_THAT(outcome.err, HasSubstr("--sigma"));
}

}  // namespace
}  // namespace mindahl::cli::uncertain_inputs_test
