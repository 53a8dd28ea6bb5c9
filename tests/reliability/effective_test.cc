#include "other_laws.h"
#include "support/prelude.h"

// Loops of other laws than the fitted one: what is effective contains what is true of them.
namespace mindahl::reliability::effective_test {
namespace {

constexpr std::size_t kLoops = 12;
constexpr std::uint64_t kSeed = 1;

TEST(Effective, SlipForceContainsThePlateauAndStiffnessThatAfterAReversal) {
  Effective slip_force;
  Effective stiffness;
  for (const OtherLaw& law : OtherLaws()) {
    SCOPED_TRACE(law.name);
    const EffectiveTally tally = Measure(law, kLoops, kSeed);
    EXPECT_LE(tally.slip_force.narrow, 1U);
    slip_force.loops += tally.slip_force.loops;
    for (const auto& [sum, of_law] :
         {std::pair{&slip_force, &tally.slip_force}, {&stiffness, &tally.stiffness}}) {
      sum->given += of_law->given;
      sum->held += of_law->held;
    }
  }
  // All laws slide, most of the way from one plateau to the other; of 60 fits
  // that are not adequate B(60, 0.95) is below 51 with a probability of 0.1 %.
  EXPECT_GE(slip_force.loops, 5 * kLoops);
  EXPECT_GE(20 * slip_force.given, 17 * slip_force.loops);
  EXPECT_GE(20 * slip_force.held, 17 * slip_force.given);
  EXPECT_GE(stiffness.given, 2 * kLoops)
      << "some laws have a knee that Masing's with one exponent follows";
  EXPECT_GE(20 * stiffness.held, 17 * stiffness.given);
}

TEST(Effective, EveryLawHasAPlateauAndMostAStiffness) {
  std::size_t stiff = 0;
  for (const OtherLaw& law : OtherLaws()) {
    Draws draws(kSeed);
    const OtherLoop loop = law.make(draws);
    EXPECT_GT(loop.plateau, 0.0) << law.name;
    if (!loop.stiffness) continue;
    ++stiff;
    EXPECT_GT(loop.stiffness->lowest, 0.0) << law.name;
    EXPECT_LE(loop.stiffness->lowest, loop.stiffness->highest) << law.name;
  }
  EXPECT_EQ(stiff, OtherLaws().size() - 2) << "all but those of which the force stands or jumps";
}

}  // namespace
}  // namespace mindahl::reliability::effective_test
