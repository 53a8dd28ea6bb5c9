#include "mindahl/tradeoff/recommendation.h"

#include <set>

#include "../methods/responses.h"
#include "mindahl/models/friction_model.h"
#include "support/prelude.h"

namespace mindahl::tradeoff::recommendation_test {
namespace {

using namespace models;

constexpr BranchLaw kMindlin{
    .tangential_stiffness = 4.8e8, .shape_exponent = 1.0 / 3, .slip_force = 3};

std::vector<double> Sine(double lambda, double cycles, std::size_t samples_per_cycle = 200) {
  return Displacements({.amplitude = lambda * GrossSlipDisplacement(kMindlin),
                        .cycles = cycles,
                        .samples_per_cycle = samples_per_cycle});
}

Recommendation RecommendFor(const std::vector<double>& drive, const RecommendOptions& options) {
  return Recommend(kMindlin, {.displacement = drive}, options);
}

std::string Choice(const Recommendation& recommendation) {
  return recommendation.choice
             ? Describe(recommendation.candidates[*recommendation.choice].point.approximation)
             : "none";
}

const Candidate& Find(const Recommendation& recommendation, std::string_view model) {
  return *std::ranges::find_if(recommendation.candidates, [&](const Candidate& candidate) {
    return candidate.point.approximation.model == model;
  });
}

TEST(Recommend, ASpringForATinyAmplitude) {
  const Recommendation recommendation = RecommendFor(Sine(1e-3, 5), {.tolerance = 0.01});
  EXPECT_EQ(Choice(recommendation), "spring");
  EXPECT_NEAR(recommendation.cycles, 5, 1e-12);
}

TEST(Recommend, CoulombForAHugeAmplitude) {
  EXPECT_EQ(Choice(RecommendFor(Sine(1e6, 5), {.tolerance = 0.01})), "coulomb");
}

TEST(Recommend, NoSimplerModelWhereTheContactIsNeeded) {
  // Sprung, elastic or Dahl's loops err by a tenth of the peak force and more.
  const Recommendation recommendation = RecommendFor(Sine(0.8, 6), {.tolerance = 0.001});
  const std::string model =
      recommendation.candidates[recommendation.choice.value()].point.approximation.model;
  EXPECT_EQ(model, "mindlin");
  const Candidate& exact = recommendation.candidates[recommendation.exact];
  EXPECT_EQ(Describe(exact.point.approximation), "mindlin by exact");
  EXPECT_TRUE(exact.meets);
  EXPECT_EQ(exact.settles_after, 0U);
  for (std::size_t i = 0; i < recommendation.exact; ++i) {
    EXPECT_FALSE(recommendation.candidates[i].meets)
        << recommendation.candidates[i].point.approximation.model;
  }
}

TEST(Recommend, TheChoiceIsTheSimplestOfTheCheapestThatMeet) {
  constexpr double kSameCost = 1.1;
  for (const auto& [lambda, tolerance] : {std::pair{0.05, 0.1}, std::pair{1.3, 1e-3}}) {
    const Recommendation recommendation = RecommendFor(Sine(lambda, 2), {.tolerance = tolerance});
    const std::size_t choice = recommendation.choice.value();
    const auto& candidates = recommendation.candidates;
    EXPECT_TRUE(candidates[choice].meets);
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      EXPECT_EQ(candidates[i].meets, candidates[i].point.precision.max_force <= tolerance);
      if (!candidates[i].meets) continue;
      EXPECT_LE(candidates[choice].point.cost, kSameCost * candidates[i].point.cost);
      if (i < choice) {
        EXPECT_LT(candidates[choice].point.cost, candidates[i].point.cost);
      }
    }
  }
}

TEST(Recommend, SimplifiedDahlSettlesFivefoldACycle) {
  // Largest errors by cycle at λ = 0.8, in % of T*: 11.4, 3.57, 0.719, 0.144, 0.029 (60-digit
  // integration of Peyret et al. eqs 26 and 27).
  const std::vector<double> drive = Sine(0.8, 6);
  for (const auto& [tolerance, settles] :
       {std::pair{0.12, 0U}, std::pair{0.01, 2U}, std::pair{0.001, 4U}}) {
    const Recommendation recommendation = RecommendFor(drive, {.tolerance = tolerance});
    EXPECT_EQ(Find(recommendation, "simplified-dahl").settles_after, settles) << tolerance;
  }
  // Of two cycles none is left to be settled in.
  EXPECT_EQ(Find(RecommendFor(Sine(0.8, 2), {.tolerance = 0.01}), "simplified-dahl").settles_after,
            std::nullopt);
}

TEST(Recommend, TransientCyclesDoNotCount) {
  const std::vector<double> drive = Sine(0.8, 6);
  const Recommendation all = RecommendFor(drive, {.tolerance = 0.01});
  EXPECT_FALSE(Find(all, "simplified-dahl").meets);
  ASSERT_TRUE(all.after_transient);
  EXPECT_EQ(all.candidates[*all.after_transient].point.approximation.model, "simplified-dahl");

  const Recommendation later = RecommendFor(drive, {.tolerance = 0.01, .transient_cycles = 2});
  EXPECT_TRUE(Find(later, "simplified-dahl").meets);
  EXPECT_FALSE(Find(later, "dahl").meets);
}

TEST(Recommend, LaterAlternativeIsSimplerThanTheChoice) {
  for (const double lambda : {1e-3, 0.8}) {
    const Recommendation recommendation = RecommendFor(Sine(lambda, 6), {.tolerance = 0.01});
    if (!recommendation.after_transient) continue;
    EXPECT_LT(*recommendation.after_transient, recommendation.choice.value()) << lambda;
    EXPECT_FALSE(recommendation.candidates[*recommendation.after_transient].meets);
  }
}

TEST(Recommend, TheCriterionDecides) {
  // At λ = 100 the rectangle of Coulomb's misses 0.8 % of the energy, and the whole force after
  // reversals.
  const std::vector<double> drive = Sine(100, 2, 4'000);
  EXPECT_EQ(Choice(RecommendFor(drive, {.tolerance = 0.01, .criterion = Criterion::kEnergy})),
            "coulomb");
  EXPECT_FALSE(Find(RecommendFor(drive, {.tolerance = 0.01}), "coulomb").meets);
}

TEST(Recommend, TheOtherWayRoundTheMostPreciseWithinACost) {
  const std::vector<double> drive = Sine(1.2, 2);
  // Where the machine's own costs lie, so that some are within and some are not.
  const Recommendation by_tolerance = RecommendFor(drive, {});
  std::vector<double> costs;
  for (const Candidate& candidate : by_tolerance.candidates) costs.push_back(candidate.point.cost);
  std::ranges::sort(costs);
  for (const double limit : {costs[costs.size() / 2], 1e12}) {
    const Recommendation recommendation = RecommendFor(drive, {.largest_cost = limit});
    if (!recommendation.choice) continue;  // the machine has become slower
    const WorkPrecision& choice = recommendation.candidates[*recommendation.choice].point;
    EXPECT_LE(choice.cost, limit);
    for (const Candidate& candidate : recommendation.candidates) {
      EXPECT_EQ(candidate.meets, candidate.point.cost <= limit);
      if (candidate.meets) {
        EXPECT_GE(candidate.point.precision.max_force, choice.precision.max_force);
      }
    }
    EXPECT_FALSE(recommendation.after_transient);
  }
  EXPECT_FALSE(RecommendFor(drive, {.largest_cost = 1e-9}).choice);
}

TEST(Recommend, AChoiceHoldsOnExcitationsItHasNotSeen) {
  // Other extremes and another sampling of the same kind: the error is another sample of what it
  // was found from, which a factor of two covers.
  constexpr double kUnseen = 2.0;
  const auto excite = [](double lambda, std::uint64_t seed, std::size_t samples_per_cycle) {
    return Displacements({.waveform = Waveform::kRandom,
                          .amplitude = lambda * GrossSlipDisplacement(kMindlin),
                          .cycles = 4,
                          .samples_per_cycle = samples_per_cycle,
                          .seed = seed});
  };
  for (const auto& [lambda, tolerance] :
       {std::pair{1e-3, 0.01}, std::pair{0.3, 0.05}, std::pair{1.3, 0.001}, std::pair{1e7, 0.05}}) {
    const Recommendation recommendation =
        RecommendFor(excite(lambda, 1, 90), {.tolerance = tolerance});
    const Approximation& choice =
        recommendation.candidates[recommendation.choice.value()].point.approximation;
    for (const std::uint64_t seed : {2U, 3U}) {
      const std::vector<double> unseen = excite(lambda, seed, 70 + 20 * seed);
      std::vector<double> force(unseen.size());
      Prepare(choice, kMindlin)({.displacement = unseen}, force);
      const auto exact = DefinedForce<Extended>(kMindlin, unseen);
      EXPECT_LE(LargestDifference(force, exact) / Largest(exact), kUnseen * tolerance)
          << Describe(choice) << " at lambda = " << lambda << ", seed " << seed;
    }
  }
}

TEST(Recommend, RefusesOptionsOutOfRange) {
  const std::vector<double> drive = Sine(0.8, 2, 20);
  for (const double tolerance : {0.0, 1.5, 1e308}) {
    EXPECT_THROW(RecommendFor(drive, {.tolerance = tolerance}), InvalidArgument) << tolerance;
  }
  EXPECT_THROW(RecommendFor(drive, {.largest_cost = -1}), InvalidArgument);
  EXPECT_THROW(RecommendFor(drive, {.transient_cycles = 3}), InvalidArgument);
  EXPECT_THROW(RecommendFor({}, {}), InvalidArgument);
}

TEST(Recommend, OfEquallyPreciseOnesWithinTheCostTheCheapestIsChosen) {
  // A contact that stays where it is loses no energy, and the error of its energy is unknown.
  const Recommendation rest =
      RecommendFor({0, 0, 0, 0}, {.criterion = Criterion::kEnergy, .largest_cost = 1e9});
  ASSERT_TRUE(rest.choice);
  for (const Candidate& candidate : rest.candidates) {
    EXPECT_GE(candidate.point.cost, rest.candidates[*rest.choice].point.cost);
  }
}

}  // namespace
}  // namespace mindahl::tradeoff::recommendation_test
