#include "mindahl/tradeoff/work_precision.h"

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <set>

#include "../methods/responses.h"
#include "../support/histories.h"
#include "support/prelude.h"

namespace mindahl::tradeoff::work_precision_test {
namespace {

using namespace models;
using namespace methods;

// A virgin stroke, and a cycle from the turning point at sample 1 to the end.
const History kDisplacement = {0, 1, 0, -1, 0, 1};
const History kExact = {0, 2, -1, -2, 1, 2};

TEST(Compare, MatchesCaseComputedByHand) {
  // Errors over the peak: ½ at the fifth sample. Energy −½ + 1½ − ½ + 1½ = 2 against ½ more.
  const Precision precision = Compare(kExact, kDisplacement, History{0, 2, -1, -2, 1.5, 2});
  EXPECT_DOUBLE_EQ(precision.max_force, 0.25);
  ASSERT_TRUE(precision.energy);
  EXPECT_DOUBLE_EQ(*precision.energy, 0.25);
}

TEST(Compare, ClosesACycleThatEndsBesideItsBeginningByAChord) {
  // To 2 % of its width. The chord takes back what the last step has too little.
  History displacement = kDisplacement;
  displacement.back() = 0.96;
  EXPECT_DOUBLE_EQ(
      *Compare(kExact, displacement, History{0, 2, -1, -2, 1.5, 2}).energy,
      (-0.5 + 1.5 - 0.25 + 1.75 * 0.96 + 2 * 0.04) / (-0.5 + 1.5 - 0.5 + 1.5 * 0.96 + 2 * 0.04) -
          1);
}

TEST(Compare, CountsALoopWithinACycleWithIt) {
  const History displacement = {0, 3, 0, -1, 0, -3, 0, 3};
  const History exact = {0, 3, 0, -1, 1, -3, 0, 3};
  History force = exact;
  force[4] = 2;
  const double within = *Compare(exact, displacement, force).energy;
  const auto area = [&](const History& of) {
    double sum = 0.0;
    for (std::size_t i = 2; i < of.size(); ++i) {
      sum += (of[i] + of[i - 1]) / 2 * (displacement[i] - displacement[i - 1]);
    }
    return sum;
  };
  EXPECT_DOUBLE_EQ(within, std::abs(area(force) / area(exact) - 1));
}

TEST(Compare, KnowsNoEnergyErrorWhereNoCycleCloses) {
  const auto has_energy = [](const History& displacement) {
    History exact(displacement.size());
    Prepare({"mindlin-dahl", "exact"}, {1, 1.0 / 3, 1})({.displacement = displacement}, exact);
    History force = exact;
    for (double& at : force) at *= 1.1;
    return Compare(exact, displacement, force).energy.has_value();
  };
  EXPECT_FALSE(has_energy({0, 1, 2, 3}));
  EXPECT_FALSE(has_energy({0, 1, 2, 1, 0}));  // back where it is unloaded: a stroke and a half
  EXPECT_FALSE(has_energy({0, 1, 0, -1, 0, 0.85}));      // short of it by 7.5 % of its width
  EXPECT_FALSE(has_energy({0, 1, -1.2, 1.44, -1.728}));  // it grows
  EXPECT_FALSE(has_energy({0, 1, 0, -2, 0, 1}));         // another branch leads to 1 than left it
  EXPECT_TRUE(has_energy({0, 1, 0, -1, 0, 1, 0.5}));
  EXPECT_TRUE(has_energy({1, 0, -1, 0, 1}));  // the first row is a loading step
}

WorkPrecision Point(double cost, double force, std::optional<double> energy = std::nullopt) {
  return {.precision = {.max_force = force, .energy = energy}, .cost = cost};
}

TEST(CheapestWithin, IsTheSimplestOfTheCheapestWhoseErrorsAreWithin) {
  const std::vector<WorkPrecision> points = {Point(1, 0.2, 1.0), Point(10.5, 0.01, 0.01),
                                             Point(10, 0.005, 0.01), Point(20, 0, 0)};
  EXPECT_EQ(CheapestWithin(1, points), 0U);
  EXPECT_EQ(CheapestWithin(0.2, points), 1U);  // a tenth of the cost is no difference
  EXPECT_EQ(CheapestWithin(1e-9, points), 3U);
  for (const double tolerance : {0.0, -0.1, 1.1, std::nan("")}) {
    EXPECT_THROW(CheapestWithin(tolerance, points), InvalidArgument);
  }
}

TEST(MeasureWorkPrecision, ComparesEachInItsOrder) {
  const BranchLaw law{1, 1.0 / 3, 1};
  const std::vector<double> drive = Displacements({.amplitude = 1.2, .cycles = 2});
  const auto points = MeasureWorkPrecision(law, {.displacement = drive});
  const std::vector<Approximation> ways = AllApproximations();
  ASSERT_EQ(points.size(), ways.size());
  const auto exact = DefinedForce<Extended>(law, drive);
  for (std::size_t i = 0; i < ways.size(); ++i) {
    EXPECT_EQ(points[i].approximation.method, ways[i].method);
    std::vector<double> force(drive.size());
    const double cost = Prepare(ways[i], law)({.displacement = drive}, force);
    EXPECT_DOUBLE_EQ(points[i].cost, 1.5 + cost / static_cast<double>(drive.size()));
    constexpr double kRounding = 1e-14;
    EXPECT_NEAR(points[i].precision.max_force, LargestDifference(force, exact) / Largest(exact),
                kRounding);
  }
}

// ---

TEST(Approximation, EvaluatesAsAskedFor) {
  // α = 0 under the name of Jenkins' model: a corner at Tc/σ = 0.75.
  const std::vector<double> drive = {0.5, 1.0, 0.5};
  std::vector<double> force(3);
  Prepare({"jenkins", "exact"}, {4, 0.6, 3})({.displacement = drive}, force);
  EXPECT_THAT(force, ElementsAre(2, 3, 1));
}

TEST(Approximation, RefusesUnknownNames) {
  EXPECT_THROW(Prepare({"stribeck", "exact"}, {1, 0.5, 1}), InvalidArgument);
  EXPECT_THROW(Prepare({"mindlin", "leapfrog"}, {1, 0.5, 1}), InvalidArgument);
  EXPECT_THROW(Prepare({"mindlin", ""}, {1, 0.5, 1}), InvalidArgument);
}

TEST(AllApproximations, NameTheModelsFromTheSimplestToTheExactOneThenItsMethods) {
  const std::vector<std::string> models = {"jenkins", "simplified-dahl", "dahl", "mindlin-dahl"};
  const std::vector<Approximation> all = AllApproximations();
  std::set<std::string> methods;
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].model, models[std::min(i, models.size() - 1)]);
    methods.insert(all[i].method);
  }
  EXPECT_EQ(methods.size(), Methods().size());
}

}  // namespace
}  // namespace mindahl::tradeoff::work_precision_test
