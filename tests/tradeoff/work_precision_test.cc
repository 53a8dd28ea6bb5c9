#include "mindahl/tradeoff/work_precision.h"

#include <boost/multiprecision/cpp_bin_float.hpp>

#include "../methods/responses.h"
#include "../support/histories.h"
#include "support/prelude.h"

namespace mindahl::tradeoff::work_precision_test {
namespace {

using namespace models;
using namespace methods;

using Digits100 = boost::multiprecision::cpp_bin_float_100;

// --- MakeReferenceResponse ------------------------------------------------------------------

TEST(ReferenceResponse, IsTheLawAsDefinedInHundredDigits) {
  // Worked out in long double, rounded to double; differences of displacements to double.
  constexpr double kAccuracy = 1e-15;  // of the peak force, a few ε
  for (const double alpha : {0.0, 1e-8, 1.0 / 3, 0.5, 1.0, 2.0}) {
    const BranchLaw law{3.0, alpha, 0.5};
    for (const Waveform waveform :
         {Waveform::kSine, Waveform::kGrowingSine, Waveform::kRandom, Waveform::kNested}) {
      for (const double lambda : {1e-4, 0.8, 1.3}) {
        const std::vector<double> drive =
            Displacements({.waveform = waveform,
                           .amplitude = lambda * ReferenceDisplacement(law),
                           .cycles = 4,
                           .samples_per_cycle = 15,
                           .seed = 11});
        const auto defined = DefinedForce<Digits100>(law, drive);
        const ReferenceResponse reference = MakeReferenceResponse(law, {.displacement = drive});
        EXPECT_LE(LargestDifference(reference.force, defined), kAccuracy * Largest(defined))
            << alpha << " " << lambda;
        EXPECT_NEAR(reference.peak_force, Largest(defined), kAccuracy * Largest(defined));
      }
    }
  }
}

TEST(ReferenceResponse, IsTheLawAsDefinedOnRandomHistoriesWithDwells) {
  constexpr double kAccuracy = 1e-14;  // of Tc; long double loses less
  Generator generator(424242);
  for (int i = 0; i < 300; ++i) {
    const BranchLaw law{1.0, i % 3 == 0 ? 1.0 / 3 : 0.2 * static_cast<double>(i % 9), 1.0};
    const History history = RandomHistory(generator);
    const ReferenceResponse reference = MakeReferenceResponse(law, {.displacement = history});
    EXPECT_LE(LargestDifference(reference.force, DefinedForce<Extended>(law, history)), kAccuracy)
        << i;
  }
}

TEST(ReferenceResponse, RefusesInvalidDrive) {
  const BranchLaw law{1, 0.5, 1};
  const History not_finite = {0, std::numeric_limits<double>::infinity()};
  EXPECT_THROW(MakeReferenceResponse(law, {}), InvalidArgument);
  EXPECT_THROW(MakeReferenceResponse(law, {.displacement = not_finite}), InvalidArgument);
  EXPECT_THROW(MakeReferenceResponse({1, 0.5, 0}, {.displacement = History{0, 1}}),
               InvalidArgument);
}

// --- Compare --------------------------------------------------------------------------------

const History kDisplacement = {0, 1, 2, 1};
const ReferenceResponse kReference{.force = {0, 2, 4, 0}, .peak_force = 4};
const Drive kDrive{.displacement = kDisplacement};

TEST(Compare, MatchesCaseComputedByHand) {
  // Errors over the peak 0, ¼, 0, ¼. Work 1 + 3 − 2 = 2 against 1.5 + 3.5 − 2.5 = 2.5.
  const Precision precision = Compare(kReference, kDrive, History{0, 3, 4, 1});
  EXPECT_DOUBLE_EQ(precision.max_force, 0.25);
  EXPECT_DOUBLE_EQ(precision.rms_force, std::sqrt(1.0 / 32));
  ASSERT_TRUE(precision.energy);
  EXPECT_DOUBLE_EQ(*precision.energy, 0.25);
}

TEST(Compare, CountsFromTheGivenFirstSample) {
  // Errors 0, −½; work (4 + 0)/2·(−1) = −2 against (4 − 2)/2·(−1) = −1.
  const Precision precision = Compare(kReference, kDrive, History{9, 9, 4, -2}, 2);
  EXPECT_DOUBLE_EQ(precision.max_force, 0.5);
  EXPECT_DOUBLE_EQ(precision.rms_force, std::sqrt(1.0 / 8));
  ASSERT_TRUE(precision.energy);
  EXPECT_DOUBLE_EQ(*precision.energy, 0.5);
  EXPECT_FALSE(Compare(kReference, kDrive, History{0, 2, 4, 0}, 3).energy);
}

TEST(Compare, KnowsNoEnergyErrorWhereNothingIsDone) {
  const History there_and_back = {0, 1, 0};
  const ReferenceResponse spring{.force = {0, 2, 0}, .peak_force = 2};
  const Precision precision = Compare(spring, {.displacement = there_and_back}, History{0, 2, 1});
  EXPECT_FALSE(precision.energy);
  EXPECT_EQ(ErrorBy(Criterion::kEnergy, precision), std::numeric_limits<double>::infinity());
}

TEST(Compare, TakesAForceThatIsNoNumberAsInfinitelyWrong) {
  const Precision precision = Compare(kReference, kDrive, History{0, std::nan(""), 4, 0});
  EXPECT_EQ(ErrorBy(Criterion::kMaxForce, precision), std::numeric_limits<double>::infinity());
  EXPECT_FALSE(ErrorBy(Criterion::kRmsForce, precision) <= 1);
  EXPECT_FALSE(ErrorBy(Criterion::kEnergy, precision) <= 1);
}

TEST(Compare, UsesTheQuantityNamedByTheCriterion) {
  const Precision precision{.max_force = 1, .rms_force = 2, .energy = 3};
  EXPECT_EQ(ErrorBy(Criterion::kMaxForce, precision), 1);
  EXPECT_EQ(ErrorBy(Criterion::kRmsForce, precision), 2);
  EXPECT_EQ(ErrorBy(Criterion::kEnergy, precision), 3);
}

TEST(Compare, RefusesSizesThatDifferAndAFirstSampleOutside) {
  EXPECT_THROW(Compare(kReference, kDrive, History{0, 1}), InvalidArgument);
  EXPECT_THROW(Compare(kReference, kDrive, History{0, 1, 2, 3}, 4), InvalidArgument);
}

// --- ParetoFront ----------------------------------------------------------------------------

std::vector<bool> Front(const std::vector<std::pair<double, double>>& cost_and_error) {
  std::vector<WorkPrecision> points;
  for (const auto& [cost, error] : cost_and_error) {
    points.push_back({.precision = {.max_force = error}, .cost = cost});
  }
  return ParetoFront(points, Criterion::kMaxForce);
}

TEST(ParetoFront, HoldsWhatNothingBeatsInBoth) {
  EXPECT_EQ(Front({{1, 9}, {2, 5}, {3, 6}, {4, 1}, {5, 1.5}}),
            (std::vector<bool>{true, true, false, true, false}));
}

TEST(ParetoFront, TakesTheBetterOfTwoThatTieInOne) {
  EXPECT_EQ(Front({{1, 5}, {1, 4}}), (std::vector<bool>{false, true}));
  EXPECT_EQ(Front({{2, 4}, {1, 4}}), (std::vector<bool>{false, true}));
}

TEST(ParetoFront, TakesTheFirstOfEquals) {
  EXPECT_EQ(Front({{1, 4}, {1, 4}, {1, 4}}), (std::vector<bool>{true, false, false}));
}

TEST(ParetoFront, TakesTheCheapestOfErrorsThatAreNotKnown) {
  // Neither has an energy error, so that both are infinitely wrong.
  const std::vector<WorkPrecision> points = {{.cost = 2}, {.cost = 1}};
  EXPECT_EQ(ParetoFront(points, Criterion::kEnergy), (std::vector<bool>{false, true}));
  EXPECT_TRUE(ParetoFront({}, Criterion::kEnergy).empty());
}

// --- Measuring ------------------------------------------------------------------------------

TEST(MeasureWorkPrecision, MeasuresEachInItsOrder) {
  const BranchLaw law{1, 1.0 / 3, 1};
  const std::vector<double> drive = Displacements({.amplitude = 1.2, .cycles = 2});
  const std::vector<Approximation> ways = {
      {"mindlin", "exact"}, {"spring", ""}, {"mindlin", "euler", {.steps = 2}}};
  const auto points = MeasureWorkPrecision(law, {.displacement = drive}, ways);
  ASSERT_EQ(points.size(), ways.size());
  const auto exact = DefinedForce<Extended>(law, drive);
  for (std::size_t i = 0; i < ways.size(); ++i) {
    EXPECT_EQ(Describe(points[i].approximation), Describe(ways[i]));
    EXPECT_GT(points[i].cost, 0.0);
    std::vector<double> force(drive.size());
    Prepare(ways[i], law)({.displacement = drive}, force);
    constexpr double kRounding = 1e-14;
    EXPECT_NEAR(points[i].precision.max_force, LargestDifference(force, exact) / Largest(exact),
                kRounding);
  }
  const CostFloor floor = MeasureCostFloor({.displacement = drive});
  EXPECT_GT(floor.memory, 0.0);
  EXPECT_GT(floor.arithmetic, 0.0);
}

}  // namespace
}  // namespace mindahl::tradeoff::work_precision_test
