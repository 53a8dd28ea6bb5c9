

#include "../methods/responses.h"
#include "mindahl/tradeoff/approximation.h"
#include "mindahl/tradeoff/recommendation.h"
#include "support/prelude.h"

namespace mindahl::tradeoff::cost_model_test {
namespace {

using methods::Operation;
using methods::OperationCount;
using models::BranchLaw;

constexpr BranchLaw kMindlin{4.8e8, 1.0 / 3, 30};

TEST(CostModel, SumsThePricesOfCountedOperations) {
  OperationCount count;
  count.Add(Operation::kSample, 10);
  count.Add(Operation::kElement, 160);
  constexpr double kRounding = 1e-12;
  EXPECT_NEAR(ModelledCost(count, 10),
              PriceOf(Operation::kSample) + 16 * PriceOf(Operation::kElement), kRounding);
}

TEST(CostModel, ALimitLawCostsItsSamplesOnly) {
  const std::vector<double> displacement = {1e-9, 2e-9};
  const OperationCount count =
      CountOperations({"spring", ""}, kMindlin, {.displacement = displacement});
  EXPECT_EQ(count[Operation::kSample], 2);
  EXPECT_EQ(ModelledCost(count, 2), PriceOf(Operation::kSample));
}

TEST(CostModel, HasAPriceForWhatTakesLonger) {
  EXPECT_GT(PriceOf(Operation::kPower), PriceOf(Operation::kRoot));
  EXPECT_GT(PriceOf(Operation::kReversal), PriceOf(Operation::kPlace));
  EXPECT_GT(PriceOf(Operation::kCubicRoot), PriceOf(Operation::kStage));
}

TEST(CostModel, GivesOneAnswerInEveryRun) {
  const std::vector<double> displacement =
      testing::Displacements({.amplitude = 0.8 * GrossSlipDisplacement(kMindlin), .cycles = 3});
  for (const double tolerance : {0.2, 0.01, 1e-6}) {
    const auto run = [&] {
      return Recommend(kMindlin, {.displacement = displacement}, {.tolerance = tolerance});
    };
    const Recommendation first = run();
    const Recommendation second = run();
    EXPECT_EQ(first.choice, second.choice);
    ASSERT_EQ(first.candidates.size(), second.candidates.size());
    for (std::size_t i = 0; i < first.candidates.size(); ++i) {
      EXPECT_EQ(first.candidates[i].point.cost, second.candidates[i].point.cost);
      EXPECT_FALSE(first.candidates[i].point.measured_cost);
    }
  }
}

}  // namespace
}  // namespace mindahl::tradeoff::cost_model_test
