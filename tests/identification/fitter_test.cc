#include <fmt/format.h>

#include "identification/sample_loop.h"
#include "mindahl/identification/fit.h"
#include "support/prelude.h"

// One fitter for many records, at the depth that is wanted.
namespace mindahl::identification::fitter_test {
namespace {

/// Every number and word that a result states, one after the other; what is not stated is "none".
std::vector<std::string> Statements(const FitResult& fit) {
  std::vector<std::string> all = {fit.solver.message};
  const auto add = [&](const std::optional<double>& number) {
    all.push_back(number ? fmt::format("{:a}", *number) : "none");
  };
  const auto add_all = [&](const auto& numbers) {
    for (const auto number : numbers) add(static_cast<double>(number));
  };
  add_all(std::array{static_cast<double>(fit.depth), fit.converged ? 1.0 : 0.0,
                     static_cast<double>(fit.solver.iterations),
                     static_cast<double>(fit.initial_state), static_cast<double>(fit.force_sense),
                     fit.law.tangential_stiffness, fit.law.shape_exponent, fit.law.slip_force,
                     fit.rig.stiffness, fit.rms, fit.force_noise, static_cast<double>(fit.outliers),
                     static_cast<double>(fit.residuals.samples), fit.residuals.effective_samples,
                     fit.residuals.durbin_watson});
  for (const ParameterEstimate& estimate : fit.parameters) {
    all.push_back(estimate.name + estimate.unit);
    add(estimate.value);
    add(static_cast<double>(estimate.status));
    add(static_cast<double>(estimate.identifiability));
    for (const auto& stated : {estimate.standard_error, estimate.lower95, estimate.upper95}) {
      add(stated);
    }
  }
  add_all(fit.correlation);
  for (const Finding& finding : fit.findings) {
    all.emplace_back(std::string_view(finding.code));
    for (const auto& [name, number] : finding.numbers) add(number);
    all.insert(all.end(), finding.parameters.begin(), finding.parameters.end());
  }
  for (const RecordFit& record : fit.records) {
    add_all(record.reversals);
    add_all(record.counts);
    add_all(record.residual);
    add_all(record.fitted_force);
    add_all(std::array{static_cast<double>(record.left_out), record.displacement_noise,
                       record.structure.repeatable_share, record.facts.amplitude});
  }
  return all;
}

void ExpectSame(const FitResult& one, const FitResult& other) {
  EXPECT_EQ(Statements(one), Statements(other));
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
  const FitOptions options{.preparation = {.force_sense = 1}};
  Fitter used(options);
  Fitter fresh(options);
  const Record good = Loop();
  const Record wrong = testing::Scaled(Loop(), 1.0, -1.0);
  for (const Depth depth : {Depth::kEstimate, Depth::kFull}) {
    ASSERT_TRUE(used.Fit(RecordView(good), depth).converged);
    const FitResult& failed = used.Fit(RecordView(wrong), depth);
    EXPECT_FALSE(failed.converged);
    ASSERT_NE(failed.FindFinding("not_converged"), nullptr);
    EXPECT_EQ(failed.FindFinding("not_converged")->severity, Severity::kFailure);
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

FitOptions OfSteadyCycles() { return {.initial_state = InitialState::kSteady}; }

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
    EXPECT_EQ(errors.parameters[k].standard_error, intervals.parameters[k].standard_error);
    EXPECT_EQ(errors.parameters[k].upper95, intervals.parameters[k].upper95);
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
