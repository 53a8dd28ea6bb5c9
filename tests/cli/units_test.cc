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
      const Outcome run = RunCommand(Contact(scale, {"convert", "--to", target, "--amplitude",
                                                     Text(1.2e-6 * scale.length), "--json", "-"}));
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
    for (const char* of : {"force", "energy"}) {
      ExpectScaled(plain["error_at_amplitude"][of], scaled["error_at_amplitude"][of], "-", of);
    }
    EXPECT_EQ(plain["within"].is_null(), scaled["within"].is_null()) << target;
  }
}

}  // namespace
}  // namespace mindahl::cli::units_test
