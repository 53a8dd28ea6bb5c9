#include "mindahl/request/motion.h"

#include "io/temporary_directory.h"
#include "mindahl/models/friction_model.h"
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

// --- what a simulation takes from its request

std::string SimulationRefusal(const SimulationRequest& request) {
  return MessageOf<std::exception>([&] { Simulate(request); });
}

/// A path of three strokes with a load of its own at each row, for a law that is known.
class SimulateRequest : public ::testing::Test {
 protected:
  SimulateRequest() {
    request_.law.sigma = kLaw.tangential_stiffness;
    request_.law.slip_force = kLaw.slip_force;
    request_.drive.path =
        directory_.Write("path.csv", "x [um],N [N]\n0,50\n1,60\n3,70\n2,50\n-1,40\n0.5,50\n")
            .string();
    request_.drive.force_path.clear();
  }

  /// Makes the request one of a force that a file imposes.
  void ImposeForce(const std::string& rows) {
    request_.drive.path.clear();
    request_.drive.force_path = directory_.Write("force.csv", "F [N]\n" + rows).string();
  }

  TemporaryDirectory directory_;
  SimulationRequest request_;
};

TEST_F(SimulateRequest, UnderALoadNeedsBothParametersOrAContact) {
  request_.drive.load_column = "N";
  request_.law.contact.known.normal_load = 50.0;
  EXPECT_EQ(SimulationRefusal(request_), "");
  const std::vector<double> by_parameters = Simulate(request_).force;
  // The law's load is that of the reference: one of its parameters alone is no contact.
  request_.law.slip_force.reset();
  EXPECT_THAT(SimulationRefusal(request_), StartsWith("--slip-force missing"));
  request_.law.slip_force = 40.0;
  request_.law.sigma.reset();
  EXPECT_THAT(SimulationRefusal(request_), StartsWith("--sigma missing"));
  request_.law.contact.known.normal_load.reset();
  EXPECT_THAT(SimulationRefusal(request_), StartsWith("--normal-load missing"));
  // The same contact by its radius: σ = 8a/G* = 4e7 N/m, Tc = μN = 40 N at 50 N.
  request_.law.slip_force.reset();
  request_.law.contact.friction_coefficient = contact::UncertainValue{0.8, 0.0};
  request_.law.contact.known = {.normal_load = contact::UncertainValue{50.0, 0.0},
                                .contact_radius = contact::UncertainValue{2e-4, 0.0},
                                .tangential_compliance = contact::UncertainValue{4e-11, 0.0}};
  const std::vector<double> by_contact = Simulate(request_).force;
  ASSERT_EQ(by_contact.size(), by_parameters.size());
  for (std::size_t i = 0; i < by_contact.size(); ++i) {
    EXPECT_NEAR(by_contact[i], by_parameters[i], 1e-9) << i;
  }
}

TEST_F(SimulateRequest, UnderAConstantLoadIsThatOfTheLawAtThisLoad) {
  request_.drive.path =
      directory_.Write("even.csv", "x [um],N [N]\n0,100\n1,100\n3,100\n-1,100\n").string();
  request_.drive.load_column = "N";
  request_.law.contact.known.normal_load = 50.0;
  const std::vector<double> loaded = Simulate(request_).force;
  // Twice the load: twice the slip force, σ as the cube root.
  request_.drive.load_column.clear();
  request_.law.contact.known.normal_load.reset();
  request_.law.slip_force = 80.0;
  request_.law.sigma = 4e7 * std::cbrt(2.0);
  const std::vector<double> constant = Simulate(request_).force;
  ASSERT_EQ(loaded.size(), constant.size());
  for (std::size_t i = 0; i < loaded.size(); ++i) EXPECT_NEAR(loaded[i], constant[i], 1e-9) << i;
}

