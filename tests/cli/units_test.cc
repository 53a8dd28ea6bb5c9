#include "cli/command_line.h"
#include "support/unit_scale.h"

// Checks that the output of the commands scales with the units of their input, with lengths four
// times, forces an eighth and times twice as large. tests/request checks the JSON of `fit`.
namespace mindahl::cli::units_test {
namespace {

using Units = CommandTest;
using testing::UnitScale;

constexpr UnitScale kScale{.length = 4.0, .force = 0.125, .time = 2.0};

void ExpectScaled(double plain, double scaled, std::string_view unit, const std::string& where) {
  constexpr double kRounding = 1e-9;
  const double expected = plain * kScale.Of(unit);
  EXPECT_NEAR(scaled, expected, kRounding * std::abs(expected)) << where << " [" << unit << "]";
}

TEST_F(Units, OfATableOfCyclesAreThoseOfItsHeader) {
  const auto track = [&](const std::string& name, const UnitScale& scale) {
    Done(fmt::format(
        "track {} --output {} --displacement displacement*{} --force force*{} "
        "--time time*{} --normal-load {}",
        SampleRecord(), Path(name), scale.length, scale.force, scale.time, 25 * scale.force));
    return testing::Rows(FileContent(Path(name)));
  };
  const auto plain = track("plain.csv", {});
  const auto scaled = track("scaled.csv", kScale);
  ASSERT_THAT(plain, SizeIs(3));
  ASSERT_THAT(scaled, SizeIs(3));
  EXPECT_EQ(plain[0], scaled[0]);
  for (std::size_t c = 0; c < plain[0].size(); ++c) {
    const std::string& name = plain[0][c];
    if (name == "flags") continue;
    const std::size_t open = name.find('[');
    const bool is_number = open != std::string::npos || name.starts_with("alpha") ||
                           name.ends_with("_ratio") || name.ends_with("coefficient");
    const std::string unit =
        open == std::string::npos ? "-" : name.substr(open + 1, name.size() - open - 2);
    for (std::size_t row : {1U, 2U}) {
      const std::string& one = plain[row].at(c);
      const std::string& other = scaled[row].at(c);
      if (is_number && !one.empty() && !other.empty()) {
        ExpectScaled(std::stod(one), std::stod(other), unit, name);
      } else {
        EXPECT_EQ(one, other) << name;
      }
    }
  }
}

TEST_F(Units, FollowAQuantityOfAnOption) {
  EXPECT_EQ(Done("convert --to lammps --sigma 48N/um --slip-force 15N --amplitude 1um "
                 "--normal-load 0.05kN")
                .out,
            Done("convert --to lammps --sigma 48e6 --slip-force 15 --amplitude 1e-6 "
                 "--normal-load 50")
                .out);
  EXPECT_EQ(Done("simulate --sigma 48N/um --slip-force 15N --amplitude 1um --noise-force 1mN "
                 "--noise-displacement 1nm")
                .out,
            Done("simulate --sigma 48e6 --slip-force 15 --amplitude 1e-6 --noise-force 1e-3 "
                 "--noise-displacement 1e-9")
                .out);
}

TEST_F(Units, OfAConversionAreThoseOfItsParameters) {
  for (const char* target : {"dahl", "iwan", "lugre", "lammps"}) {
    const auto convert = [&](const UnitScale& scale) {
      return JsonOf(fmt::format("convert --to {} --sigma {} --slip-force {} --amplitude {}", target,
                                4e7 * scale.Of("N/m"), 40 * scale.force, 1.2e-6 * scale.length));
    };
    const json plain = convert({});
    const json scaled = convert(kScale);
    for (const auto& [name, parameter] : plain["parameters"].items()) {
      const std::string unit = parameter["unit"];
      ExpectScaled(parameter["value"], Value(scaled, name.c_str()), unit, name);
    }
    for (const char* of : {"force", "energy"}) {
      ExpectScaled(plain["error_at_amplitude"][of], scaled["error_at_amplitude"][of], "-", of);
    }
    EXPECT_EQ(plain["within"].is_null(), scaled["within"].is_null()) << target;
  }
}

}  // namespace
}  // namespace mindahl::cli::units_test
