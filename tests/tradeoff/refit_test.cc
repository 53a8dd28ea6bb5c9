

#include "../methods/responses.h"
#include "mindahl/models/steady_loop.h"
#include "mindahl/tradeoff/recommendation.h"
#include "support/prelude.h"

namespace mindahl::tradeoff::refit_test {
namespace {

using namespace models;

constexpr BranchLaw kMindlin{
    .tangential_stiffness = 4.8e8, .shape_exponent = 1.0 / 3, .slip_force = 30};
constexpr std::size_t kPerCycle = 200;

std::vector<double> Sine(double lambda, double cycles) {
  return Displacements({.amplitude = lambda * GrossSlipDisplacement(kMindlin),
                        .cycles = cycles,
                        .samples_per_cycle = kPerCycle});
}

std::vector<Approximation> RefitAlong(const std::vector<double>& displacement,
                                      std::size_t first = 0, const BranchLaw& law = kMindlin) {
  const methods::Drive drive{.displacement = displacement};
  return RefittedLadder(law, drive, MakeReferenceResponse(law, drive), first);
}

const Approximation& Find(const std::vector<Approximation>& ladder, std::string_view model,
                          double shape_exponent = 1.0 / 3) {
  const auto found = std::ranges::find_if(ladder, [&](const Approximation& rung) {
    return rung.model == model && LawOf(rung, kMindlin).shape_exponent == shape_exponent;
  });
  EXPECT_NE(found, ladder.end()) << model;
  return *found;
}

/// Σ (T_model − T)² [N²] from `first` on.
double SumOfSquares(const Approximation& rung, const std::vector<double>& displacement,
                    std::size_t first) {
  const methods::Drive drive{.displacement = displacement};
  const ReferenceResponse reference = MakeReferenceResponse(kMindlin, drive);
  std::vector<double> force(displacement.size());
  Prepare(rung, kMindlin)(drive, force);
  double squares = 0.0;
  for (std::size_t i = first; i < force.size(); ++i) {
    squares += (force[i] - reference.force[i]) * (force[i] - reference.force[i]);
  }
  return squares;
}

TEST(Refit, DahlsLawFollowsASteadyLoopExactly) {
  // A perturbation of its start falls to ((1 − t)/(1 + t))^{2α} of itself a cycle, t = T*/Tc' of
  // the equivalent law: 0.83 at λ = 0.8, which is a fifth; 1e-17 after 24 cycles. In gross slip
  // nothing of it is left after one. What remains is rounding, of the 28 cycles' reversals and of
  // the fit.
  constexpr double kRounding = 1e-12;  // of T*
  constexpr std::size_t kSettled = 24 * kPerCycle;
  for (const double lambda : {0.8, 1.2}) {
    const std::vector<double> displacement = Sine(lambda, 28);
    const auto refitted = RefitAlong(displacement, kSettled);
    const Approximation& dahl = Find(refitted, "dahl");
    const methods::Drive drive{.displacement = displacement};
    std::vector<double> force(displacement.size());
    Prepare(dahl, kMindlin)(drive, force);
    const Precision precision =
        Compare(MakeReferenceResponse(kMindlin, drive), drive, force, kSettled);
    EXPECT_LE(precision.max_force, kRounding) << lambda;
    // σ′ = σ(1 − T*/2Tc)^α, Tc′ = 2Tc − T*: docs/theory.md §6.
    constexpr double kFound = 1e-10;
    const BranchLaw expected = DahlEquivalent(kMindlin, lambda * GrossSlipDisplacement(kMindlin));
    EXPECT_NEAR(dahl.law->tangential_stiffness / expected.tangential_stiffness, 1, kFound);
    EXPECT_NEAR(dahl.law->slip_force / expected.slip_force, 1, kFound);
  }
}

TEST(Refit, NoNeighbourSuitsTheDriveBetter) {
  constexpr double kAside = 1e-4;      // of σ and Tc
  constexpr double kRounding = 1e-12;  // of a sum of squares: n ε
  // Of n residuals of 4 ε·Tc, where a model follows the contact to rounding.
  constexpr double kNothing = 601 * 16 * 30 * 30 * 2.2e-16 * 2.2e-16;  // [N²]
  for (const double lambda : {0.3, 0.8, 1.5}) {
    const std::vector<double> displacement = Sine(lambda, 3);
    for (const std::size_t first : {std::size_t{0}, kPerCycle}) {
      for (const Approximation& rung : RefitAlong(displacement, first)) {
        const double least = SumOfSquares(rung, displacement, first);
        for (const double by_stiffness : {-kAside, 0.0, kAside}) {
          for (const double by_slip : {-kAside, 0.0, kAside}) {
            Approximation neighbour = rung;
            neighbour.law->tangential_stiffness *= 1 + by_stiffness;
            neighbour.law->slip_force *= 1 + by_slip;
            EXPECT_LE(least,
                      SumOfSquares(neighbour, displacement, first) * (1 + kRounding) + kNothing)
                << Describe(rung) << " at lambda = " << lambda << ", from sample " << first;
          }
        }
        Approximation as_the_contact = rung;
        as_the_contact.law->tangential_stiffness = kMindlin.tangential_stiffness;
        as_the_contact.law->slip_force = kMindlin.slip_force;
        EXPECT_LE(least,
                  SumOfSquares(as_the_contact, displacement, first) * (1 + kRounding) + kNothing)
            << Describe(rung);
      }
    }
  }
}

TEST(Refit, ASpringAndCoulombHaveTheirRegressions) {
  // T = σδ against itself, and ±T₀ against itself.
  const std::vector<double> displacement = {1, 2, -1, -2, 1};
  const methods::Drive drive{.displacement = displacement};
  const ReferenceResponse reference{.force = {3, 6, -3, -6, 3}, .peak_force = 6};
  const auto ladder = RefittedLadder({1, 1.0 / 3, 1}, drive, reference);
  EXPECT_DOUBLE_EQ(Find(ladder, "spring").law->tangential_stiffness, 3);
  // Coulomb's is + + − − +: the mean of 3, 6, 3, 6, 3.
  EXPECT_DOUBLE_EQ(Find(ladder, "coulomb").law->slip_force, 4.2);
}

TEST(Refit, TriesDahlsLawWithExponentOneToo) {
  const auto ladder = RefitAlong(Sine(0.8, 2));
  std::vector<std::string> names;
  for (const Approximation& rung : ladder) names.push_back(Describe(rung));
  EXPECT_THAT(names, ::testing::ElementsAre("spring, refitted", "coulomb, refitted",
                                            "jenkins by exact, refitted",
                                            "simplified-dahl by exact, refitted at alpha 0.333",
                                            "dahl by exact, refitted at alpha 0.333",
                                            "dahl by exact, refitted at alpha 1"));
  EXPECT_EQ(Find(ladder, "dahl", 1.0).law->shape_exponent, 1.0);
  // The contact's own law is not refitted to itself.
  for (const Approximation& rung : RefitAlong({0.1, -0.1, 0.2}, 0, {1, 1, 1})) {
    EXPECT_NE(rung.model, "mindlin-dahl");
  }
}

TEST(Refit, OfAContactThatNothingMovesThereIsNone) {
  EXPECT_TRUE(RefitAlong({0.0, 0.0, 0.0}).empty());
}

TEST(Refit, RefusesInvalidDrive) {
  EXPECT_THROW(RefitAlong({0.0, 1e-8}, 2), InvalidArgument);
  const std::vector<double> displacement = {1, 2};
  EXPECT_THROW(RefittedLadder(kMindlin, {.displacement = displacement}, {.force = {1}}),
               InvalidArgument);
}

TEST(Refit, StandsAfterTheModelAtTheContactsOwnParameters) {
  const std::vector<double> displacement = Sine(0.8, 2);
  const methods::Drive drive{.displacement = displacement};
  const auto all = AllApproximationsAlong(kMindlin, drive, MakeReferenceResponse(kMindlin, drive));
  EXPECT_EQ(all.size(), AllApproximations(kMindlin).size() + 6);
  for (std::size_t i = 1; i < all.size(); ++i) {
    if (all[i].law) {
      EXPECT_EQ(all[i].model, all[i - 1].model);
    }
  }
}

}  // namespace
}  // namespace mindahl::tradeoff::refit_test
