#include "mindahl/campaign/evolution.h"
#include "support/prelude.h"

// Tests the energy that a whole test dissipated.
namespace mindahl::campaign::dissipated_energy_test {
namespace {

constexpr double kEnergy = 2e-5;  // J

CycleFit Loop(std::size_t number, std::optional<double> energy, std::size_t samples = 201,
              std::vector<std::string> flags = {}) {
  CycleFit fit;
  fit.number = number;
  fit["energy"] = energy;
  fit.samples = samples;
  fit.flags = std::move(flags);
  return fit;
}

DissipatedEnergy After(std::size_t loops, std::size_t together = 1) {
  DissipatedEnergy energy{.together = together};
  for (std::size_t k = 0; k < loops; ++k) energy.Add(Loop(1 + k * together, kEnergy));
  return energy;
}

TEST(DissipatedEnergy, IsTheSumOfMeasuredCyclesGlitchesAmongThem) {
  EXPECT_DOUBLE_EQ(After(5, 12).total, 60 * kEnergy);
  DissipatedEnergy energy = After(3);
  energy.Add(Loop(4, 0.95 * kEnergy, 201, {"glitches"}));
  EXPECT_DOUBLE_EQ(energy.total, 3.95 * kEnergy);
}

TEST(DissipatedEnergy, CountsThePiecesOfACycleForOne) {
  DissipatedEnergy energy = After(4);
  energy.Add(Loop(5, std::nullopt, 71, {"not_closed", "no_loop"}));
  energy.Add(Loop(6, 11 * kEnergy, 131, {"not_closed"}));
  EXPECT_DOUBLE_EQ(energy.total, 5 * kEnergy);
}

TEST(DissipatedEnergy, ReplacesAsManyCyclesAsARowStandsFor) {
  constexpr std::size_t kCyclesPerRow = 5;
  DissipatedEnergy energy = After(3, kCyclesPerRow);
  // Half the steps of a closed one: half of its energy, five times.
  energy.Add(Loop(16, 11 * kEnergy, 101, {"not_closed"}));
  EXPECT_DOUBLE_EQ(energy.total, kCyclesPerRow * 3.5 * kEnergy);
}

// Every 250th of 299 cycles, of one energy in the first and of twice that in the others.
TEST(DissipatedEnergy, IsThatOfTheCyclesThatExist) {
  DissipatedEnergy energy;
  energy.Add(Loop(1, kEnergy));
  EXPECT_DOUBLE_EQ(energy.total, kEnergy);
  energy.Add(Loop(251, 2 * kEnergy));
  EXPECT_DOUBLE_EQ(energy.total, 501 * kEnergy);
  energy.Finish(299);
  EXPECT_DOUBLE_EQ(energy.total, 597 * kEnergy);
}

TEST(DissipatedEnergy, ReplacesByTheMedianOfTheLastNine) {
  DissipatedEnergy energy;
  for (std::size_t k = 1; k <= 20; ++k) energy.Add(Loop(k, static_cast<double>(k) * kEnergy));
  const double before = energy.total;
  energy.Add(Loop(21, 500 * kEnergy, 201, {"not_closed"}));
  EXPECT_DOUBLE_EQ(energy.total - before, 16 * kEnergy);
}

TEST(DissipatedEnergy, LeavesOutUnknownCycles) {
  DissipatedEnergy energy;
  energy.Add(Loop(1, 11 * kEnergy, 131, {"not_closed"}));
  energy.Add(Loop(2, std::nullopt, 201, {"no_loop"}));
  energy.Add(Loop(3, std::nullopt, 0, {"not_converged"}));
  EXPECT_EQ(energy.total, 0.0);
}

}  // namespace
}  // namespace mindahl::campaign::dissipated_energy_test
