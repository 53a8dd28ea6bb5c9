#include "identification/sample_loop.h"
#include "mindahl/identification/fit.h"
#include "support/prelude.h"

// One fitter for many records, at the depth that is wanted.
namespace mindahl::identification::fitter_test {
namespace {

using namespace loop;
using namespace models;

Record NoisyLoop(std::uint64_t seed, double cycles = 2.0) {
  Generator generator(seed);
  return WithForceNoise(Loop(cycles), 0.01 * kLaw.slip_force, generator);
}

void ExpectSame(const std::optional<double>& one, const std::optional<double>& other,
                const std::string& what) {
  ASSERT_EQ(one.has_value(), other.has_value()) << what;
  if (one && !(std::isnan(*one) && std::isnan(*other))) {
    EXPECT_EQ(*one, *other) << what;
  }
}

/// Everything that a result states, to the last bit.
void ExpectSame(const FitResult& one, const FitResult& other) {
  EXPECT_EQ(one.depth, other.depth);
  EXPECT_EQ(one.converged, other.converged);
  EXPECT_EQ(one.solver.message, other.solver.message);
  EXPECT_EQ(one.solver.iterations, other.solver.iterations);
  EXPECT_EQ(one.initial_state, other.initial_state);
  EXPECT_EQ(one.force_sense, other.force_sense);
  EXPECT_EQ(one.law.tangential_stiffness, other.law.tangential_stiffness);
  EXPECT_EQ(one.law.shape_exponent, other.law.shape_exponent);
  EXPECT_EQ(one.law.slip_force, other.law.slip_force);
  EXPECT_EQ(one.rig.stiffness, other.rig.stiffness);
  EXPECT_EQ(one.rms, other.rms);
  EXPECT_EQ(one.force_noise, other.force_noise);
  EXPECT_EQ(one.outliers, other.outliers);
  EXPECT_EQ(one.residuals.samples, other.residuals.samples);
  EXPECT_EQ(one.residuals.effective_samples, other.residuals.effective_samples);
  EXPECT_EQ(one.residuals.durbin_watson, other.residuals.durbin_watson);
  ASSERT_EQ(one.parameters.size(), other.parameters.size());
  for (std::size_t k = 0; k < one.parameters.size(); ++k) {
    const ParameterEstimate& a = one.parameters[k];
    const ParameterEstimate& b = other.parameters[k];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.unit, b.unit);
    EXPECT_EQ(a.value, b.value) << a.name;
    EXPECT_EQ(a.status, b.status) << a.name;
    EXPECT_EQ(a.identifiability, b.identifiability) << a.name;
    ExpectSame(a.standard_error, b.standard_error, a.name);
    ExpectSame(a.lower95, b.lower95, a.name);
    ExpectSame(a.upper95, b.upper95, a.name);
  }
  ASSERT_EQ(one.correlation.size(), other.correlation.size());
  for (std::size_t k = 0; k < one.correlation.size(); ++k) {
    ExpectSame(one.correlation[k], other.correlation[k], "correlation");
  }
  ASSERT_EQ(one.findings.size(), other.findings.size());
  for (std::size_t k = 0; k < one.findings.size(); ++k) {
    EXPECT_EQ(one.findings[k].code, other.findings[k].code);
    EXPECT_EQ(one.findings[k].numbers, other.findings[k].numbers);
    EXPECT_EQ(one.findings[k].parameters, other.findings[k].parameters);
  }
  ASSERT_EQ(one.records.size(), other.records.size());
  for (std::size_t r = 0; r < one.records.size(); ++r) {
    EXPECT_EQ(one.records[r].reversals, other.records[r].reversals);
    EXPECT_EQ(one.records[r].counts, other.records[r].counts);
    EXPECT_EQ(one.records[r].left_out, other.records[r].left_out);
    EXPECT_EQ(one.records[r].residual, other.records[r].residual);
    EXPECT_EQ(one.records[r].fitted_force, other.records[r].fitted_force);
    EXPECT_EQ(one.records[r].displacement_noise, other.records[r].displacement_noise);
    EXPECT_EQ(one.records[r].structure.repeatable_share,
              other.records[r].structure.repeatable_share);
    EXPECT_EQ(one.records[r].measures.amplitude, other.records[r].measures.amplitude);
  }
}

/// Records that take every way through a fit.
std::vector<std::vector<Record>> Assortment() {
  Generator generator(3);
  Record dithered = NoisyLoop(4, 4.0);
  for (double& x : dithered.displacement) x += 0.01 * kReach * testing::Normal(generator);
  Record coarse;
  const Record dense = Loop(3.0);
  for (std::size_t i = 1; i < dense.size(); i += 4) {
    coarse.displacement.push_back(dense.displacement[i]);
    coarse.force.push_back(dense.force[i]);
  }
  const Record wrong = testing::Scaled(Loop(), 1.0, -1.0);
  return {{NoisyLoop(1)}, {testing::Scaled(NoisyLoop(2, 3.0), 0.2, -2.0), NoisyLoop(5)},
          {dithered},     {testing::From(NoisyLoop(6, 3.0), 95)},
          {coarse},       {wrong},
          {Loop(1.0)}};
}

TEST(Fitter, GivesForAnyRecordWhatAFreshOneGives) {
  for (const Depth depth : {Depth::kEstimate, Depth::kErrors, Depth::kIntervals, Depth::kFull}) {
    Fitter used;
    for (int round = 0; round < 2; ++round) {
      int number = 0;
      for (const std::vector<Record>& records : Assortment()) {
        SCOPED_TRACE("records " + std::to_string(number++) + ", round " + std::to_string(round));
        const std::vector<RecordView> views(records.begin(), records.end());
        Fitter fresh;
        ExpectSame(used.Fit(views, depth), fresh.Fit(views, depth));
      }
    }
  }
}

TEST(Fitter, LeavesNothingOfAFitBeforeOneThatFails) {
  // Forced to the wrong sense, no start is found.
  FitOptions options;
  options.preparation.force_sense = 1;
  Fitter used(options);
  Fitter fresh(options);
  const Record good = Loop();
  const Record wrong = testing::Scaled(Loop(), 1.0, -1.0);
  for (const Depth depth : {Depth::kEstimate, Depth::kFull}) {
    ASSERT_TRUE(used.Fit(RecordView(good), depth).converged);
    const FitResult& failed = used.Fit(RecordView(wrong), depth);
    EXPECT_FALSE(failed.converged);
    ASSERT_NE(failed.FindFinding("fit_failed"), nullptr);
    EXPECT_EQ(failed.FindFinding("fit_failed")->severity, Severity::kFailure);
    ExpectSame(failed, fresh.Fit(RecordView(wrong), depth));
  }
}

/// A wide interval may be needless beside what a deeper fit finds; an inadequate model takes back
/// what names a parameter.
void ExpectFindingsAmong(const FitResult& fit, const FitResult& deeper) {
  if (deeper.FindFinding("model_inadequate") != nullptr) return;
  for (const Finding& finding : fit.findings) {
    if (finding.kind == "wide") continue;
    EXPECT_NE(deeper.FindFinding(finding.code), nullptr) << std::string_view(finding.code);
  }
}

TEST(Fitter, EachDepthHasTheValuesOfTheOneBefore) {
  for (const std::vector<Record>& records : Assortment()) {
    const std::vector<RecordView> views(records.begin(), records.end());
    Fitter fitter;
    const FitResult estimate = fitter.Fit(views, Depth::kEstimate);
    const FitResult errors = fitter.Fit(views, Depth::kErrors);
    const FitResult intervals = fitter.Fit(views, Depth::kIntervals);
    const FitResult full = fitter.Fit(views, Depth::kFull);
    ASSERT_EQ(estimate.parameters.size(), full.parameters.size());
    for (std::size_t k = 0; k < estimate.parameters.size(); ++k) {
      EXPECT_EQ(estimate.parameters[k].value, errors.parameters[k].value);
      EXPECT_EQ(estimate.parameters[k].value, intervals.parameters[k].value);
      EXPECT_EQ(estimate.parameters[k].value, full.parameters[k].value);
      EXPECT_EQ(estimate.parameters[k].status, full.parameters[k].status);
      EXPECT_FALSE(estimate.parameters[k].standard_error) << "an estimate has none";
    }
    EXPECT_EQ(estimate.rms, full.rms);
    EXPECT_EQ(estimate.converged, full.converged);
    EXPECT_TRUE(estimate.correlation.empty());
    EXPECT_EQ(errors.correlation.size(), full.correlation.size());
    EXPECT_EQ(errors.adequacy.tried, 0U);
    EXPECT_EQ(errors.records.front().facts.closed, full.records.front().facts.closed);
    EXPECT_EQ(intervals.correlation.size(), full.correlation.size());
    EXPECT_EQ(errors.residuals.effective_samples, full.residuals.effective_samples);
    EXPECT_EQ(intervals.residuals.effective_samples, full.residuals.effective_samples);
    ExpectFindingsAmong(errors, intervals);
    ExpectFindingsAmong(intervals, full);
  }
}

FitOptions OfSteadyCycles() {
  FitOptions options;
  options.initial_state = InitialState::kSteady;
  return options;
}

/// One steady cycle, from a turning point to the next but one.
Record NoisyCycle(std::uint64_t seed, double scale = 1.0) {
  const Record cycle = testing::From(Loop(1.25), 30);
  Generator generator(seed);
  return WithForceNoise(testing::Scaled(cycle, 1.0, scale), 0.01 * scale * kLaw.slip_force,
                        generator);
}

TEST(Fitter, HasTheErrorsOfTheParabolaBeforeAnyVerdict) {
  Fitter fitter(OfSteadyCycles());
  const Record cycle = NoisyCycle(11);
  const FitResult errors = fitter.Fit(cycle, Depth::kErrors);
  const FitResult intervals = fitter.Fit(cycle, Depth::kIntervals);
  ASSERT_EQ(intervals.adequacy.verdict, AdequacyVerdict::kAdequate);  // nothing to cover besides
  for (std::size_t k = 0; k < errors.parameters.size(); ++k) {
    ExpectSame(errors.parameters[k].standard_error, intervals.parameters[k].standard_error,
               errors.parameters[k].name);
    ExpectSame(errors.parameters[k].upper95, intervals.parameters[k].upper95,
               errors.parameters[k].name);
  }
}

// Steps end where the next would lower the cost by 1e-10 of it. Where the residuals bend the cost
// nearly as much as the law does each step leaves most of what there is: a hundred times as much
// may be left, in either of two fits. Of χ² = n = 121 that is (Δ/error)² < 2·100·1e-10·n.
constexpr double kSolverTolerance = 1e-2;  // standard errors: six times the root of that
constexpr double kSameRms = 1e-7;          // ten times half of 2·100·1e-10

void ExpectSameMinimum(const FitResult& one, const FitResult& other) {
  ASSERT_TRUE(one.converged);
  EXPECT_NEAR(one.rms, other.rms, kSameRms * other.rms);
  for (const char* name : {"sigma", "alpha", "slip_force"}) {
    const ParameterEstimate& expected = *other.Find(name);
    ASSERT_TRUE(expected.standard_error) << name;
    EXPECT_NEAR(one.Find(name)->value, expected.value, kSolverTolerance * *expected.standard_error)
        << name;
  }
}

TEST(Fitter, GoesOnFromOneCycleToTheNextToTheSameMinimum) {
  Fitter going(OfSteadyCycles());
  Fitter fresh(OfSteadyCycles());
  going.Fit(NoisyCycle(1), Depth::kErrors);
  constexpr std::uint64_t kCycles = 100;
  for (std::uint64_t seed = 2; seed < kCycles; ++seed) {
    const Record cycle = NoisyCycle(seed);
    const FitResult expected = fresh.Fit(cycle, Depth::kErrors);
    ExpectSameMinimum(going.Continue(cycle, Depth::kErrors), expected);
  }
}

// There the likelihood has several minima, and where one begins decides which is found.
TEST(Fitter, BeginsAnewWhereCyclesDoNotTellTheLaw) {
  constexpr double kPartial = 0.12;
  // With a given alpha they know sigma, and Tc no better.
  for (const std::optional<double> alpha : {std::optional<double>(), {kLaw.shape_exponent}}) {
    FitOptions options = OfSteadyCycles();
    if (alpha) options.fixed["alpha"] = *alpha;
    Fitter going(options);
    Fitter fresh(options);
    for (std::uint64_t seed = 1; seed < 25; ++seed) {
      const History part =
          testing::Scaled(testing::From(Loop(1.25), 30), kPartial, 1.0).displacement;
      Generator generator(seed);
      const Record cycle =
          WithForceNoise(testing::LoopOf(kLaw, part), 0.01 * kLaw.slip_force, generator);
      const FitResult expected = fresh.Fit(cycle, Depth::kErrors);
      ExpectSame(going.Continue(cycle, Depth::kErrors), expected);
    }
  }
}

}  // namespace
}  // namespace mindahl::identification::fitter_test
