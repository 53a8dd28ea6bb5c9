#include "cli/command_line.h"
#include "io/temporary_directory.h"
#include "mindahl/models/friction_model.h"
#include "support/prelude.h"

// These tests read a path from a file and simulate its loop with noise, rows and headers.
namespace mindahl::cli::simulate_command_test {
namespace {

using Words = std::vector<std::string>;

class SimulateFile : public ::testing::Test {
 protected:
  Outcome Simulated(const std::string& rows, Words words) {
    const bool is_force = rows.starts_with("F");
    words.insert(words.begin(), {"simulate", is_force ? "--force-path" : "--path",
                                 directory_.Write("path.csv", rows).string()});
    return RunCommand(words);
  }
  /// Returns a column of what is written.
  std::vector<double> Column(std::size_t k, const std::string& rows, const Words& words) {
    const Outcome outcome = Simulated(rows, words);
    EXPECT_EQ(outcome.status, kDone) << outcome.err;
    std::vector<double> values;
    const Words lines = Lines(outcome.out);
    for (std::size_t i = 1; i < lines.size(); ++i) {
      values.push_back(std::stod(Cells(lines[i]).at(k)));
    }
    return values;
  }
  std::vector<double> Force(const std::string& rows, const Words& words) {
    return Column(2, rows, words);
  }

  TemporaryDirectory directory_;
};

const std::string kPath = "x [um],N [N]\n0,50\n1,60\n3,70\n2,50\n-1,40\n0.5,50\n";

TEST_F(SimulateFile, UnderALoadNeedsBothParametersOrAContact) {
  const Words load = {"--normal-load-column", "N", "--normal-load", "50"};
  const auto with = [&](Words more) {
    more.insert(more.end(), load.begin(), load.end());
    return more;
  };
  const std::vector<double> by_parameters =
      Force(kPath, with({"--sigma", "4e7", "--slip-force", "40"}));
  // The law's load is that of the reference: one of its parameters alone is no contact.
  EXPECT_THAT(Simulated(kPath, with({"--sigma", "4e7"})).err, HasSubstr("--slip-force missing"));
  EXPECT_THAT(Simulated(kPath, with({"--slip-force", "40"})).err, HasSubstr("--sigma missing"));
  // The same contact by its radius: σ = 8a/G* = 4e7 N/m, Tc = μN = 40 N at 50 N.
  const std::vector<double> by_contact = Force(
      kPath, with({"--friction", "0.8", "--contact-radius", "2e-4", "--compliance", "4e-11"}));
  EXPECT_THAT(by_contact, ::testing::Pointwise(::testing::DoubleNear(1e-9), by_parameters));
}

TEST_F(SimulateFile, UnderAConstantLoadIsThatOfTheLawAtThisLoad) {
  const std::string even = "x [um],N [N]\n0,100\n1,100\n3,100\n-1,100\n";
  const std::vector<double> loaded = Force(
      even,
      {"--sigma", "4e7", "--slip-force", "40", "--normal-load-column", "N", "--normal-load", "50"});
  // Twice the load: twice the slip force, σ as the cube root.
  const std::vector<double> constant =
      Force(even, {"--sigma", fmt::format("{}", 4e7 * std::cbrt(2.0)), "--slip-force", "80"});
  EXPECT_THAT(loaded, ::testing::Pointwise(::testing::DoubleNear(1e-9), constant));
}

TEST_F(SimulateFile, OfAnImposedForceMovesAJenkinsElementByItsSpring) {
  const Words jenkins = {"--model", "jenkins", "--sigma", "4e7", "--slip-force", "40"};
  const std::vector<double> moved = Column(1, "F [N]\n0\n5\n-5\n30\n", jenkins);
  ASSERT_THAT(moved, SizeIs(4));
  const std::array force = {0.0, 5.0, -5.0, 30.0};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(moved[i], force[i] / 4e7, 1e-20) << i;
  EXPECT_THAT(Simulated("F [N]\n0\n39\n40\n", jenkins).err,
              HasSubstr("path.csv:4: a force of 40 N"));
  EXPECT_THAT(Simulated("F [N]\n0\n-41\n39\n", jenkins).err,
              HasSubstr("path.csv:3: a force of -41 N"));
  for (const auto& [option, value] :
       {std::pair("--model", "simplified-dahl"), {"--method", "dopri5"}}) {
    EXPECT_THAT(
        Simulated("F [N]\n0\n5\n", {"--sigma", "4e7", "--slip-force", "40", option, value}).err,
        HasSubstr("--force-path cannot be used with"));
  }
}

TEST_F(SimulateFile, OfAnAsymmetrySlidesAtAnotherForceEachWay) {
  const auto with = [](Words more) {
    more.insert(more.begin(), {"--model", "jenkins", "--sigma", "4e7", "--slip-force", "40"});
    return more;
  };
  // 1 µm of slip: 40·(1 ± 0.25) N at 3 µm upwards and at −1 µm downwards.
  const std::vector<double> force = Force(kPath, with({"--asymmetry", "0.25"}));
  EXPECT_NEAR(force[2], 50.0, 1e-9);
  EXPECT_NEAR(force[4], -30.0, 1e-9);
  EXPECT_THAT(Simulated(kPath, with({"--asymmetry", "1"})).err, HasSubstr("--asymmetry [-]"));
  EXPECT_THAT(Simulated(kPath, with({"--asymmetry", "0.25", "--normal-load-column", "N",
                                     "--normal-load", "50"}))
                  .err,
              HasSubstr("--asymmetry cannot be used with --normal-load-column"));
  EXPECT_THAT(Simulated("F [N]\n0\n5\n", with({"--asymmetry", "0.25"})).err,
              HasSubstr("--asymmetry cannot be used with --force-path"));
}

TEST_F(SimulateFile, AddsNoiseOfTheDeviationsThatAreAsked) {
  std::string rows = "x [um]\n";
  for (int i = 0; i < 4000; ++i) rows += i % 2 == 0 ? "0\n" : "1\n";
  const auto with = [](Words more) {
    more.insert(more.begin(), {"--sigma", "4e7", "--slip-force", "40"});
    return more;
  };
  const auto deviation = [](const std::vector<double>& a, const std::vector<double>& b) {
    double squares = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) squares += (a[i] - b[i]) * (a[i] - b[i]);
    return std::sqrt(squares / static_cast<double>(a.size()));
  };
  const Words noisy = with({"--noise-force", "0.5", "--noise-displacement", "2e-8"});
  const std::vector<double> force = Force(rows, noisy);
  // A deviation of 4000 is known to 1/√8000; five of that.
  constexpr double kScatter = 5 * 0.0112;
  EXPECT_NEAR(deviation(force, Force(rows, with({}))) / 0.5, 1.0, kScatter);
  EXPECT_NEAR(deviation(Column(1, rows, noisy), Column(1, rows, with({}))) / 2e-8, 1.0, kScatter);
  EXPECT_NE(Force(rows, with({"--noise-force", "0.5", "--seed", "2"})), force);
  EXPECT_THAT(Simulated(rows, with({"--noise-force", "-1"})).err, HasSubstr("--noise-force [N]"));
}

}  // namespace
}  // namespace mindahl::cli::simulate_command_test
