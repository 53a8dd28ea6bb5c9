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

TEST(Simulate, AJointUnderAColumnOfLoadHasForcesInProportionToIt) {
  const TemporaryDirectory directory;
  SimulationRequest request;
  request.model = "coulomb-viscous";
  for (const models::FrictionModel& model : models::FrictionModels()) {
    if (model.memory == models::Memory::kNone && !model.scaled_by_peak) request.model = model.name;
  }
  request.law.sigma = 4e7;
  request.law.slip_force = 40.0;
  request.law.alpha = 1.0;
  request.method = "exact";
  request.drive.path =
      directory.Write("path.csv", "x [um],N [N]\n0,50\n1,50\n2,100\n1,100\n0,25\n").string();
  const std::vector<double> constant = Simulate(request).force;
  request.drive.load_column = "N";
  request.law.contact.known.normal_load = 50.0;
  const Simulation loaded = Simulate(request);
  ASSERT_EQ(loaded.force.size(), 5U);
  const std::array<double, 5> over_reference = {1, 1, 2, 2, 0.5};
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(loaded.force[i], over_reference[i] * constant[i], 1e-12) << i;
  }
  EXPECT_GT(std::abs(constant[2]), 0.0);
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

// --- forces in addition to the contact's, along −1, 1, 3, 2, 0 µm, a row a second

// The velocity [µm/s] is a central difference, one-sided at the ends; the acceleration [µm/s²] is
// that of the velocity.
constexpr std::array<double, 5> kVelocity = {2, 2, 0.5, -1.5, -2};
constexpr std::array<double, 5> kAcceleration = {0, -0.75, -1.75, -1.25, -0.5};
// From the middle, 1 µm, to either end at 2 µm; of the time from −1 to 1.
constexpr std::array<double, 5> kFromMiddle = {-2, 0, 2, 1, -1};  // [µm]
constexpr std::array<double, 5> kPosition = {-1, 0, 1, 0.5, -0.5};
constexpr std::array<double, 5> kTimeOfAll = {-1, -0.5, 0, 0.5, 1};
constexpr double kMicro = 1e-6;

std::vector<double> Simulated(const AddedForces& forces) {
  const TemporaryDirectory directory;
  SimulationRequest request;
  request.law.sigma = kLaw.tangential_stiffness;
  request.law.slip_force = kLaw.slip_force;
  request.drive.path = directory.Write("path.csv", "x [um]\n-1\n1\n3\n2\n0\n").string();
  request.forces = forces;
  return Simulate(request).force;
}

/// Compares what the forces add to that of the contact alone [N].
template <typename Added>
void ExpectAdded(const AddedForces& forces, Added added) {
  const std::vector<double> alone = Simulated({});
  const std::vector<double> all = Simulated(forces);
  ASSERT_EQ(all.size(), 5U);
  constexpr double kRounding = 1e-12;  // of 40 N
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_NEAR(all[i] - alone[i], added(i, alone[i]), kRounding * kLaw.slip_force) << i;
  }
}

TEST(AddedForces, FollowTheSpeedAndTheAcceleration) {
  ExpectAdded({.viscous = 3e6, .ripple = {}},
              [](std::size_t i, double) { return 3e6 * kMicro * kVelocity[i]; });
  ExpectAdded({.viscous = 3e3, .speed_exponent = 0.5, .ripple = {}}, [](std::size_t i, double) {
    return 3e3 * std::copysign(std::sqrt(kMicro * std::abs(kVelocity[i])), kVelocity[i]);
  });
  ExpectAdded({.inertia = 2e6, .ripple = {}},
              [](std::size_t i, double) { return 2e6 * kMicro * kAcceleration[i]; });
}

TEST(AddedForces, ScaleTheContactsOverTheStrokeAndTheTime) {
  ExpectAdded({.slip_slope = 0.2, .slip_curvature = 0.3, .slip_trend = 0.1, .ripple = {}},
              [](std::size_t i, double alone) {
                return alone * (0.2 * kPosition[i] + 0.3 * kPosition[i] * kPosition[i] +
                                0.1 * kTimeOfAll[i]);
              });
}

TEST(AddedForces, FollowThePositionFromTheMiddle) {
  ExpectAdded(
      {.plateau_slope = 4e6, .plateau_curvature = 1e12, .ripple = {}},
      [](std::size_t i, double) { return 4 * kFromMiddle[i] + kFromMiddle[i] * kFromMiddle[i]; });
  ExpectAdded(
      {.ripple = 8e-6, .ripple_amplitude = 5, .ripple_phase_up = 0.1, .ripple_phase_down = 0.7},
      [](std::size_t i, double) {
        return 5 * std::cos(2 * M_PI * kFromMiddle[i] / 8 + (i < 3 ? 0.1 : 0.7));
      });
}

TEST(AddedForces, KeepTheSlipForcePositive) {
  EXPECT_NO_THROW(
      Simulated({.slip_slope = -0.5, .slip_curvature = 0.3, .slip_trend = -0.19, .ripple = {}}));
  EXPECT_THROW(
      Simulated({.slip_slope = -0.5, .slip_curvature = 0.3, .slip_trend = -0.2, .ripple = {}}),
      InputError);
  EXPECT_THROW(Simulated({.ripple = {}, .ripple_amplitude = 1}), InputError);
}

}  // namespace
}  // namespace mindahl::request::motion_test
