#include "mindahl/request/sweep.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "io/temporary_directory.h"

// These tests concern what --sweep takes from the request.
namespace mindahl::request::sweep_test {
namespace {

/// Returns Jenkins' secant stiffness σ = 5e7 N/m up to Tc = 60 N, min(σ, Tc/X), ± 1 % in turn; no
/// amplitude is near that of slip, 1.2 µm.
std::string JenkinsSweep() {
  std::string text = "displacement [m],stiffness [N/m]\n";
  for (int k = 1; k <= 30; ++k) {
    const double amplitude = 1e-7 * (2 * k + 1);
    text += fmt::format("{},{}\n", amplitude,
                        std::min(5e7, 60 / amplitude) * (k % 2 == 0 ? 1.01 : 0.99));
  }
  return text;
}

FittedSweep FitWith(FitRequest request) {
  const TemporaryDirectory directory;
  request.files = {directory.Write("sweep.csv", JenkinsSweep()).string()};
  return FitSweepFile(request, "secant", {}, {}, [](std::string_view) {});
}

TEST(FitSweepFile, HasIntervalsOfTheConfidenceThatIsAsked) {
  const auto width = [](double confidence) {
    FitRequest request;
    request.model = "jenkins";
    request.confidence = confidence;
    const identification::ParameterEstimate slip_force =
        FitWith(request).fit.parameter("slip_force");
    return *slip_force.upper95 - *slip_force.lower95;
  };
  // The response is linear in σ where it sticks and in Tc where it slips: of t with 28 degrees of
  // freedom 2.0484 and 0.6834 standard errors to either side.
  constexpr double kEndsFound = 0.01;
  EXPECT_NEAR(width(0.95) / width(0.5), 2.0484 / 0.6834, kEndsFound);
}

TEST(FitSweepFile, HoldsTheShapeThatAModelPrescribes) {
  FitRequest request;
  request.model = "jenkins";
  EXPECT_EQ(FitWith(request).fit.parameter("alpha").value, 0.0);
  request.model = "mindlin";
  EXPECT_EQ(FitWith(request).fit.parameter("alpha").value, 1.0 / 3.0);
}

}  // namespace
}  // namespace mindahl::request::sweep_test
