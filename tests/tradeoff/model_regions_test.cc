

#include "mindahl/models/branch_law.h"
#include "mindahl/models/steady_loop.h"
#include "mindahl/tradeoff/work_precision.h"
#include "support/prelude.h"

namespace mindahl::tradeoff::model_regions_test {
namespace {

using namespace models;

constexpr double kBounds = 2e-3;  // relative, of λ, as work_precision.h states

class MindlinRegions : public ::testing::Test {
 protected:
  static const BranchLaw& law() {
    static const BranchLaw kLaw{4.839e8, 1.0 / 3, 3};
    return kLaw;
  }
  static const std::vector<ModelRegion>& regions() {
    static const std::vector<ModelRegion> kRegions = FindModelRegions(law());
    return kRegions;
  }
  static const ModelRegion& Region(std::string_view model, std::size_t cycle, Criterion criterion,
                                   double tolerance) {
    const auto found = std::ranges::find_if(regions(), [&](const ModelRegion& region) {
      return region.model == model && region.cycle == cycle && region.criterion == criterion &&
             region.tolerance == tolerance;
    });
    if (found == regions().end()) throw std::out_of_range("no such region");
    return *found;
  }
};

/// λ where an error that rises, or falls, passes the tolerance.
double Solve(const std::function<double(double)>& error, double tolerance, double low,
             double high) {
  const bool rises = error(high) > error(low);
  for (int i = 0; i < 200; ++i) {
    const double middle = std::sqrt(low * high);
    ((error(middle) > tolerance) == rises ? high : low) = middle;
  }
  return low;
}

TEST_F(MindlinRegions, HoldEveryModelCycleCriterionAndTolerance) {
  EXPECT_EQ(regions().size(), 6U * 5 * 2 * 3);
}

TEST_F(MindlinRegions, TheSpringServesUpToItsExcessOverTheVirginCurve) {
  const auto error = [&](double lambda) {
    const double x = lambda * GrossSlipDisplacement(law());
    return law().tangential_stiffness * x / BackboneForce(law(), x) - 1;
  };
  for (const double tolerance : {0.001, 0.01, 0.05}) {
    const double bound = Solve(error, tolerance, 1e-4, 0.9);
    // T = σx − ασ²x²/(2Tc): the excess is αy/2 of T to first order, y = λ/(1−α).
    EXPECT_NEAR(bound / (4 * tolerance), 1, 2 * tolerance);
    for (std::size_t cycle = 1; cycle <= 5; ++cycle) {
      const ModelRegion& region = Region("spring", cycle, Criterion::kMaxForce, tolerance);
      ASSERT_EQ(region.ranges.size(), 1U);
      EXPECT_EQ(region.ranges[0].from, 1e-4);
      EXPECT_NEAR(region.ranges[0].to / bound, 1, kBounds);
    }
  }
}

TEST_F(MindlinRegions, ModelsWithoutPreslidingOrSlipMissTheEnergyOrTheForceEverywhere) {
  for (const double tolerance : {0.001, 0.01, 0.05}) {
    for (std::size_t cycle = 1; cycle <= 5; ++cycle) {
      EXPECT_TRUE(Region("spring", cycle, Criterion::kEnergy, tolerance).ranges.empty());
      EXPECT_TRUE(Region("coulomb", cycle, Criterion::kMaxForce, tolerance).ranges.empty());
    }
  }
}

TEST_F(MindlinRegions, CoulombAndJenkinsServeTheEnergyFromWhereTheirRectanglesDo) {
  const double tc = law().slip_force;
  const auto amplitude = [&](double lambda) { return lambda * GrossSlipDisplacement(law()); };
  const auto exact = [&](double lambda) {
    return SteadyLoopEnergy(*FindFrictionModel("mindlin"), law(), amplitude(lambda));
  };
  const auto coulomb = [&](double lambda) {
    return std::abs(4 * amplitude(lambda) * tc / exact(lambda) - 1);
  };
  const auto jenkins = [&](double lambda) {
    const double elastic = tc / law().tangential_stiffness;
    return std::abs(4 * (amplitude(lambda) - elastic) * tc / exact(lambda) - 1);
  };
  for (const double tolerance : {0.001, 0.01, 0.05}) {
    // W = 4XTc − 8Tc²/(σ(2−α)) beyond slip: an error of t at λ = 2(1−α)/(2−α)·(1 + 1/t).
    const double coulomb_bound = Solve(coulomb, tolerance, 2, 1e6);
    EXPECT_NEAR(coulomb_bound / (0.8 * (1 + 1 / tolerance)), 1, 1e-9);
    // Jenkins' is 4XTc − 4Tc²/σ: too large by 4·α/(2−α)·Tc²/σ.
    const double jenkins_bound = Solve(jenkins, tolerance, 2, 1e6);
    EXPECT_NEAR(jenkins_bound / (0.8 + 2.0 / 15 / tolerance), 1, 1e-9);
    for (std::size_t cycle = 1; cycle <= 5; ++cycle) {
      for (const auto& [model, bound] :
           {std::pair{"coulomb", coulomb_bound}, std::pair{"jenkins", jenkins_bound}}) {
        const ModelRegion& region = Region(model, cycle, Criterion::kEnergy, tolerance);
        ASSERT_FALSE(region.ranges.empty()) << model;
        EXPECT_NEAR(region.ranges.back().from / bound, 1, kBounds) << model << " " << tolerance;
        EXPECT_EQ(region.ranges.back().to, 1e6);
      }
    }
  }
}

TEST_F(MindlinRegions, MindlinServesEverywhere) {
  for (const ModelRegion& region : regions()) {
    if (region.model != "mindlin") continue;
    ASSERT_EQ(region.ranges.size(), 1U);
    EXPECT_EQ(region.ranges[0].from, 1e-4);
    EXPECT_EQ(region.ranges[0].to, 1e6);
  }
}

TEST_F(MindlinRegions, SimplifiedDahlIsRightOnceItHasSlippedAndConvergesBefore) {
  // Its branches are those of the steady loop; its first slip, which λ > 1 brings in the first
  // cycle, wipes its wrong start out.
  for (const double tolerance : {0.001, 0.01, 0.05}) {
    double last = 1e6;
    for (std::size_t cycle = 2; cycle <= 5; ++cycle) {
      const auto& ranges = Region("simplified-dahl", cycle, Criterion::kMaxForce, tolerance).ranges;
      ASSERT_FALSE(ranges.empty());
      EXPECT_EQ(ranges.back().to, 1e6);
      EXPECT_LE(ranges.back().from, 1 * (1 + kBounds));
      EXPECT_LE(ranges.back().from, last);
      last = ranges.back().from;
    }
  }
}

TEST_F(MindlinRegions, TheFirstCycleHasTheVirginLoading) {
  // At twice gross slip all that Simplified-Dahl misses is the way to the first reversal: it starts
  // as a steady branch does that comes from −Tc.
  const double reach = 2 * GrossSlipDisplacement(law());
  const FrictionModel& model = *FindFrictionModel("simplified-dahl");
  const BranchScale scale = model.scale(0.0, 1.0, true);
  const double rate = law().tangential_stiffness / law().slip_force *
                      std::pow(scale.remaining, law().shape_exponent - 1) / scale.span;
  double largest = 0.0;  // over Tc, which is the peak
  constexpr int kPlaces = 1000;
  for (int i = 1; i <= kPlaces; ++i) {
    const double x = reach * i / kPlaces;
    const BranchLaw unit{1.0, law().shape_exponent, 1.0};
    const double force = scale.span * scale.remaining * BackboneForce(unit, rate * x);
    largest = std::max(largest, std::abs(force - BackboneForce(law(), x) / law().slip_force));
  }
  constexpr double kTolerance = 0.05;  // the widest of the three
  ASSERT_GT(largest, kTolerance);
  const auto holds_there = [&](std::size_t cycle) {
    const auto& ranges = Region("simplified-dahl", cycle, Criterion::kMaxForce, kTolerance).ranges;
    return std::ranges::any_of(
        ranges, [](const LambdaRange& range) { return range.from <= 2 && 2 <= range.to; });
  };
  EXPECT_FALSE(holds_there(1));
  EXPECT_TRUE(holds_there(2));
}

TEST_F(MindlinRegions, RangesAscendAndDoNotTouch) {
  for (const ModelRegion& region : regions()) {
    double last = 0.0;
    for (const LambdaRange& range : region.ranges) {
      EXPECT_GT(range.from, last);
      EXPECT_GE(range.to, range.from);
      last = range.to;
    }
  }
}

TEST(ModelRegions, AnyShapeHasItsOwnBounds) {
  const BranchLaw law{2, 0.7, 3};
  const auto regions = FindModelRegions(law, {.tolerances = {0.02}, .cycles = 1});
  const auto region = [&](std::string_view model, Criterion criterion) {
    return *std::ranges::find_if(regions, [&](const ModelRegion& candidate) {
      return candidate.model == model && candidate.criterion == criterion;
    });
  };
  const auto error = [&](double lambda) {
    const double x = lambda * GrossSlipDisplacement(law);
    return law.tangential_stiffness * x / BackboneForce(law, x) - 1;
  };
  EXPECT_NEAR(region("spring", Criterion::kMaxForce).ranges[0].to / Solve(error, 0.02, 1e-4, 0.5),
              1, kBounds);
  const double coulomb = 2 * 0.3 / 1.3 * (1 + 1 / 0.02);
  EXPECT_NEAR(region("coulomb", Criterion::kEnergy).ranges.back().from / coulomb, 1, kBounds);
  const auto& exact = region("mindlin-dahl", Criterion::kEnergy).ranges;
  ASSERT_EQ(exact.size(), 1U);
  EXPECT_EQ(exact[0].from, 1e-4);
  EXPECT_LT(region("mindlin", Criterion::kMaxForce).ranges[0].to, 1.0);
}

TEST(ModelRegions, RefuseWhatHasNoLambdaAndOptionsOutOfRange) {
  EXPECT_THROW(FindModelRegions({1, 1.0, 1}), InvalidArgument);
  EXPECT_THROW(FindModelRegions({1, 2.0, 1}), InvalidArgument);
  EXPECT_THROW(FindModelRegions({1, 0.5, -1}), InvalidArgument);
  EXPECT_THROW(FindModelRegions({1, 0.5, 1}, {.tolerances = {0.0}}), InvalidArgument);
  EXPECT_THROW(FindModelRegions({1, 0.5, 1}, {.cycles = 0}), InvalidArgument);
  EXPECT_THROW(FindModelRegions({1, 0.5, 1}, {.least_lambda = 0}), InvalidArgument);
  EXPECT_THROW(FindModelRegions({1, 0.5, 1}, {.least_lambda = 2, .greatest_lambda = 1}),
               InvalidArgument);
}

TEST(FindModelRegions, RefusesARangeThatIsEmpty) {
  const auto study = [](double least, double greatest) {
    return FindModelRegions(
        {1, 0.5, 1},
        {.tolerances = {0.5}, .cycles = 1, .least_lambda = least, .greatest_lambda = greatest});
  };
  try {
    study(2.0, 2.0);
    FAIL();
  } catch (const InvalidArgument& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("greatest lambda [-] = 2"));
  }
  EXPECT_THROW(study(0.0, 2.0), InvalidArgument);
  EXPECT_THROW(study(1.0, std::numeric_limits<double>::infinity()), InvalidArgument);
  EXPECT_NO_THROW(study(1.0, 2.0));
}

}  // namespace
}  // namespace mindahl::tradeoff::model_regions_test
