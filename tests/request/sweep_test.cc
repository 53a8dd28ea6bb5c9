#include "mindahl/request/sweep.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "io/temporary_directory.h"
#include "support/prelude.h"

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
  return FitSweepFile(request, "secant", {}, [](std::string_view) {});
}

TEST(FitSweepFile, HasIntervalsOfTheConfidenceThatIsAsked) {
  const auto width = [](double confidence) {
    FitRequest request;
    request.fit.model = models::FindFrictionModel("jenkins");
    request.fit.confidence = confidence;
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
  request.fit.model = models::FindFrictionModel("jenkins");
  EXPECT_EQ(FitWith(request).fit.parameter("alpha").value, 0.0);
  request.fit.model = models::FindFrictionModel("mindlin");
  EXPECT_EQ(FitWith(request).fit.parameter("alpha").value, 1.0 / 3.0);
}

/// A sweep and its fit, each of whose numbers is another.
FittedSweep MadeByHand() {
  FittedSweep fitted;
  fitted.file = "s.csv";
  fitted.sweep.amplitude = {1, 2, 3};
  fitted.sweep.response = {6, 5, 4};
  fitted.sweep.over_force = true;
  fitted.asked.stiffness = identification::SweepStiffness::kTangent;
  fitted.asked.confidence = 0.5;
  const auto add = [&](const char* name, const char* unit, double value) {
    identification::ParameterEstimate& estimate = fitted.fit.parameters.emplace_back();
    estimate.name = name;
    estimate.unit = unit;
    estimate.value = value;
    return &estimate;
  };
  identification::ParameterEstimate* sigma = add("sigma", "N/m", 2.5);
  sigma->standard_error = 0.25;
  sigma->lower95 = 2.25;
  sigma->upper95 = 2.875;
  sigma->status = identification::ParameterStatus::kFree;
  sigma->identifiability = identification::Identifiability::kIdentifiable;
  add("alpha", "-", 0.75);
  identification::ParameterEstimate* slip_force = add("slip_force", "N", 8.5);
  slip_force->standard_error = HUGE_VAL;
  slip_force->lower95 = 7.5;
  slip_force->status = identification::ParameterStatus::kFree;
  slip_force->identifiability = identification::Identifiability::kBoundedBelow;
  fitted.fit.converged = true;
  fitted.fit.message = "solved";
  fitted.fit.rms = 0.125;
  fitted.fit.r_squared = 0.9375;
  fitted.fit.degrees_of_freedom = 11;
  fitted.fit.correlation_p_value = 0.25;
  return fitted;
}

TEST(FittedSweep, IsDoubtfulBelowAChanceOfOneInAHundred) {
  FittedSweep fitted = MadeByHand();
  fitted.fit.parameters.pop_back();  // the open slip force
  for (const auto& [p_value, doubtful] :
       {std::pair(std::nextafter(0.01, 0.0), true), {0.01, false}}) {
    fitted.fit.correlation_p_value = p_value;
    EXPECT_EQ(fitted.is_doubtful(), doubtful);
    EXPECT_TRUE(fitted.established(Strictness::kNone));
    EXPECT_TRUE(fitted.established(Strictness::kDoubtful));
    EXPECT_EQ(fitted.established(Strictness::kAdequate), !doubtful);
  }
  fitted.fit.converged = false;
  EXPECT_FALSE(fitted.established(Strictness::kNone));
  FittedSweep open = MadeByHand();
  EXPECT_TRUE(open.established(Strictness::kNone));
  EXPECT_FALSE(open.established(Strictness::kDoubtful));
}

TEST(FitSweepFile, RefusesWhatASweepHasNot) {
  const auto refusal = [](const FitRequest& request, const std::string& kind) -> std::string {
    return MessageOf<InputError>(
        [&] { FitSweep(request, "s.csv", {}, kind, [](std::string_view) {}); });
  };
  FitRequest request;
  EXPECT_THAT(refusal(request, "chord"), HasSubstr("--sweep"));
  request.fit.model = models::FindFrictionModel("dahl");
  EXPECT_THAT(refusal(request, "secant"), HasSubstr("--model dahl: a sweep needs a Masing law"));
  request.files = {"a.csv", "b.csv"};
  EXPECT_THROW(FitSweepFile(request, "secant", {}, [](std::string_view) {}), InputError);
}

TEST(FitSweepFile, HoldsWhatIsGiven) {
  FitRequest request;
  request.fit.model = models::FindFrictionModel("mindlin-dahl");
  request.fit.fixed["alpha"] = 0.125;
  EXPECT_EQ(FitWith(request).fit.parameter("alpha").value, 0.125);
  EXPECT_EQ(FitWith(request).fit.parameter("alpha").status,
            identification::ParameterStatus::kFixed);
}

}  // namespace
}  // namespace mindahl::request::sweep_test
