
#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "cli/command_line.h"
#include "io/temporary_directory.h"
#include "mindahl/models/response.h"
#include "support/histories.h"
#include "support/prelude.h"

// fit --noise-in displacement: loops whose force is imposed.
namespace mindahl::cli::noise_in_test {
namespace {

using nlohmann::json;
using Words = std::vector<std::string>;

constexpr double kSigma = 5e7;
constexpr double kSlipForce = 15.0;
constexpr double kNoise = 3e-9;  // [m], 0.9 % of X

class NoiseIn : public ::testing::Test {
 protected:
  /// Three cycles of Mindlin's contact under a force to 0.9 Tc.
  std::string Loop(double noise) {
    testing::History force(601);
    for (std::size_t i = 0; i < force.size(); ++i) {
      const double phase = 2 * std::numbers::pi * static_cast<double>(i % 200) / 200;
      force[i] = 0.9 * kSlipForce * std::sin(phase);
    }
    testing::History displacement(force.size());
    models::EvaluateDisplacement(*models::FindFrictionModel("mindlin"),
                                 {.tangential_stiffness = kSigma, .slip_force = kSlipForce}, force,
                                 displacement);
    testing::Generator generator(5);
    if (noise > 0) displacement = testing::WithNoise(generator, std::move(displacement), noise);
    std::string rows = "displacement [m],force [N]\n";
    for (std::size_t i = 0; i < force.size(); ++i) {
      rows += fmt::format("{},{}\n", displacement[i], force[i]);
    }
    return directory_.Write("loop.csv", rows).string();
  }

  TemporaryDirectory directory_;
};

TEST_F(NoiseIn, DisplacementRecoversTheContact) {
  const Outcome outcome =
      RunCommand({"fit", Loop(0.0), "--noise-in", "displacement", "--json", "-"});
  ASSERT_EQ(outcome.status, kDone) << outcome.err;
  const json fit = outcome.Json();
  constexpr double kNoiseFree = 1e-8;  // as of any noise-free loop of 17 digits
  EXPECT_NEAR(fit["parameters"]["sigma"]["value"].get<double>() / kSigma, 1, kNoiseFree);
  EXPECT_NEAR(fit["parameters"]["alpha"]["value"].get<double>(), 1.0 / 3, kNoiseFree);
  EXPECT_NEAR(fit["parameters"]["slip_force"]["value"].get<double>() / kSlipForce, 1, kNoiseFree);
}

TEST_F(NoiseIn, DisplacementGivesResidualsInMetres) {
  const std::string loop = Loop(kNoise);
  const std::string table = (directory_.path() / "residuals.csv").string();
  const Outcome outcome =
      RunCommand({"fit", loop, "--noise-in", "displacement", "--residuals", table, "--json", "-"});
  ASSERT_EQ(outcome.status, kDone) << outcome.err;
  const json fit = outcome.Json();
  // n squares tell a deviation to 1/√(2n) = 3 %; five of those.
  EXPECT_NEAR(fit["residuals"]["rms"].get<double>() / kNoise, 1, 0.15);
  std::ifstream file(table);
  std::string header;
  std::getline(file, header);
  EXPECT_THAT(testing::Cells(header), ElementsAre("displacement [m]", "force [N]",
                                                  "fitted_displacement [m]", "residual [m]"));
}

TEST_F(NoiseIn, DisplacementIsReportedInTheText) {
  const Outcome outcome = RunCommand({"fit", Loop(kNoise), "--noise-in", "displacement"});
  EXPECT_EQ(outcome.status, kDone) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr(" nm rms, like noise"));
}

}  // namespace
}  // namespace mindahl::cli::noise_in_test
