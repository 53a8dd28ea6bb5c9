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

const History kDisplacement = {0, 1, 2, 1};
const History kExact = {0, 2, 4, 0};

TEST(Compare, MatchesCaseComputedByHand) {
  // Errors over the peak 0, ¼, 0, ¼. Work 1 + 3 − 2 = 2 against 1.5 + 3.5 − 2.5 = 2.5.
  const Precision precision = Compare(kExact, kDisplacement, History{0, 3, 4, 1});
  EXPECT_DOUBLE_EQ(precision.max_force, 0.25);
  ASSERT_TRUE(precision.energy);
  EXPECT_DOUBLE_EQ(*precision.energy, 0.25);
}

TEST(Compare, KnowsNoEnergyErrorWhereNothingIsDone) {
  EXPECT_FALSE(Compare(History{0, 2, 0}, History{0, 1, 0}, History{0, 2, 1}).energy);
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