TEST_F(SimulateRequest, OfAnImposedForceMovesAJenkinsElementByItsSpring) {
  ImposeForce("0\n5\n-5\n30\n");
  request_.model = "jenkins";
  const Simulation made = Simulate(request_);
  EXPECT_THAT(made.force, ElementsAre(0, 5, -5, 30));
  EXPECT_THAT(made.motion.time, ElementsAre(0, 1, 2, 3));
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(made.motion.displacement[i], made.force[i] / 4e7, 1e-20) << i;
  }
  EXPECT_TRUE(made.motion.normal_load.empty() && made.motion.envelope.empty());
  for (const auto& [rows, said] : {std::pair{"0\n39.9\n-39.9\n", ""},
                                   {"0\n39\n40\n", "force.csv:4: a force of 40 N"},
                                   {"0\n39\n-40\n", "force.csv:4: a force of -40 N"},
                                   {"0\n-41\n39\n", "force.csv:3: a force of -41 N"}}) {
    ImposeForce(rows);
    EXPECT_THAT(SimulationRefusal(request_), HasSubstr(said));
  }
  request_.model = "simplified-dahl";
  EXPECT_THAT(SimulationRefusal(request_), StartsWith("--force-path cannot be used with --model"));
  request_.model = "jenkins";
  request_.method = "dopri5";
  EXPECT_THAT(SimulationRefusal(request_), HasSubstr("--force-path cannot be used with"));
}

TEST_F(SimulateRequest, OfAnAsymmetrySlidesAtAnotherForceEachWay) {
  request_.model = "jenkins";
  request_.asymmetry = 0.25;
  // 1 µm of slip: 40·(1 ± 0.25) N at 3 µm upwards and at −1 µm downwards.
  const std::vector<double> force = Simulate(request_).force;
  EXPECT_NEAR(force[2], 50.0, 1e-9);
  EXPECT_NEAR(force[4], -30.0, 1e-9);
  for (const double beyond : {1.0, -1.0}) {
    request_.asymmetry = beyond;
    EXPECT_THAT(SimulationRefusal(request_), HasSubstr("--asymmetry [-]"));
  }
  request_.asymmetry = 0.25;
  request_.drive.load_column = "N";
  request_.law.contact.known.normal_load = 50.0;
  EXPECT_THAT(SimulationRefusal(request_),
              HasSubstr("--asymmetry cannot be used with --normal-load-column"));
  request_.drive.load_column.clear();
  request_.law.contact.known.normal_load.reset();
  ImposeForce("0\n5\n");
  EXPECT_THAT(SimulationRefusal(request_),
              HasSubstr("--asymmetry cannot be used with --force-path"));
}

TEST_F(SimulateRequest, AddsNoiseOfTheDeviationsThatAreAsked) {
  std::string rows = "x [um]\n";
  constexpr std::size_t kRows = 4000;
  for (std::size_t i = 0; i < kRows; ++i) rows += i % 2 == 0 ? "0\n" : "1\n";
  request_.drive.path = directory_.Write("long.csv", rows).string();
  const Simulation exact = Simulate(request_);
  request_.force_noise = 0.5;
  const Simulation force_only = Simulate(request_);
  request_.displacement_noise = 2e-8;
  const Simulation both = Simulate(request_);
  const auto deviation = [](const std::vector<double>& a, const std::vector<double>& b) {
    double squares = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) squares += (a[i] - b[i]) * (a[i] - b[i]);
    return std::sqrt(squares / static_cast<double>(a.size()));
  };
  // A deviation of 4000 is known to 1/√8000; five of that.
  constexpr double kScatter = 5 * 0.0112;
  EXPECT_NEAR(deviation(both.force, exact.force) / 0.5, 1.0, kScatter);
  EXPECT_NEAR(deviation(both.motion.displacement, exact.motion.displacement) / 2e-8, 1.0, kScatter);
  EXPECT_EQ(both.force, force_only.force);
  EXPECT_EQ(force_only.motion.displacement, exact.motion.displacement);
  request_.drive.seed = 2;
  EXPECT_NE(Simulate(request_).force, both.force);
  request_.force_noise = -1.0;
  EXPECT_THAT(SimulationRefusal(request_), HasSubstr("--noise-force [N]"));
  request_.force_noise = 0.0;
  request_.displacement_noise = -1.0;
  EXPECT_THAT(SimulationRefusal(request_), HasSubstr("--noise-displacement [m]"));
}

TEST(SimulationTable, HasAColumnForWhatWasImposed) {
  Simulation made;
  made.motion.time = {0, 1};
  made.motion.displacement = {2.5, 3.5};
  made.force = {4.5, 5.5};
  EXPECT_EQ(ToCsv(made), "time [s],displacement [m],force [N]\n0,2.5,4.5\n1,3.5,5.5\n");
  made.motion.normal_load = {6.5, 7.5};
  EXPECT_EQ(ToCsv(made),
            "time [s],displacement [m],force [N],normal load [N]\n0,2.5,4.5,6.5\n1,3.5,5.5,7.5\n");
}

}  // namespace
}  // namespace mindahl::request::motion_test
