#include "mindahl/identification/fit.h"

#include "identification/sample_loop.h"
#include "recovery/recovered.h"
#include "support/prelude.h"

// What a fit reports beside the parameters: state, drift, correlation, residuals, verdicts.
namespace mindahl::identification::fit_test {
namespace {

TEST(Fit, DistinguishesVirginFromSteadyRecordWithAndWithoutNoise) {
  Generator generator(1);
  for (const double noise : {0.0, 0.02}) {
    const Record virgin = testing::WithForceNoise(Loop(), noise * kLaw.slip_force, generator);
    EXPECT_EQ(FitOne(virgin).initial_state, InitialState::kVirgin) << noise;
    // From the first minimum on, no sample of first loading is left, and the loop's own centre is
    // no unloaded state on it.
    const Record steady =
        testing::WithForceNoise(From(Loop(3.0), 95), noise * kLaw.slip_force, generator);
    EXPECT_EQ(FitOne(steady).initial_state, InitialState::kSteady) << noise;
  }
}

TEST(Fit, DeterminesInitialStateEvenIfLawIsWrong) {
  // With α held off the truth both states leave autocorrelated residuals, i.e. few effective
  // samples, but the virgin one is ten times the nearer.
  EXPECT_EQ(FitOne(Loop(), {.fixed = {{"alpha", kLaw.shape_exponent + 0.05}}}).initial_state,
            InitialState::kVirgin);
}

TEST(Fit, AutocorrelatedNoiseDoesNotMakeASteadyLoopVirgin) {
  // From a maximum on, short of slip, a contact that was unloaded somewhere does the same, with a
  // parameter more. Effective samples are those of a variance, by which noise that remembers 95 %
  // gains twice what white noise does: more than AICc's 2 with P(χ²₁ > 1) = 32 %. By all samples it
  // gains 39 times as much: P(χ²₁ > 2/39) = 82 %.
  constexpr int kLoops = 100;
  const History displacement = Cycling(Wave::kSine, 0.6 * kReach, 3.0, 120);
  const Record steady = From(LoopOf(kLaw, displacement), 30);
  // The offset is known: else the place where it was unloaded does the same.
  const FitOptions options{.fixed = {{"force_offset", 0.0}}};
  int virgin = 0;
  for (int seed = 1; seed <= kLoops; ++seed) {
    Generator generator(static_cast<std::uint64_t>(seed));
    Record record = steady;
    double noise = testing::Normal(generator);
    for (double& force : record.force) {
      force += 0.01 * kLaw.slip_force * noise;
      noise = 0.95 * noise + std::sqrt(1 - 0.95 * 0.95) * testing::Normal(generator);
    }
    if (FitOne(record, options).initial_state == InitialState::kVirgin) ++virgin;
  }
  EXPECT_LE(virgin, kLoops / 2);
}

TEST(Fit, StateThatIsGivenIsKept) {
  EXPECT_EQ(FitOne(Loop(), {.initial_state = InitialState::kSteady}).initial_state,
            InitialState::kSteady);
  EXPECT_EQ(FitOne(From(Loop(3.0), 95), Virgin()).initial_state, InitialState::kVirgin);
}

TEST(Fit, MonotoneLoadingFromTheOriginIsEnough) {
  History displacement;
  for (int i = 0; i <= 80; ++i) displacement.push_back(kReach * i / 80);
  for (const double direction : {1.0, -1.0}) {
    const FitResult fit = FitOne(Scaled(LoopOf(kLaw, displacement), direction, direction));
    EXPECT_TRUE(Recovers(fit, kLaw, kNoiseFree));
    EXPECT_EQ(fit.initial_state, InitialState::kVirgin);
    // One curve looks the same from wherever its origin is: the offsets are not for the fit.
    EXPECT_EQ(fit.Find("force_offset")->status, ParameterStatus::kFixed);
    EXPECT_EQ(fit.Find("displacement_offset")->status, ParameterStatus::kFixed);
  }
}

TEST(Fit, DriftOverTimeOrSamplesIsRecovered) {
  constexpr double kDriftPerSecond = -3.0;
  Record record = Timed(Loop(), 0.01, 40.0);
  for (std::size_t i = 0; i < record.size(); ++i) {
    record.force[i] += kDriftPerSecond * (record.time[i] - record.time[0]);
  }
  const FitOptions options{.terms = {"force_drift"}};
  const FitResult timed = FitOne(record, options);
  EXPECT_TRUE(Recovers(timed, kLaw, kNoiseFree));
  EXPECT_NEAR(timed.Find("force_drift")->value, kDriftPerSecond, 1e-7);
  EXPECT_EQ(timed.Find("force_drift")->unit, "N/s");
  EXPECT_FALSE(Recovers(FitOne(record), kLaw, 1e-4)) << "without the option drift is not free";

  record.time.clear();
  const FitResult counted = FitOne(record, options);
  EXPECT_TRUE(Recovers(counted, kLaw, kNoiseFree));
  EXPECT_NEAR(counted.Find("force_drift")->value, 0.01 * kDriftPerSecond, 1e-9);
}

TEST(Fit, ResidualIsFittedMinusMeasuredWithSignOfFile) {
  constexpr double kRounding = 1e-13;  // of forces below 100 N
  Generator generator(2);
  for (const double sense : {1.0, -1.0}) {
    const Record record = testing::WithForceNoise(testing::Scaled(Loop(), 1, sense),
                                                  0.01 * kLaw.slip_force, generator);
    const FitResult fit = FitOne(record);
    const RecordFit& part = fit.records.at(0);
    ASSERT_EQ(part.residual.size(), record.size());
    double sum = 0.0;
    for (std::size_t i = 0; i < record.size(); ++i) {
      EXPECT_NEAR(part.fitted_force[i] - record.force[i], part.residual[i], kRounding);
      sum += part.residual[i] * part.residual[i];
    }
    EXPECT_NEAR(fit.residuals.rms, std::sqrt(sum / static_cast<double>(record.size())), 1e-12);
    // The noise put in, known to 1/√(2n) = 4.5 %; four times that.
    EXPECT_NEAR(fit.residuals.rms, 0.01 * kLaw.slip_force, 0.18 * 0.01 * kLaw.slip_force);
  }
}

TEST(Fit, CyclesOfReversalsAndGateAreReported) {
  const FitResult fit = FitOne(Loop(2.0));
  EXPECT_EQ(fit.records[0].reversals, (std::vector<std::size_t>{30, 90, 150, 210}));
  EXPECT_EQ(fit.records[0].gate.gate, 0.0);
  EXPECT_EQ(fit.records[0].facts.complete_cycles, 2u);

  const FitResult gated = FitOne(Loop(), {.preparation = {.reversal_gate = 3 * kReach}});
  EXPECT_TRUE(gated.records[0].reversals.empty()) << "nothing is a reversal any more";
}

TEST(Fit, WidestRecordIsTheOneOfLargestAmplitude) {
  const History narrow = Cycling(Wave::kSine, kReach / 2, 2.0, 120);
  const FitResult fit = Fit(std::vector{LoopOf(kLaw, narrow), Loop()}, {});
  EXPECT_DOUBLE_EQ(fit.WidestRecord().facts.amplitude, kReach);
  EXPECT_TRUE(Recovers(fit, kLaw, kNoiseFree));
}

TEST(Fit, ParameterWithoutEffectIsNamedAlone) {
  // Plateaus only: neither σ nor α changes a sample, each by itself.
  const History sine = Cycling(Wave::kSine, 1.0, 2.0, 40);
  std::vector<double> force;
  for (std::size_t i = 0; i < sine.size(); ++i)
    force.push_back(i % 40 <= 10 || i % 40 > 30 ? 1 : -1);
  const FitResult fit = FitOne(MakeRecord(sine, force), {.model = &Model("jenkins")});
  const Finding* finding = fit.FindFinding("not_identifiable", "without_effect");
  ASSERT_NE(finding, nullptr);
  EXPECT_THAT(finding->parameters, ::testing::ElementsAre("sigma"));
}

TEST(Fit, ParameterWithoutEffectMayBeTheOnlyOneThatIsFitted) {
  FitOptions options = OfModel("mindlin-dahl");
  options.offsets = false;
  options.terms = {"viscous", "speed_exponent"};
  options.fixed = {{"sigma", 4e7}, {"alpha", 0.3}, {"slip_force", 40.0}, {"viscous", 0.0}};
  Record loop = testing::LoopOf({4e7, 0.5, 40.0}, Cycling(Wave::kSine, 3e-6, 2.0, 40));
  for (std::size_t i = 0; i < loop.size(); ++i) loop.time.push_back(0.01 * static_cast<double>(i));
  const FitResult fit = FitOne(loop, options);
  EXPECT_FALSE(fit.Find("speed_exponent")->standard_error);
  EXPECT_NE(fit.FindFinding("not_identifiable", "without_effect"), nullptr);
}

/// Compares what does not depend on the order of the records of a fit.
void ExpectSameFit(const FitResult& one, const FitResult& other) {
  constexpr double kSolved = 1e-5;  // of a minimum that is reached from another place
  for (const ParameterEstimate& estimate : one.parameters) {
    const std::string& name = estimate.name;
    if (name.find("offset") != std::string::npos) continue;  // one a record
    const ParameterEstimate* same = other.Find(name);
    ASSERT_NE(same, nullptr) << name;
    EXPECT_NEAR(same->value, estimate.value, kSolved * std::abs(estimate.value)) << name;
    ASSERT_EQ(same->standard_error.has_value(), estimate.standard_error.has_value()) << name;
    if (estimate.standard_error) {
      EXPECT_NEAR(*same->standard_error / *estimate.standard_error, 1.0, 1e-2) << name;
    }
    EXPECT_EQ(same->identifiability, estimate.identifiability) << name;
  }
  EXPECT_NEAR(other.residuals.rms / one.residuals.rms, 1.0, kSolved);
  EXPECT_EQ(other.adequacy.verdict, one.adequacy.verdict);
  EXPECT_NEAR(std::log(other.adequacy.p_value), std::log(one.adequacy.p_value),
              0.02 * std::abs(std::log(one.adequacy.p_value)) + 0.01);
}

TEST(Fit, DoesNotDependOnTheOrderOfItsRecords) {
  Generator generator(3);
  std::vector<Record> records;
  for (const double reach : {1.0, 0.6}) {
    const History displacement = Cycling(Wave::kSine, reach * kReach, 3.0, 150);
    records.push_back(testing::WithForceNoise(
        testing::Shifted(LoopOf(kLaw, displacement), (1 - reach) * kReach, reach * kLaw.slip_force),
        0.01 * kLaw.slip_force, generator));
  }
  const FitResult one = Fit(records, {}, Depth::kFull);
  std::ranges::reverse(records);
  ExpectSameFit(one, Fit(records, {}, Depth::kFull));
}

}  // namespace
}  // namespace mindahl::identification::fit_test
