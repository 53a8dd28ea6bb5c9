#include "identification/sample_loop.h"
#include "identification/stages.h"
#include "support/imposed_force.h"
#include "support/prelude.h"

// Fits of the displacement that answers an imposed force.
namespace mindahl::identification::imposed_force_fit_test {
namespace {

constexpr double kSlipForce = 60.0;  // [N]
constexpr int kSamplesPerCycle = 120;

constexpr BranchLaw LawOf(double alpha) { return {5e7, alpha, kSlipForce}; }

/// Three cycles of force to ±share·Tc from an unloaded contact, off centre in both channels.
Record ForcedLoop(const BranchLaw& law, double share = 0.95,
                  std::string_view model = "mindlin-dahl", double cycles = 3.0) {
  const History force = Cycling(Wave::kSine, share * law.slip_force, cycles, kSamplesPerCycle);
  return Shifted(MakeRecord(DisplacementUnder(Model(model), law, force), force), 2e-7, 3.0);
}

FitOptions OfDisplacement(std::string_view model = "mindlin-dahl") {
  return {.model = models::FindFrictionModel(model),
          .preparation = {.excitation = Channel::kForce}};
}

double AmplitudeOf(const Record& record) {
  const auto [low, high] = std::ranges::minmax(record.displacement);
  return (high - low) / 2;
}

Record WithDisplacementNoise(Record record, double share, Generator& generator) {
  const double deviation = share * AmplitudeOf(record);
  for (double& x : record.displacement) x += deviation * Normal(generator);
  return record;
}

TEST(ImposedForceFit, RecoversAVirginContactOfAnyShape) {
  for (const double alpha : {0.1, 1.0 / 3, 0.7, 1.0, 1.6}) {
    SCOPED_TRACE(alpha);
    const BranchLaw law = LawOf(alpha);
    const FitResult fit = FitOne(ForcedLoop(law), OfDisplacement());
    EXPECT_TRUE(Recovers(fit, law, testing::kNoiseFree));
    EXPECT_EQ(fit.initial_state, InitialState::kVirgin);
    EXPECT_EQ(fit.response, Channel::kDisplacement);
    EXPECT_NEAR(fit.Find("displacement_offset")->value, 2e-7, 1e-8 * 2e-7);
    EXPECT_NEAR(fit.Find("force_offset")->value, 3.0, 1e-8 * 3.0);
  }
}

TEST(ImposedForceFit, RecoversVirginAndSteadyLoopsByTheirOwnLaw) {
  for (const std::string_view model : {"mindlin-dahl", "dahl"}) {
    SCOPED_TRACE(model);
    const BranchLaw law = LawOf(0.5);
    FitOptions options = OfDisplacement(model);
    const Record loop = ForcedLoop(law, 0.9, model);
    EXPECT_TRUE(Recovers(FitOne(loop, options), law, testing::kNoiseFree));
    options.initial_state = InitialState::kSteady;
    const FitResult fit = FitOne(From(loop, kSamplesPerCycle), options);
    EXPECT_TRUE(Recovers(fit, law, testing::kNoiseFree));
    EXPECT_EQ(fit.Find("force_offset")->status, ParameterStatus::kFixed);
  }
}

TEST(ImposedForceFit, DetectsForceOfOppositeSign) {
  const BranchLaw law = LawOf(0.4);
  const FitResult fit = FitOne(Scaled(ForcedLoop(law), 1.0, -1.0), OfDisplacement());
  EXPECT_EQ(fit.force_sense, -1);
  EXPECT_TRUE(Recovers(fit, law, testing::kNoiseFree));
  EXPECT_NEAR(fit.Find("force_offset")->value, -3.0, 1e-8 * 3.0);
}

TEST(ImposedForceFit, FittedLoopRunsUnderTheMeasuredForceAndResidualsAreInMetres) {
  Generator generator(5);
  const Record loop = WithDisplacementNoise(ForcedLoop(LawOf(0.4)), 0.01, generator);
  const FitResult fit = FitOne(loop, OfDisplacement());
  const RecordFit& record = fit.records.front();
  ASSERT_EQ(record.fitted_displacement.size(), loop.size());
  double squares = 0.0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    EXPECT_EQ(record.fitted_force[i], loop.force[i]);
    const double residual = record.fitted_displacement[i] - loop.displacement[i];
    EXPECT_NEAR(record.residual[i], residual, 1e-12 * AmplitudeOf(loop));
    squares += residual * residual;
  }
  EXPECT_NEAR(fit.rms, std::sqrt(squares / static_cast<double>(loop.size())), 1e-9 * fit.rms);
  // n − 5 squares tell a deviation to 1/√(2n) = 3.7 %; five of those.
  EXPECT_NEAR(record.displacement_noise / (0.01 * AmplitudeOf(ForcedLoop(LawOf(0.4)))), 1, 0.19);
  EXPECT_EQ(fit.force_noise, 0.0);
}

TEST(ImposedForceFit, SlipForceFarFromWhatWasReachedIsALowerLimit) {
  Generator generator(7);
  const Record loop = WithDisplacementNoise(ForcedLoop(LawOf(1.0 / 3), 0.25), 0.005, generator);
  const FitResult fit = FitOne(loop, OfDisplacement());
  const ParameterEstimate& slip_force = *fit.Find("slip_force");
  EXPECT_EQ(slip_force.identifiability, Identifiability::kBoundedBelow);
  ASSERT_TRUE(slip_force.lower95.has_value());
  EXPECT_GE(*slip_force.lower95, 0.999 * 0.25 * kSlipForce) << "it was carried";
  EXPECT_LE(*slip_force.lower95, kSlipForce);
  EXPECT_FALSE(slip_force.upper95.has_value());
}

TEST(ImposedForceFit, SlipForceOfASteadyLoopIsAtLeastTheLargestForce) {
  // Short of slip: the displacement tells Tc from below by what the loop has carried.
  Generator generator(1);
  const Record loop = From(ForcedLoop(LawOf(1.0 / 3), 0.4), kSamplesPerCycle);
  FitOptions options = OfDisplacement();
  options.initial_state = InitialState::kSteady;
  options.start["slip_force"] = 0.1 * kSlipForce;
  const FitResult fit = FitOne(WithDisplacementNoise(loop, 0.05, generator), options);
  const ParameterEstimate& slip_force = *fit.Find("slip_force");
  ASSERT_TRUE(slip_force.lower95);
  EXPECT_GE(*slip_force.lower95, 0.999 * 0.4 * kSlipForce);
}

TEST(ImposedForceFit, HeldParametersStayAndTheOthersFollow) {
  const BranchLaw law = LawOf(0.4);
  for (const auto& [name, value] :
       {std::pair("sigma", 5e7), std::pair("alpha", 0.4), std::pair("slip_force", kSlipForce)}) {
    FitOptions options = OfDisplacement();
    options.fixed[name] = value;
    const FitResult fit = FitOne(ForcedLoop(law), options);
    EXPECT_TRUE(Recovers(fit, law, testing::kNoiseFree)) << name;
    EXPECT_EQ(fit.Find(name)->status, ParameterStatus::kFixed);
  }
}

TEST(ImposedForceFit, DriftOfTheDisplacementIsATermAndElseACause) {
  Record loop = Timed(ForcedLoop(LawOf(0.4)), 1.0 / kSamplesPerCycle);
  const double drift = 1e-8;  // [m/s], 3e-8 in all, 1 % of the way
  Generator generator(3);
  for (std::size_t i = 0; i < loop.size(); ++i) loop.displacement[i] += drift * loop.time[i];
  loop = WithDisplacementNoise(loop, 0.002, generator);
  const FitResult plain = FitOne(loop, OfDisplacement());
  EXPECT_EQ(plain.adequacy.verdict, AdequacyVerdict::kDoubtful);
  ASSERT_FALSE(plain.adequacy.causes.empty());
  EXPECT_EQ(plain.adequacy.causes.front().code, "displacement_drift");
  EXPECT_EQ(plain.adequacy.causes.front().term, "displacement_drift");
  FitOptions options = OfDisplacement();
  options.terms = {"displacement_drift"};
  const FitResult fit = FitOne(loop, options);
  const ParameterEstimate& estimate = *fit.Find("displacement_drift");
  ASSERT_TRUE(estimate.standard_error.has_value());
  EXPECT_NEAR(estimate.value, drift, 5 * *estimate.standard_error);
  EXPECT_EQ(fit.adequacy.verdict, AdequacyVerdict::kAdequate);
}

TEST(ImposedForceFit, DistinguishesMasingFromDahlByVirginBranch) {
  Generator generator(8);
  const Record loop = WithDisplacementNoise(ForcedLoop(LawOf(1.0 / 3)), 0.003, generator);
  const FitResult fit = FitOne(loop, OfDisplacement());
  ASSERT_TRUE(fit.law_choice.has_value());
  EXPECT_TRUE(fit.law_choice->decided());
  EXPECT_EQ(fit.law_choice->preferred, fit.model);
}

TEST(ImposedForceFit, EvidenceForALawDoesNotDependOnTheUnit) {
  const auto evidence = [](double sigma) {
    Generator generator(9);
    const Record loop =
        WithDisplacementNoise(ForcedLoop({sigma, 0.4, kSlipForce}), 1e-6, generator);
    const FitResult fit = FitOne(loop, OfDisplacement());
    return fit.law_choice && fit.law_choice->delta_aicc ? *fit.law_choice->delta_aicc : 0.0;
  };
  EXPECT_GT(evidence(5e5), 300);
  EXPECT_NEAR(evidence(5e3) / evidence(5e5), 1.0, 1e-6);
}

TEST(ImposedForceFit, RefusesOptionsOfForceFits) {
  const Record loop = ForcedLoop(LawOf(0.4));
  const auto refusal = [&](auto change) {
    FitOptions options = OfDisplacement();
    change(options);
    return MessageOf([&] { FitOne(loop, options); });
  };
  for (const char* term : {"rig_stiffness", "plateau_slope", "viscous", "lag", "force_drift"}) {
    EXPECT_THAT(refusal([&](FitOptions& options) { options.terms = {term}; }),
                HasSubstr(std::string(term) + " has no place in a fit of the displacement"));
    EXPECT_THAT(refusal([&](FitOptions& options) { options.fixed[term] = 1e9; }),
                HasSubstr("has no place"));
  }
  EXPECT_THAT(refusal([](FitOptions& options) { options.force_noise = 0.1; }),
              HasSubstr("imposed and taken as exact"));
  EXPECT_THAT(refusal([](FitOptions& options) { options.covariates = {"pressure"}; }),
              HasSubstr("covariate has no place"));
  EXPECT_THAT(MessageOf([&] { FitOne(loop, {.terms = {"displacement_drift"}}); }),
              HasSubstr("displacement_drift has no place in a fit of the force"));
}

TEST(ImposedForceFit, RefusesLoadsThatDifferOrVary) {
  std::vector<Record> loops(2, ForcedLoop(LawOf(0.4)));
  FitOptions options = OfDisplacement();
  options.normal_loads = {50.0, 100.0};
  EXPECT_THAT(MessageOf([&] { Fit(loops, options); }), HasSubstr("normal load"));
  options.normal_loads.clear();
  Record varying = loops.front();
  for (std::size_t i = 0; i < varying.size(); ++i) {
    varying.normal_load.push_back(100 + 10 * std::sin(0.05 * static_cast<double>(i)));
  }
  EXPECT_THAT(MessageOf([&] { FitOne(varying, options); }), HasSubstr("normal load"));
}

TEST(ImposedForceFit, JointFitSharesTheContact) {
  const BranchLaw law = LawOf(0.4);
  const std::vector<Record> loops = {ForcedLoop(law), Shifted(ForcedLoop(law, 0.7), 1e-7, -5.0)};
  const FitResult fit = Fit(loops, OfDisplacement());
  EXPECT_TRUE(Recovers(fit, law, testing::kNoiseFree));
  EXPECT_NEAR(fit.Find("force_offset_2")->value, -2.0, 1e-7);
}

}  // namespace
}  // namespace mindahl::identification::imposed_force_fit_test
