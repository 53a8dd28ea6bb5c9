#include "cli/command_line.h"
#include "io/temporary_directory.h"
#include "support/prelude.h"
#include "support/unit_scale.h"

// Checks that the output of the commands scales with the units of their input, with lengths four
// times, forces an eighth and times twice as large. tests/request checks the JSON of `fit`.
namespace mindahl::cli::units_test {
namespace {

using testing::Outcome;
using testing::RunCommand;
using testing::UnitScale;
using Words = std::vector<std::string>;

constexpr UnitScale kScale{.length = 4.0, .force = 0.125, .time = 2.0};
constexpr double kRounding = 1e-9;

std::string Text(double value) {
  std::ostringstream text;
  text.precision(17);
  text << value;
  return text.str();
}

/// Gives a contact of 40 N/µm that slips at 40 N.
Words Contact(const UnitScale& scale, Words words) {
  for (const std::string& word : {std::string("--sigma"), Text(4e7 * scale.Of("N/m")),
                                  std::string("--slip-force"), Text(40 * scale.force)}) {
    words.push_back(word);
  }
  return words;
}

void ExpectScaled(double plain, double scaled, std::string_view unit, const std::string& where) {
  const double expected = plain * kScale.Of(unit);
  EXPECT_NEAR(scaled, expected, kRounding * std::abs(expected)) << where << " [" << unit << "]";
}

TEST(Units, OfATableOfCyclesAreThoseOfItsHeader) {
  const TemporaryDirectory directory;
  const auto track = [&](const std::string& name, const UnitScale& scale) {
    const std::string table = (directory.path() / name).string();
    const Outcome run =
        RunCommand({"track", testing::SampleRecord(), "--output", table, "--displacement",
                    "displacement*" + Text(scale.length), "--force", "force*" + Text(scale.force),
                    "--time", "time*" + Text(scale.time), "--normal-load", Text(25 * scale.force)});
    EXPECT_EQ(run.status, 0) << run.err;
    std::ifstream file(table);
    return testing::Lines({std::istreambuf_iterator<char>(file), {}});
  };
  const Words plain = track("plain.csv", {});
  const Words scaled = track("scaled.csv", kScale);
  ASSERT_EQ(plain.size(), 3U);
  ASSERT_EQ(scaled.size(), 3U);
  EXPECT_EQ(plain[0], scaled[0]);
  const Words header = testing::Cells(plain[0]);
  for (std::size_t row = 1; row < plain.size(); ++row) {
    const Words one = testing::Cells(plain[row]);
    const Words other = testing::Cells(scaled[row]);
    ASSERT_EQ(one.size(), header.size());
    for (std::size_t c = 0; c < header.size(); ++c) {
      if (header[c] == "checksum") continue;  // of the bytes that were read
      const std::size_t open = header[c].find('[');
      const bool is_number = open != std::string::npos || header[c].starts_with("alpha") ||
                             header[c].ends_with("_ratio") || header[c].ends_with("coefficient");
      if (!is_number) {
        EXPECT_EQ(one[c], other[c]) << header[c];
        continue;
      }
      EXPECT_EQ(one[c].empty(), other[c].empty()) << header[c];
      if (one[c].empty()) continue;
      const std::string unit =
          open == std::string::npos ? "-" : header[c].substr(open + 1, header[c].size() - open - 2);
      ExpectScaled(std::stod(one[c]), std::stod(other[c]), unit, header[c]);
    }
  }
}

TEST(Units, OfAConversionAreThoseOfItsParameters) {
  for (const char* target : {"dahl", "iwan", "lugre", "lammps", "urdf"}) {
    const auto convert = [&](const UnitScale& scale) {
      const Outcome run = RunCommand(
          Contact(scale, {"convert", "--to", target, "--amplitude", Text(1.2e-6 * scale.length),
                          "--largest-amplitude", Text(2.4e-6 * scale.length), "--json", "-"}));
      EXPECT_EQ(run.status, 0) << run.err;
      return run.Json();
    };
    const auto plain = convert({});
    const auto scaled = convert(kScale);
    for (const auto& [name, parameter] : plain["parameters"].items()) {
      const std::string unit = parameter["unit"];
      ExpectScaled(parameter["value"], scaled["parameters"][name]["value"], unit,
                   std::string(target) + " " + name);
    }
    for (const char* error : {"error_at_amplitude", "largest_error"}) {
      for (const char* of : {"force", "energy"}) {
        ExpectScaled(plain[error][of], scaled[error][of], "-", error);
      }
    }
    EXPECT_EQ(plain["within"].is_null(), scaled["within"].is_null()) << target;
  }
}

TEST(Units, OfARecommendationLeaveCostsAndErrorsAsTheyAre) {
  const auto recommend = [&](const UnitScale& scale) {
    const Outcome run = RunCommand(Contact(scale, {"recommend", "--lambda", "1.2", "--cycles", "2",
                                                   "--samples-per-cycle", "60", "--json", "-"}));
    EXPECT_EQ(run.status, 0) << run.err;
    return run.Json();
  };
  const auto plain = recommend({});
  const auto scaled = recommend(kScale);
  ExpectScaled(plain["excitation"]["peak_force"], scaled["excitation"]["peak_force"], "N", "peak");
  ASSERT_EQ(plain["candidates"].size(), scaled["candidates"].size());
  for (std::size_t k = 0; k < plain["candidates"].size(); ++k) {
    const auto& one = plain["candidates"][k];
    const auto& other = scaled["candidates"][k];
    for (const char* name : {"model", "method", "steps", "meets", "settles_after_cycles"}) {
      EXPECT_EQ(one[name], other[name]) << k;
    }
    ExpectScaled(one["cost_ns_per_sample"], other["cost_ns_per_sample"], "-", "cost");
    // A minimum is found to half the digits; an error of a few units in the last place is rounding.
    constexpr double kLastPlaces = 1e-12;
    constexpr double kHalfTheDigits = 1e-7;
    EXPECT_NEAR(one["max_force_error"].get<double>(), other["max_force_error"].get<double>(),
                kLastPlaces + kHalfTheDigits * one["max_force_error"].get<double>());
  }
  EXPECT_EQ(plain["choice"]["model"], scaled["choice"]["model"]);
}

TEST(Units, OfAPlanAreThoseOfItsParameters) {
  const auto plan = [&](const UnitScale& scale) {
    const Outcome run = RunCommand(Contact(
        scale, {"plan", "--force-noise", Text(0.2 * scale.force), "--displacement-noise",
                Text(2e-9 * scale.length), "--rig-stiffness", Text(9e7 * scale.Of("N/m")), "--with",
                "rig_stiffness,viscous", "--amplitude", Text(2e-6 * scale.length), "--json", "-"}));
    EXPECT_EQ(run.status, 0) << run.err;
    return run.Json();
  };
  const auto plain = plan({});
  const auto scaled = plan(kScale);
  ExpectScaled(plain["expected"]["gross_slip_displacement"],
               scaled["expected"]["gross_slip_displacement"], "m", "slip");
  ASSERT_EQ(plain["loops"].size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    const auto& one = plain["loops"][k];
    const auto& other = scaled["loops"][k];
    ExpectScaled(one["peak_force"], other["peak_force"], "N", "peak");
    ExpectScaled(one["law_evidence"], other["law_evidence"], "-", "evidence");
    for (const auto& [name, parameter] : one["parameters"].items()) {
      // A plan counts its time in samples, which have no unit.
      if (name == "viscous" || name == "force_drift") continue;
      const std::string unit = parameter["unit"];
      ExpectScaled(parameter["value"], other["parameters"][name]["value"], unit, name);
      if (parameter["standard_error"].is_null()) continue;
      ExpectScaled(parameter["standard_error"], other["parameters"][name]["standard_error"], unit,
                   name);
    }
  }
}

TEST(Units, OfASweepAreThoseOfItsParameters) {
  const TemporaryDirectory directory;
  const auto fit = [&](const std::string& name, const UnitScale& scale) {
    std::string rows = "displacement amplitude [m],stiffness [N/m]\n";
    for (int k = 1; k <= 20; ++k) {
      const double x = 1e-7 * k;
      const double stiffness = 4e7 * (1 - 0.2 * x / 1e-6) * (k % 2 == 0 ? 1.002 : 0.998);
      rows += Text(x * scale.length) + "," + Text(stiffness * scale.Of("N/m")) + "\n";
    }
    const Outcome run = RunCommand(
        {"fit", directory.Write(name, rows).string(), "--sweep", "secant", "--json", "-"});
    EXPECT_EQ(run.status, 0) << run.err;
    return run.Json();
  };
  const auto plain = fit("plain.csv", {});
  const auto scaled = fit("scaled.csv", kScale);
  // Ends of an interval are found to a part in a thousand of a standard error, the minimum to less.
  constexpr double kSearch = 1e-5;
  for (const auto& [name, parameter] : plain["parameters"].items()) {
    const double factor = kScale.Of(parameter["unit"].get<std::string>());
    const auto& other = scaled["parameters"][name];
    EXPECT_NEAR(other["value"].get<double>() / (factor * parameter["value"].get<double>()), 1.0,
                kSearch)
        << name;
    for (std::size_t end = 0; end < 2; ++end) {
      ASSERT_EQ(parameter["ci95"][end].is_null(), other["ci95"][end].is_null()) << name;
      if (parameter["ci95"][end].is_null()) continue;
      EXPECT_NEAR(
          other["ci95"][end].get<double>() / (factor * parameter["ci95"][end].get<double>()), 1.0,
          kSearch)
          << name;
    }
  }
  const double rms = plain["residuals"]["rms"];
  EXPECT_NEAR(scaled["residuals"]["rms"].get<double>() / (rms * kScale.Of("N/m")), 1.0, kSearch);
}

}  // namespace
}  // namespace mindahl::cli::units_test
