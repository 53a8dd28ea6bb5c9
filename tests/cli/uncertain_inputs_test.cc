#include <tuple>

#include "cli/command.h"
#include "cli/command_line.h"

// What is known of the contact, with its standard uncertainty: how it is read, and what becomes of
// it in every command that takes it.
namespace mindahl::cli::uncertain_inputs_test {
namespace {

using contact::UncertainValue;

// Errors are central differences of the quantity.
constexpr double kDifferences = 1e-9;

TEST(ParseUncertainValue, ReadsANumberWithEverySeparatorAndInPercent) {
  for (const auto& [text, value, error] : {std::tuple("0.01", 0.01, 0.0),
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
                                           {"0±0.01", 0, 0.01},
                                           {"inf", HUGE_VAL, 0}}) {
    SCOPED_TRACE(text);
    const UncertainValue read = ParseUncertainValue(text, "--x", "N");
    EXPECT_EQ(read.value, value);
    EXPECT_DOUBLE_EQ(read.standard_error, error);
  }
}

TEST(ParseUncertainValue, ReadsUnitsOfItsKind) {
  for (const char* text :
       {"2 N ± 0.01 N", "2±0.01N", "2 N±0.5%", "2000mN±10 mN", "0.002 kN+-0.01"}) {
    SCOPED_TRACE(text);
    const UncertainValue value = ParseUncertainValue(text, "--x", "N");
    EXPECT_DOUBLE_EQ(value.value, 2);
    EXPECT_NEAR(value.standard_error, 0.01, 1e-15);
  }
  EXPECT_THROW(ParseUncertainValue("50 mm", "--x", "N"), InputError);
}

TEST(UncertainInput, ThatCannotBeReadIsRefusedWithOneLineThatSaysHowToWriteIt) {
  for (const std::string text : {"x", "", "±", "0.01±", "±0.1", "0.01±x", "0.01%", "1±2±3", "1%±2",
                                 "0.01 0.001", "1+0.1", "1±1%%", "0,01±0.001"}) {
    ExpectRefused({"fit", SampleRecord(), "--radius-1", text},
                  "--radius-1: '" + text +
                      "' is not a number or a quantity in m, nor one with its standard "
                      "uncertainty: write 50, 50±0.5, 50+-0.5, 50+/-0.5 or 50±1%");
  }
  for (const std::string text : {"50±-1", "50+--1%", "50±nan", "50±inf", "1e308±1e3%"}) {
    ExpectRefused({"fit", SampleRecord(), "--normal-load", text},
                  "--normal-load: '" + text + "' is not a number or a quantity in N, nor one with");
  }
}

double Number(const json& value) { return value.get<double>(); }

json ContactOf(const std::string& options) {
  return JsonOf("fit " + SampleRecord() + " " + options)["contact"];
}

double HalfWidth(const json& quantity) {
  return std::log(Number(quantity["ci95"][1]) / Number(quantity["value"]));
}

TEST(Fit, ComparesWithHertzAndItsUncertainty) {
  const json ratio = ContactOf(
      "--normal-load 50±3% --youngs-modulus-1 210e9 --youngs-modulus-2 210e9 "
      "--poisson-1 0.3 --poisson-2 0.3 --radius-1 0.05±6% "
      "--radius-2 inf")["sigma_over_hertz_mindlin"];
  // a = ∛(3Nρ/(4E*)), σ ∝ a, ρ = R₁
  EXPECT_NEAR(Number(ratio["value"]), 1, 0.01);  // as simulated, noise aside
  EXPECT_GT(HalfWidth(ratio), 1.95 * std::hypot(0.03, 0.06) / 3);
}

TEST(Contact, CarriesUncertaintyToEveryQuantity) {
  const json contact = JsonOf(
      "contact --friction 0.3±3% --normal-load 100±4% --contact-radius 1e-3±12% "
      "--compliance 4e-11±5%");
  const auto expect_relative_error = [&](const char* section, const char* name, double expected) {
    const json& quantity = contact[section][name];
    EXPECT_NEAR(Number(quantity["standard_error"]) / Number(quantity["value"]), expected,
                kDifferences);
  };
  expect_relative_error("parameters", "slip_force", 0.05);  // 3, 4
  expect_relative_error("parameters", "sigma", 0.13);       // 5, 12
  expect_relative_error("parameters", "alpha", 0.0);
  expect_relative_error("contact", "maximum_pressure", std::hypot(0.04, 0.24));
  expect_relative_error("contact", "gross_slip_displacement", std::hypot(0.05, 0.13));
  expect_relative_error("contact", "normal_load", 0.04);
}

}  // namespace
}  // namespace mindahl::cli::uncertain_inputs_test
