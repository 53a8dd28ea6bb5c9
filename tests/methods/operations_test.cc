

#include "../support/histories.h"
#include "mindahl/methods/method.h"
#include "support/prelude.h"

namespace mindahl::methods::operations_test {
namespace {

using models::BranchLaw;

constexpr BranchLaw kMindlin{1.0, 1.0 / 3, 1.0};

/// Up, down and up again, never slipping: three branches, the samples 1 … 10 on them.
const std::vector<double> kDisplacement = {0.1, 0.2, 0.3, 0.4, 0.3, 0.2, 0.1, 0.15, 0.2, 0.25};

OperationCount Count(std::string_view method, const BranchLaw& law, std::size_t steps = 1,
                     std::string_view model = "mindlin-dahl") {
  return CountOperations(*FindMethod(method), Model(model), law, {.steps = steps},
                         {.displacement = kDisplacement});
}

TEST(Operations, OfTheClosedFormAreABranchLawASampleAndABranch) {
  const OperationCount mindlin = Count("exact", kMindlin);
  EXPECT_EQ(mindlin[Operation::kSample], 10);
  EXPECT_EQ(mindlin[Operation::kPlace], 10);
  EXPECT_EQ(mindlin[Operation::kReversal], 3);
  EXPECT_EQ(mindlin[Operation::kRoot], 13);
  EXPECT_EQ(mindlin[Operation::kPower], 0);
  EXPECT_EQ(Count("exact", {1, 0.0, 1})[Operation::kLinear], 13);
  EXPECT_EQ(Count("exact", {1, 0.6, 1})[Operation::kPower], 13);
  EXPECT_EQ(Count("table", kMindlin, 64)[Operation::kLookUp], 13);
  EXPECT_EQ(Count("table", kMindlin, 64)[Operation::kRoot], 0);
  // Of Dahl's own law each branch starts with another stiffness.
  EXPECT_EQ(Count("exact", kMindlin, 1, "dahl")[Operation::kRatePower], 3);
}

TEST(Operations, OfIwansElementsAreThoseOfWholeVectors) {
  EXPECT_EQ(Count("iwan", kMindlin, 16)[Operation::kElement], 160);
  EXPECT_EQ(Count("iwan-optimal", kMindlin, 5)[Operation::kElement], 80);
  EXPECT_EQ(Count("iwan", {1, 0.0, 1}, 16)[Operation::kElement], 40);  // one is Jenkins' own
  EXPECT_EQ(Count("iwan", kMindlin, 16)[Operation::kSum], 10);
  EXPECT_EQ(Count("iwan", kMindlin, 16)[Operation::kPlace], 0);
}

TEST(Operations, OfSteppingAreItsStepsAndStages) {
  // The first of each branch's rates is that of u = 1, which takes no root.
  const OperationCount euler = Count("euler", kMindlin, 2);
  EXPECT_EQ(euler[Operation::kStep], 20);
  EXPECT_EQ(euler[Operation::kStage], 20);
  EXPECT_EQ(euler[Operation::kCubicRoot], 17);
  const OperationCount rk4 = Count("rk4", kMindlin, 2);
  EXPECT_EQ(rk4[Operation::kStage], 80);
  EXPECT_EQ(rk4[Operation::kCubicRoot], 77);
  EXPECT_EQ(Count("rk4", {1, 0.6, 1}, 2)[Operation::kRatePower], 77);
  const OperationCount linear = Count("rk4", {1, 1.0, 1}, 2);
  EXPECT_EQ(linear[Operation::kStage], 80);
  EXPECT_EQ(linear[Operation::kRatePower] + linear[Operation::kCubicRoot], 0);
  EXPECT_EQ(Count("exponential", kMindlin)[Operation::kExponential], 10);
}

TEST(Operations, OfWhatSlipsEndWithIt) {
  // Gross slip is at 1.5: the third sample is beyond, and a step there has nothing to do.
  const std::vector<double> far = {1.0, 2.0, 3.0};
  const OperationCount count = CountOperations(*FindMethod("euler"), Model("mindlin-dahl"),
                                               kMindlin, {.steps = 4}, {.displacement = far});
  EXPECT_LE(count[Operation::kStep], 8);
  EXPECT_GE(count[Operation::kStep], 5);
}

TEST(Operations, OfAdaptiveAndImplicitStepsAreAsManyAsTheErrorAsksFor) {
  const auto trials = [](double tolerance) {
    return CountOperations(*FindMethod("dopri5"), Model("mindlin-dahl"), kMindlin,
                           {.tolerance = tolerance},
                           {.displacement = kDisplacement})[Operation::kTrial];
  };
  EXPECT_GE(trials(1e-3), 10);
  EXPECT_GT(trials(1e-13), trials(1e-3));
  const OperationCount implicit = Count("backward-euler", kMindlin);
  EXPECT_EQ(implicit[Operation::kStep], 10);
  EXPECT_GE(implicit[Operation::kIteration], 10);
}

TEST(Operations, AreTheSameEveryTime) {
  for (const Method& method : Methods()) {
    const OperationCount first = Count(method.name, kMindlin, 8);
    const OperationCount second = Count(method.name, kMindlin, 8);
    for (std::size_t i = 0; i < kOperations; ++i) {
      const auto operation = static_cast<Operation>(i);
      EXPECT_EQ(first[operation], second[operation]) << method.name << " " << NameOf(operation);
    }
  }
}

TEST(Operations, OfAMethodThatDoesNotServeTheModelAreRefused) {
  EXPECT_THROW(Count("iwan", kMindlin, 4, "dahl"), InvalidArgument);
  EXPECT_THROW(Count("euler", kMindlin, 0), InvalidArgument);
}

}  // namespace
}  // namespace mindahl::methods::operations_test
