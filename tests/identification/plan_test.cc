#include "mindahl/identification/plan.h"

#include "mindahl/identification/terms.h"
#include "recovery/recovered.h"
#include "support/prelude.h"

namespace mindahl::identification::plan_test {
namespace {

constexpr BranchLaw kLaw{4e7, 1.0 / 3, 40.0};
constexpr double kSlip = 1.5e-6;  // δc = Tc/(σ(1 − α))
constexpr double kForceNoise = 0.4;

Expectation Quiet() { return {.law = kLaw, .force_noise = kForceNoise}; }

Protocol ProtocolOf(double lambda) { return {.amplitude = lambda * kSlip}; }

double ErrorOf(const ExpectedFit& fit, std::string_view name) {
  const ParameterEstimate* estimate = fit.Find(name);
  EXPECT_NE(estimate, nullptr) << name;
  return estimate != nullptr && estimate->standard_error ? *estimate->standard_error : NAN;
}

using Deviations = std::array<double, 3>;  // of σ, α, Tc

/// Standard deviations over fits of simulated loops, by the public interface alone.
Deviations Scatter(const Expectation& expected, const Protocol& protocol, int loops) {
  const History displacement = Cycling(Wave::kSine, protocol.amplitude, protocol.cycles,
                                       static_cast<int>(protocol.samples_per_cycle));
  const Record clean =
      MakeRecord(displacement, Respond(Model("mindlin-dahl"), expected.law, displacement,
                                       {.state = InitialState::kSteady}, expected.rig));
  FitOptions options{.initial_state = InitialState::kSteady,
                     .preparation = {.displacement_noise = expected.displacement_noise},
                     .force_noise = expected.force_noise};
  if (std::isfinite(expected.rig.stiffness))
    options.fixed["rig_stiffness"] = expected.rig.stiffness;
  Generator generator(7);
  Deviations sums{};
  Deviations squares{};
  for (int k = 0; k < loops; ++k) {
    Record record = WithForceNoise(clean, expected.force_noise, generator);
    for (double& x : record.displacement) x += expected.displacement_noise * Normal(generator);
    const FitResult fit = Fit({&record, 1}, options, Depth::kEstimate);
    const std::array values = {fit.law.tangential_stiffness, fit.law.shape_exponent,
                               fit.law.slip_force};
    for (std::size_t j = 0; j < values.size(); ++j) {
      sums[j] += values[j];
      squares[j] += values[j] * values[j];
    }
  }
  Deviations deviations{};
  for (std::size_t j = 0; j < deviations.size(); ++j) {
    deviations[j] = std::sqrt((squares[j] - sums[j] * sums[j] / loops) / (loops - 1));
  }
  return deviations;
}

TEST(Plan, ExpectedErrorsAreTheScatterOfSimulatedFits) {
  constexpr int kLoops = 150;
  // A standard deviation of 150 values has a relative one of 1/√298 = 5.8 %: three of them.
  constexpr double kTolerance = 0.17;
  struct Case {
    double lambda;
    double displacement_noise;
    double rig_stiffness;
  };
  constexpr double kRigid = std::numeric_limits<double>::infinity();
  for (const Case& c :
       {Case{0.8, 0.0, kRigid}, {1.2, 0.0, kRigid}, {1.2, 5e-9, kRigid}, {3.0, 0.0, 8e7}}) {
    Expectation expected = Quiet();
    expected.displacement_noise = c.displacement_noise;
    expected.rig.stiffness = c.rig_stiffness;
    const Protocol protocol = ProtocolOf(c.lambda);
    const ExpectedFit fit = ExpectFit(expected, protocol);
    const Deviations scatter = Scatter(expected, protocol, kLoops);
    EXPECT_NEAR(ErrorOf(fit, "sigma") / scatter[0], 1.0, kTolerance) << c.lambda;
    EXPECT_NEAR(ErrorOf(fit, "alpha") / scatter[1], 1.0, kTolerance) << c.lambda;
    EXPECT_NEAR(ErrorOf(fit, "slip_force") / scatter[2], 1.0, kTolerance) << c.lambda;
  }
}

TEST(Plan, ErrorsAreInProportionToTheNoiseAndFallWithTheRootOfTheCycles) {
  constexpr double kRounding = 1e-9;
  const ExpectedFit once = ExpectFit(Quiet(), ProtocolOf(1.2));
  Expectation noisy = Quiet();
  noisy.force_noise *= 3;
  const ExpectedFit thrice = ExpectFit(noisy, ProtocolOf(1.2));
  Protocol longer = ProtocolOf(1.2);
  longer.cycles *= 16;
  const ExpectedFit sixteen = ExpectFit(Quiet(), longer);
  // The last sample of the last cycle is one more in 601.
  constexpr double kOneSampleMore = 2e-3;
  for (const char* name : {"sigma", "alpha", "slip_force"}) {
    EXPECT_NEAR(ErrorOf(thrice, name) / ErrorOf(once, name), 3.0, 3 * kRounding) << name;
    EXPECT_NEAR(ErrorOf(once, name) / ErrorOf(sixteen, name), 4.0, 4 * kOneSampleMore) << name;
  }
}

TEST(Plan, RefusesWhatMeansNothing) {
  Expectation expected = Quiet();
  expected.force_noise = 0.0;
  EXPECT_THROW(ExpectFit(expected, ProtocolOf(1.0)), InvalidArgument);
  EXPECT_THROW(ExpectFit(Quiet(), ProtocolOf(0.0)), InvalidArgument);
  const ExpectedFit fit = ExpectFit(Quiet(), ProtocolOf(1.0));
  EXPECT_THROW(CyclesFactor(fit, {{"beta", {.value = 1}}}), InvalidArgument);
  EXPECT_THROW(CyclesFactor(fit, {{"alpha", {.value = 0}}}), InvalidArgument);
}

}  // namespace
}  // namespace mindahl::identification::plan_test
