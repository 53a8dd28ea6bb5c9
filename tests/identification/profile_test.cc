#include "identification/inference/profile.h"

#include "identification/stages.h"
#include "support/prelude.h"

// Where the likelihood is profiled, what that gives, and what it does to intervals.
namespace mindahl::identification::profile_test {
namespace {

constexpr BranchLaw kMindlin{4e7, 1.0 / 3, 40.0};
constexpr double kGrossSlip = 1.5e-6;  // [m]

Record NoisyLoop(double lambda, double noise, std::uint64_t seed) {
  Generator generator(seed);
  const auto displacement = Cycling(Wave::kSine, lambda * kGrossSlip, 2.0, 120);
  return WithForceNoise(testing::LoopOf(kMindlin, displacement), noise * kMindlin.slip_force,
                        generator);
}

TEST(Profile, EndsWhereTheLikelihoodRatioIsCritical) {
  // At the ends of Tc's interval, found again by a fit with Tc held there, F is that of 95 %; of
  // autocorrelated noise by the share that its white part would have of the variance.
  const Record record = NoisyLoop(1.3, 0.02, 4);
  const double variance = 4e-4;
  for (const double rho : {0.0, 0.6}) {
    Stages stages(record);
    const Solution best = stages.Solve();
    Noise noise = KnownNoise(variance, stages.data.counted);
    if (rho > 0) noise.autocorrelation = testing::FirstOrder(rho);
    const Estimates estimates = testing::EstimatesOf(stages, best, noise);
    const double share = variance * estimates.FStatistic(kSlipForce, best.sum_of_squares + 1);
    EXPECT_EQ(share<0.5, rho> 0);
    Region region;
    const Ends ends = Profile(estimates, kSlipForce, region);
    ASSERT_TRUE(ends.lower && ends.upper);
    for (const double end : {*ends.lower, *ends.upper}) {
      const double cost = Stages(record, {.fixed = {{"slip_force", end}}}).Solve().sum_of_squares -
                          best.sum_of_squares;
      const double critical = estimates.quantile() * estimates.quantile();
      EXPECT_NEAR(cost / variance * share, critical, 0.03 * critical);  // a hundredth of its root
    }
    const double value = stages.problem.parameters[kSlipForce].ToValue(best.theta[kSlipForce]);
    EXPECT_LT(*ends.lower, value);
    EXPECT_GT(*ends.upper, value);
  }
}

TEST(Profile, CoversWhatOneSampleOfAStrokeLeavesOpen) {
  // If only one sample of a stroke lies in partial slip, every α fits with a σ of its own, up to
  // the α at which a second sample lies there. The sum of squares has an edge at that α, and the
  // parabola describes one side of the edge only.
  int covered = 0;
  constexpr int kLoops = 12;
  for (std::uint64_t seed = 0; seed < kLoops; ++seed) {
    Generator generator(seed);
    const History displacement = Cycling(Wave::kTriangle, 14 * kGrossSlip, 3.0, 40);
    const Record record = WithForceNoise(testing::LoopOf(kMindlin, displacement),
                                         0.002 * kMindlin.slip_force, generator);
    const FitResult fit = FitOne(record);
    const auto covers = [&](const char* name, double value) {
      const ParameterEstimate& estimate = *fit.Find(name);
      return std::clamp(value, *estimate.lower95, *estimate.upper95) == value;
    };
    if (covers("alpha", kMindlin.shape_exponent) &&
        covers("sigma", kMindlin.tangential_stiffness)) {
      ++covered;
    }
  }
  EXPECT_GE(covered, kLoops - 1);
}

TEST(Profile, IsOpenWhereTheBoundOfTheShapeEndsTheValley) {
  // Far from slip α rises with Tc; a bound on α holds Tc back, and not the data.
  Stages stages(NoisyLoop(0.5, 0.0005, 3), {.bounds = {{"alpha", {0.0, 0.7}}}});
  const Solution best = stages.Solve();
  ASSERT_EQ(SideOf(stages.problem.parameters[kShape], best.theta[kShape]), BoundSide::kInside);
  for (const double variance : {1e-6, 1e-3}) {
    const Noise noise = KnownNoise(variance, stages.data.counted);
    const Estimates estimates = testing::EstimatesOf(stages, best, noise);
    Region region;
    const Ends ends = Profile(estimates, kSlipForce, region);
    EXPECT_EQ(ends.upper.has_value(), variance < 1e-5);
  }
}

TEST(Profile, LeavesOpenWhatASpringHides) {
  // For α = ½ and short of slip σx − σ²x²/(4Tc) + kx is a family of equal curves: σ + k and σ²/Tc.
  constexpr BranchLaw kSquare{4e7, 0.5, 40.0};
  const double slip = GrossSlipDisplacement(kSquare);
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    Generator generator(seed);
    const double reach = (0.5 + 0.04 * static_cast<double>(seed)) * slip;
    const Record record =
        WithForceNoise(testing::LoopOf(kSquare, Cycling(Wave::kSine, reach, 2.0, 100)),
                       0.001 * kSquare.slip_force, generator);
    const FitResult fit = FitOne(record, {.terms = {"plateau_slope"}});
    SCOPED_TRACE(reach / slip);
    EXPECT_FALSE(fit.Find("slip_force")->upper95);
    for (const auto& [name, value] :
         {std::pair("sigma", kSquare.tangential_stiffness),
          std::pair("slip_force", kSquare.slip_force), std::pair("plateau_slope", 0.0)}) {
      const ParameterEstimate& estimate = *fit.Find(name);
      if (estimate.identifiability == Identifiability::kNotIdentifiable) continue;
      EXPECT_LE(estimate.lower95.value_or(value), value) << name;
      EXPECT_GE(estimate.upper95.value_or(value), value) << name;
    }
  }
}

TEST(Profile, GivesNoStiffnessAtTheEndOfAWideIntervalBesideASpring) {
  // With Tc open, σ is any of a range whose lower end is next to the best fit, and the spring has
  // the rest: neither is determined where the range goes beyond three times the value.
  constexpr double kEitherWay = 3.0;
  int open = 0;
  for (const double shape : {0.05, 0.5, 0.7, 1.0}) {
    for (const double noise : {0.001, 0.01}) {
      const BranchLaw law{4e7, shape, 40.0};
      Generator generator(1);
      const auto displacement =
          Cycling(Wave::kSine, 0.6 * law.slip_force / law.tangential_stiffness, 3.0, 200);
      const Record record =
          WithForceNoise(testing::LoopOf(law, displacement), noise * law.slip_force, generator);
      const FitResult fit = FitOne(record, {.terms = {"plateau_slope"}});
      SCOPED_TRACE(fmt::format("α {}, noise {}", shape, noise));
      const ParameterEstimate& sigma = *fit.Find("sigma");
      if (sigma.is_known()) {
        EXPECT_LE(*sigma.upper95, kEitherWay * sigma.value);
        EXPECT_GE(*sigma.lower95, sigma.value / kEitherWay);
        continue;
      }
      ++open;
      EXPECT_EQ(fit.Find("plateau_slope")->identifiability, Identifiability::kNotIdentifiable);
    }
  }
  EXPECT_GT(open, 0);
}

}  // namespace
}  // namespace mindahl::identification::profile_test
