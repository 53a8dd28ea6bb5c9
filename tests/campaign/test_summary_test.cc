#include "mindahl/campaign/test_summary.h"

#include "support/prelude.h"

// Tests the summary of a whole test: its repeats and the energy that it dissipated.
namespace mindahl::campaign::test_summary_test {
namespace {

using Numbers = std::vector<double>;

constexpr double kRounding = 1e-14;

TEST(Repeats, OfTwoAreDescribedByHand) {
  // Mean 11, deviations ±1: s² = 2; weights 1 and 1/4: x̄ = 10.4, χ² = 0.16 + 0.64 of one degree.
  const auto repeats = DescribeRepeats(Numbers{10, 12}, Numbers{1, 2});
  ASSERT_TRUE(repeats);
  EXPECT_EQ(repeats->count, 2U);
  EXPECT_NEAR(repeats->mean, 11, kRounding);
  EXPECT_NEAR(repeats->standard_deviation, std::sqrt(2.0), kRounding);
  EXPECT_NEAR(*repeats->stated_error, std::sqrt(2.5), kRounding);
  EXPECT_NEAR(*repeats->p_value, std::erfc(std::sqrt(0.8 / 2)), kRounding);
}

TEST(Repeats, AreComparedInWordsWithTheErrorsThatAreStated) {
  const auto repeats = DescribeRepeats(Numbers{10, 12}, {});
  ASSERT_TRUE(repeats);
  EXPECT_NEAR(repeats->standard_deviation, std::sqrt(2.0), kRounding);
  EXPECT_FALSE(repeats->stated_error || repeats->p_value || repeats->exceed_errors());
  EXPECT_EQ(repeats->InWords(), "without stated errors");
  EXPECT_EQ(DescribeRepeats(Numbers{10, 12}, Numbers{1e-3, 1e-3})->InWords(),
            "more than the errors, p < 1e-12");
}

TEST(Repeats, AverageOutWhatScattersAndNotWhatTheyHaveInCommon) {
  // Deviation 1 of three, more than is stated: 1/√3, and 2 that all have.
  const auto repeats =
      DescribeRepeats(Numbers{9, 10, 11}, Numbers{0.5, 0.5, 0.5}, Numbers{2, 2, 2});
  ASSERT_TRUE(repeats);
  EXPECT_NEAR(*repeats->common_error, 2, kRounding);
  EXPECT_NEAR(repeats->mean_error(), std::sqrt(1.0 / 3 + 4), kRounding);
  // Values that agree by chance leave the error of the mean at that of their stated errors.
  EXPECT_NEAR(DescribeRepeats(Numbers{10, 10}, Numbers{0.6, 0.8})->mean_error(), 0.5, kRounding);
  EXPECT_THROW(DescribeRepeats(Numbers{1, 2}, Numbers{1, 1}, Numbers{1}), InvalidArgument);
}

TEST(Repeats, AreTwoAtLeast) {
  EXPECT_FALSE(DescribeRepeats({}, {}));
  EXPECT_FALSE(DescribeRepeats(Numbers{1}, Numbers{1}));
  EXPECT_THROW(DescribeRepeats(Numbers{1, 2}, Numbers{1}), InvalidArgument);
}

constexpr double kEnergy = 2e-5;  // J

CycleFit Loop(std::optional<double> energy, std::size_t samples = 201,
              std::vector<std::string> flags = {}) {
  CycleFit fit;
  fit.energy = energy;
  fit.samples = samples;
  fit.flags = std::move(flags);
  return fit;
}

DissipatedEnergy After(std::size_t loops, std::size_t cycles = 1) {
  DissipatedEnergy energy(cycles);
  for (std::size_t k = 0; k < loops; ++k) energy.Add(Loop(kEnergy));
  return energy;
}

TEST(DissipatedEnergy, IsTheSumOfMeasuredCyclesGlitchesAmongThem) {
  EXPECT_DOUBLE_EQ(After(5, 12).total(), 60 * kEnergy);
  DissipatedEnergy energy = After(3);
  energy.Add(Loop(0.95 * kEnergy, 201, {"glitches"}));
  EXPECT_DOUBLE_EQ(energy.total(), 3.95 * kEnergy);
  EXPECT_EQ(energy.counts().measured, 4U);
}

TEST(DissipatedEnergy, CountsThePiecesOfACycleForOne) {
  DissipatedEnergy energy = After(4);
  energy.Add(Loop(std::nullopt, 71, {"not_closed", "no_loop"}));
  energy.Add(Loop(11 * kEnergy, 131, {"not_closed"}));
  EXPECT_DOUBLE_EQ(energy.total(), 5 * kEnergy);
  EXPECT_EQ(energy.counts().replaced, 2U);
  EXPECT_EQ(energy.counts().left_out, 0U);
}

TEST(DissipatedEnergy, ReplacesAsManyCyclesAsARowStandsFor) {
  constexpr std::size_t kCyclesPerRow = 5;
  DissipatedEnergy energy = After(3, kCyclesPerRow);
  // Half the steps of a closed one: half of its energy, five times.
  energy.Add(Loop(11 * kEnergy, 101, {"not_closed"}));
  EXPECT_DOUBLE_EQ(energy.total(), kCyclesPerRow * 3.5 * kEnergy);
}

TEST(DissipatedEnergy, ReplacesByTheMedianOfTheLastNine) {
  DissipatedEnergy energy(1);
  for (int k = 1; k <= 20; ++k) energy.Add(Loop(k * kEnergy));
  const double before = energy.total();
  energy.Add(Loop(500 * kEnergy, 201, {"not_closed"}));
  EXPECT_DOUBLE_EQ(energy.total() - before, 16 * kEnergy);
}

TEST(DissipatedEnergy, LeavesOutUnknownCycles) {
  DissipatedEnergy energy(1);
  energy.Add(Loop(11 * kEnergy, 131, {"not_closed"}));
  energy.Add(Loop(std::nullopt, 201, {"no_loop"}));
  energy.Add(Loop(std::nullopt, 0, {"not_converged"}));
  EXPECT_EQ(energy.total(), 0.0);
  EXPECT_EQ(energy.counts().left_out, 3U);
}

}  // namespace
}  // namespace mindahl::campaign::test_summary_test
