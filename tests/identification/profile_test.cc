#include "identification/inference/profile.h"

#include "identification/stages.h"
#include "support/prelude.h"

// Where the likelihood is profiled, what that gives, and what it does to intervals.
namespace mindahl::identification::profile_test {
namespace {

using namespace loop;
using namespace models;

constexpr BranchLaw kMindlin{4e7, 1.0 / 3, 40.0};
constexpr double kGrossSlip = 1.5e-6;  // [m]

Record NoisyLoop(double lambda, double noise, std::uint64_t seed) {
  Generator generator(seed);
  const auto displacement = Cycling(Wave::kSine, lambda * kGrossSlip, 2.0, 120);
  return WithForceNoise(
      MakeRecord(displacement, Respond(Model("mindlin-dahl"), kMindlin, displacement)),
      noise * kMindlin.slip_force, generator);
}

/// Made estimates of σ, α and Tc, widened by a profile.
FitResult Widened(const SlipForceProfile& profile, double peak_force, bool shape_is_fixed = false) {
  const auto displacement = Cycling(Wave::kSine, 1.0, 2.0, 40);
  Stages stages(MakeRecord(displacement, displacement));
  FitResult result;
  for (const char* name : {"sigma", "alpha", "slip_force"}) {
    ParameterEstimate& estimate = result.parameters.emplace_back();
    estimate.name = name;
    estimate.value = 1.0;
    estimate.standard_error = 0.05;
    estimate.lower95 = 0.9;
    estimate.upper95 = 1.1;
    estimate.interval = {{IntervalSource::kParabola, 0.9, 1.1}};
    estimate.status = ParameterStatus::kFree;
  }
  if (shape_is_fixed) {
    result.parameters[1].status = ParameterStatus::kFixed;
    result.parameters[1].standard_error = result.parameters[1].lower95 =
        result.parameters[1].upper95 = std::nullopt;
    result.parameters[1].interval.clear();
  }
  const double carried = CarriedForce(stages.problem, result, peak_force);
  result.parameters =
      WidenByProfile(stages.problem, profile, 2.0, carried, std::move(result.parameters));
  return result;
}

TEST(Profile, TakesTheWiderOfBothAtEachEnd) {
  // The records' units are 1: σ and Tc are exp θ, α is θ.
  SlipForceProfile profile;
  profile.ranges[kStiffness] = {std::log(0.95), std::log(1.05)};
  profile.ranges[kShape] = {0.5, 1.05};
  profile.ranges[kSlipForce] = {std::log(0.95), std::log(1.5)};
  const FitResult result = Widened(profile, 0.0);
  const ParameterEstimate& sigma = result.parameters[0];
  EXPECT_EQ(*sigma.lower95, 0.9);
  EXPECT_EQ(*sigma.upper95, 1.1);
  EXPECT_NEAR(*sigma.standard_error, 0.05, 1e-12);
  const ParameterEstimate& alpha = result.parameters[1];
  EXPECT_NEAR(*alpha.lower95, 0.5, 1e-12);
  EXPECT_EQ(*alpha.upper95, 1.1);
  EXPECT_NEAR(*alpha.standard_error, 0.3 / 2.0, 1e-12) << "half the width over the quantile";
  const ParameterEstimate& slip_force = result.parameters[2];
  EXPECT_EQ(*slip_force.lower95, 0.9);
  EXPECT_NEAR(*slip_force.upper95, 1.5, 1e-12);
  EXPECT_NEAR(*slip_force.standard_error, 0.3 / 2.0, 1e-12);
}

TEST(Profile, OpenAboveLeavesAtLeastTheForceThatWasCarried) {
  SlipForceProfile open{.open_above = true};
  open.ranges[kSlipForce] = {std::log(0.8), std::log(20)};
  open.ranges[kShape] = {0.2, 5.0};
  open.ranges[kStiffness] = {0.0, 0.0};
  const FitResult result = Widened(open, 0.97);
  EXPECT_NEAR(*result.parameters[2].lower95, 0.97, 1e-12);
  EXPECT_FALSE(result.parameters[2].upper95 || result.parameters[2].standard_error);
  EXPECT_FALSE(result.parameters[1].upper95 || result.parameters[1].standard_error);
  EXPECT_NEAR(*result.parameters[1].lower95, 0.2, 1e-12);
  EXPECT_TRUE(result.parameters[0].upper95) << "of the stiffness nothing is open";
  // A fit too poor to have carried it is not its own limit: the profile's stays.
  EXPECT_NEAR(*Widened(open, 1.3).parameters[2].lower95, 0.8, 1e-12);
  EXPECT_FALSE(Widened(open, 0.97, /*shape_is_fixed=*/true).parameters[1].lower95);
}

TEST(Profile, EndsWhereTheLikelihoodRatioIsCritical) {
  // At the ends of Tc's range, found again by a fit with Tc held there, F is that of 95 %; of
  // autocorrelated noise by the share that its white part would have of the variance.
  const Record record = NoisyLoop(1.3, 0.02, 4);
  const double variance = 4e-4;
  for (const double rho : {0.0, 0.6}) {
    Stages stages(record);
    const Solution best = stages.Solve();
    Noise noise = KnownNoise(variance, stages.data.counted);
    if (rho > 0) noise.autocorrelation = testing::FirstOrder(rho);
    const Estimates estimates(stages.problem, best, noise, {}, {}, stages.buffers.response);
    const double share = estimates.WhiteShare(kSlipForce);
    EXPECT_EQ(share<0.5, rho> 0);
    const SlipForceProfile profile =
        ProfileSlipForce({stages.problem, best, noise, estimates}, stages.options, stages.buffers);
    EXPECT_FALSE(profile.open_above);
    for (const double end : {profile.ranges[kSlipForce].lower, profile.ranges[kSlipForce].upper}) {
      FitOptions held;
      held.fixed["slip_force"] = stages.problem.parameters[kSlipForce].ToValue(end);
      const double cost = Stages(record, held).Solve().sum_of_squares - best.sum_of_squares;
      const double critical = estimates.quantile() * estimates.quantile();
      // Six bisections of a step of 0.05 or more in ln Tc.
      EXPECT_LT(cost / variance * share, critical * 1.001);
      EXPECT_GT(cost / variance * share, critical * 0.7);
    }
    EXPECT_LT(profile.ranges[kSlipForce].lower, best.theta[kSlipForce]);
    EXPECT_GT(profile.ranges[kSlipForce].upper, best.theta[kSlipForce]);
    EXPECT_LT(profile.ranges[kShape].lower, best.theta[kShape]);
    EXPECT_GT(profile.ranges[kShape].upper, best.theta[kShape]);
    EXPECT_LT(profile.ranges[kStiffness].lower, best.theta[kStiffness]);
  }
}

TEST(Profile, IsOpenWhereTheBoundOfTheShapeEndsTheValley) {
  // Far from slip α rises with Tc; a bound on α holds Tc back, and not the data.
  FitOptions options;
  options.bounds["alpha"] = {0.0, 0.7};
  Stages stages(NoisyLoop(0.5, 0.0005, 3), options);
  const Solution best = stages.Solve();
  ASSERT_EQ(best.side[kShape], BoundSide::kInside);
  for (const double variance : {1e-6, 1e-3}) {
    const Noise noise = KnownNoise(variance, stages.data.counted);
    const Estimates estimates(stages.problem, best, noise, {}, {}, stages.buffers.response);
    const SlipForceProfile profile =
        ProfileSlipForce({stages.problem, best, noise, estimates}, stages.options, stages.buffers);
    if (variance > 1e-5) {
      EXPECT_EQ(SideOf(stages.problem.parameters[kShape], profile.ranges[kShape].upper),
                BoundSide::kUpper);
    }
    EXPECT_EQ(profile.open_above, variance > 1e-5);
  }
}

}  // namespace
}  // namespace mindahl::identification::profile_test
