

#include "mindahl/campaign/test_summary.h"
#include "support/prelude.h"

namespace mindahl::campaign::repeats_test {
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

TEST(Repeats, ThatAgreeScatterAsTheirErrorsState) {
  EXPECT_NEAR(*DescribeRepeats(Numbers{3, 3, 3}, Numbers{1, 2, 3})->p_value, 1.0, kRounding);
}

TEST(Repeats, WithoutStatedErrorsHaveTheirScatterOnly) {
  const auto repeats = DescribeRepeats(Numbers{10, 12}, {});
  ASSERT_TRUE(repeats);
  EXPECT_NEAR(repeats->standard_deviation, std::sqrt(2.0), kRounding);
  EXPECT_FALSE(repeats->stated_error);
  EXPECT_FALSE(repeats->p_value);
  EXPECT_FALSE(repeats->exceed_errors());
  EXPECT_EQ(repeats->InWords(), "without stated errors");
}

TEST(Repeats, ThatExceedTheirErrorsByFarHaveNoChanceOfZero) {
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

}  // namespace
}  // namespace mindahl::campaign::repeats_test
