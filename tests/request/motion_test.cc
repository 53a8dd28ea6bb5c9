#include "mindahl/request/motion.h"

#include "io/temporary_directory.h"
#include "support/prelude.h"

// The motion that is asked for, by a waveform or a file.
namespace mindahl::request::motion_test {
namespace {

constexpr models::BranchLaw kLaw{4e7, 1.0 / 3, 40.0};  // slips at Tc/(σ(1 − α)) = 1.5 µm

double Largest(const std::vector<double>& values) {
  return std::abs(*std::ranges::max_element(values, {}, [](double x) { return std::abs(x); }));
}

TEST(MakeMotion, ReachesLambdaTimesGrossSlipOrTheAmplitude) {
  DriveRequest request;
  request.lambda = 0.8;
  const ImposedMotion motion = MakeMotion(request, kLaw);
  EXPECT_NEAR(Largest(motion.displacement), 1.2e-6, 1e-18);
  EXPECT_THAT(motion.envelope, IsEmpty());
  request.lambda.reset();
  request.amplitude = 3e-7;
  EXPECT_EQ(Largest(MakeMotion(request, kLaw).displacement), 3e-7);
}

TEST(MakeMotion, NeedsOneOfLambdaAndAmplitude) {
  DriveRequest request;
  EXPECT_THROW(MakeMotion(request, kLaw), InputError);
  request.lambda = 1.0;
  request.amplitude = 1e-6;
  EXPECT_THROW(MakeMotion(request, kLaw), InputError);
  request.amplitude.reset();
  EXPECT_THROW(MakeMotion(request, {4e7, 1.0, 40.0}), InputError);  // slip is only approached
  EXPECT_NO_THROW(MakeMotion(request, {4e7, 0.99, 40.0}));
}

TEST(MakeMotion, HasTheEnvelopeOfAGrowingSineAlone) {
  DriveRequest request;
  request.amplitude = 2e-6;
  request.waveform = "growing-sine";
  request.excitation.cycles = 3;
  request.excitation.growth = 4;
  const ImposedMotion motion = MakeMotion(request, kLaw);
  ASSERT_EQ(motion.envelope.size(), motion.displacement.size());
  // A geometric growth to the amplitude: half of it half way.
  EXPECT_NEAR(motion.envelope.front(), 5e-7, 1e-18);
  EXPECT_NEAR(motion.envelope[motion.envelope.size() / 2], 1e-6, 1e-18);
  EXPECT_NEAR(motion.envelope.back(), 2e-6, 1e-18);
  EXPECT_EQ(motion.drive().envelope.data(), motion.envelope.data());
}

TEST(MakeMotion, OfAFileHasARowASampleAndItsLoad) {
  const TemporaryDirectory directory;
  DriveRequest request;
  request.path = directory.Write("path.csv", "x [um],N [N]\n0,50\n1.5,60\n-0.5,70\n").string();
  request.load_column = "N";
  const ImposedMotion motion = MakeMotion(request, kLaw);
  EXPECT_EQ(motion.displacement, (std::vector<double>{0, 1.5e-6, -0.5e-6}));
  EXPECT_EQ(motion.normal_load, (std::vector<double>{50, 60, 70}));
  EXPECT_EQ(motion.time, (std::vector<double>{0, 1, 2}));
  request.load_column.clear();
  EXPECT_THAT(MakeMotion(request, kLaw).normal_load, IsEmpty());
}

std::string RefusalOf(const std::string& rows) {
  const TemporaryDirectory directory;
  DriveRequest request;
  request.force_path = directory.Write("force.csv", "F [N]\n" + rows).string();
  try {
    ReadImposedForce(request, kLaw);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Simulate, RefusesAddedForcesThatAreNotFinite) {
  const auto refusal_of = [](const AddedForces& forces) -> std::string {
    SimulationRequest request;
    request.forces = forces;
    request.law.sigma = kLaw.tangential_stiffness;
    request.law.slip_force = kLaw.slip_force;
    request.drive.amplitude = 2e-6;
    try {
      Simulate(request);
    } catch (const InvalidArgument& error) {
      return error.what();
    }
    return "";
  };
  const std::vector<std::pair<std::string, double AddedForces::*>> factors = {
      {"--viscous", &AddedForces::viscous},
      {"--inertia", &AddedForces::inertia},
      {"--plateau-slope", &AddedForces::plateau_slope},
      {"--plateau-curvature", &AddedForces::plateau_curvature},
      {"--ripple-amplitude", &AddedForces::ripple_amplitude},
      {"--ripple-phase-up", &AddedForces::ripple_phase_up},
      {"--ripple-phase-down", &AddedForces::ripple_phase_down}};
  for (const auto& [option, factor] : factors) {
    for (const double value : {std::nan(""), HUGE_VAL}) {
      AddedForces forces{.ripple = 1e-6};
      forces.*factor = value;
      EXPECT_THAT(refusal_of(forces), ::testing::StartsWith(option + " ["));
    }
  }
  // 2π·2 µm over the least double is beyond the largest: no cosine.
  EXPECT_THAT(refusal_of({.ripple = 5e-324, .ripple_amplitude = 1.0}),
              ::testing::StartsWith("force [N] of row "));
  EXPECT_EQ(refusal_of({.ripple = 1e-6, .ripple_amplitude = 1.0}), "");
}

TEST(ReadImposedForce, IsWithinTheSlipForceOfEitherSign) {
  EXPECT_EQ(RefusalOf("0\n39.9\n-39.9\n"), "");
  EXPECT_THAT(RefusalOf("0\n39\n40\n"), HasSubstr("force.csv:4: a force of 40 N"));
  EXPECT_THAT(RefusalOf("0\n39\n-40\n"), HasSubstr("force.csv:4: a force of -40 N"));
  EXPECT_THAT(RefusalOf("0\n-41\n39\n"), HasSubstr("force.csv:3: a force of -41 N"));
}

}  // namespace
}  // namespace mindahl::request::motion_test
