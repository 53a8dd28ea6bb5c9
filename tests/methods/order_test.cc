// How the error of each method falls with its steps, before gross slip and next to it.

#include "responses.h"
#include "support/prelude.h"

namespace mindahl::methods::order_test {
namespace {

using namespace models;

/// A tolerance that rejects no step, so that dopri5's number of steps is the one asked for.
constexpr double kNoControl = 1e9;

double ErrorAlong(std::string_view method, const BranchLaw& law, const std::vector<double>& drive,
                  std::size_t steps) {
  const Drive imposed{.displacement = drive};
  return LargestDifference(
      RespondBy(method, "mindlin-dahl", law, imposed, {.steps = steps, .tolerance = kNoControl}),
      RespondBy("exact", "mindlin-dahl", law, imposed));
}

struct OrderCase {
  std::string_view method;
  double shape_exponent;
};

class SteppingMethod : public ::testing::TestWithParam<OrderCase> {};

TEST_P(SteppingMethod, HasItsOrderBeforeGrossSlip) {
  constexpr double kLambda = 0.8;
  constexpr double kRoundings = 5e-13;  // thousands of them: they must not be what is measured
  constexpr std::size_t kMostSteps = 128;
  const auto [method, shape_exponent] = GetParam();
  const double order = FindMethod(method)->order;
  const BranchLaw law{1, shape_exponent, 1};
  const std::vector<double> drive = Displacements(
      {.amplitude = kLambda * ReferenceDisplacement(law), .cycles = 2.25, .samples_per_cycle = 20});
  std::size_t steps = 1;
  double before = 0.0;
  double error = ErrorAlong(method, law, drive, steps);
  while (error > kRoundings && steps < kMostSteps) {
    steps *= 2;
    before = error;
    error = ErrorAlong(method, law, drive, steps);
  }
  const double observed = std::log2(before / error);
  // The error is C·hᵖ(1 + c·h + …), c the ratio of successive derivatives of u: at most p + 2 over
  // the length in which u changes by itself, u^{1−α}.
  double longest = 0.0;
  for (std::size_t i = 1; i < drive.size(); ++i) {
    longest = std::max(longest, std::abs(drive[i] - drive[i - 1]));
  }
  const double remaining = BackboneRemaining(law, kLambda * ReferenceDisplacement(law));
  const double share =
      longest / static_cast<double>(steps) * std::max(1.0, std::pow(remaining, shape_exponent - 1));
  const double tolerance = (order + 2) * share;
  ASSERT_LT(tolerance, 1) << "cannot tell one order from the next";
  EXPECT_NEAR(observed, order, tolerance) << "between " << steps / 2 << " and " << steps;
  RecordProperty("observed", std::to_string(observed));
}

INSTANTIATE_TEST_SUITE_P(
    Orders, SteppingMethod,
    ::testing::Values(OrderCase{"euler", 1.0 / 3}, OrderCase{"euler", 0.7}, OrderCase{"euler", 2.0},
                      OrderCase{"rk4", 1.0 / 3}, OrderCase{"rk4", 0.7}, OrderCase{"rk4", 2.0},
                      OrderCase{"dopri5", 1.0 / 3}, OrderCase{"dopri5", 0.7},
                      OrderCase{"backward-euler", 1.0 / 3}, OrderCase{"backward-euler", 0.7},
                      OrderCase{"backward-euler", 2.0}, OrderCase{"exponential", 1.0 / 3},
                      OrderCase{"exponential", 0.7}, OrderCase{"exponential", 2.0}),
    [](const auto& order_case) {
      std::string name = std::string(order_case.param.method) + "_" +
                         std::to_string(order_case.param.shape_exponent);
      for (char& letter : name) letter = std::isalnum(letter) != 0 ? letter : '_';
      return name;
    });

/// Largest error of a first loading in one sample, wherever near slip that ends.
double ErrorNextToSlip(std::string_view method, const BranchLaw& law, std::size_t steps) {
  constexpr int kEnds = 400;
  double worst = 0.0;
  for (int i = 0; i <= kEnds; ++i) {
    // Ends lie within a few steps of slip, so that every phase of the last step is met.
    const double end = 1 + (static_cast<double>(i) / kEnds - 0.5) * 6 / static_cast<double>(steps);
    worst = std::max(worst, ErrorAlong(method, law, {end * GrossSlipDisplacement(law)}, steps));
  }
  return worst;
}

TEST(Slip, TakesHigherOrdersDownToThatOfTheCorner) {
  // u ~ distance^{1/(1−α)}: 1.5 for Mindlin, 2 for α = 1/2. A step looks the same at every size
  // there but for the history of the steps before, an error of its own order: a tenth.
  constexpr double kTolerance = 0.1;
  for (const double alpha : {1.0 / 3, 0.5}) {
    const BranchLaw law{1, alpha, 1};
    const double order = 1 / (1 - alpha);
    for (const std::string_view method : {"rk4", "exponential"}) {
      const double coarse = ErrorNextToSlip(method, law, 64);
      const double fine = ErrorNextToSlip(method, law, 512);
      const double observed = std::log2(coarse / fine) / 3;
      if (method == "exponential" && alpha == 0.5) {
        EXPECT_GE(observed, order - 2 * kTolerance) << method;  // its own order, with a logarithm
      } else {
        EXPECT_NEAR(observed, order, kTolerance) << method << " " << alpha;
      }
      EXPECT_LT(observed, FindMethod(method)->order + kTolerance);
    }
  }
}

TEST(Slip, LeavesTheFullOrderToWhatFollows) {
  // Samples half an elastic limit from slip, none next to it.
  constexpr double kTolerance = 0.1;
  const BranchLaw law{1, 1.0 / 3, 1};
  const std::vector<double> drive = {0.5, 1, 2.5, 2, 1.5, 1, 0.5, -2.5, -1.5, -0.5, 2.5, 1.5};
  const double observed =
      std::log2(ErrorAlong("rk4", law, drive, 32) / ErrorAlong("rk4", law, drive, 64));
  EXPECT_NEAR(observed, 4, kTolerance);
}

TEST(Dopri5, ErrsLessTheSmallerItsTolerance) {
  // Local errors of a few hundred steps add up; that of the corner at slip is one of them.
  constexpr double kSteps = 300;
  for (const double lambda : {0.8, 1.2}) {
    for (const double alpha : {1.0 / 3, 0.7, 1.0}) {
      const BranchLaw law{1, alpha, 1};
      const std::vector<double> drive =
          Displacements({.amplitude = lambda * ReferenceDisplacement(law),
                         .cycles = 3.25,
                         .samples_per_cycle = 6});
      const Drive imposed{.displacement = drive};
      const auto exact = RespondBy("exact", "mindlin-dahl", law, imposed);
      double last = 1.0;
      for (const double tolerance : {1e-2, 1e-4, 1e-6, 1e-8, 1e-10}) {
        const double error = LargestDifference(
            RespondBy("dopri5", "mindlin-dahl", law, imposed, {.tolerance = tolerance}), exact);
        EXPECT_LE(error, kSteps * tolerance) << lambda << " " << alpha;
        EXPECT_LT(error, last) << lambda << " " << alpha << " " << tolerance;
        last = error;
      }
    }
  }
}

/// Largest error of the virgin curve by the table, densely sampled between two of its y.
double TableError(const BranchLaw& law, std::size_t intervals, double from, double to) {
  constexpr int kSamples = 60'000;
  std::vector<double> ramp;
  for (int i = 0; i <= kSamples; ++i) {
    const double r = from / (1 + from) + (to / (1 + to) - from / (1 + from)) * i / kSamples;
    ramp.push_back(r / (1 - r));
  }
  return ErrorAlong("table", law, ramp, intervals);
}

TEST(Table, HasOrderTwoBeforeSlip) {
  constexpr double kTolerance = 0.02;  // 60 samples an interval find its largest error to 1e-3
  for (const double alpha : {0.1, 1.0 / 3, 0.7, 1.0, 3.0}) {
    const BranchLaw law{1, alpha, 1};
    const double end = 0.8 * ReferenceDisplacement(law);
    const double observed =
        std::log2(TableError(law, 256, 0, end) / TableError(law, 1024, 0, end)) / 2;
    EXPECT_NEAR(observed, 2, kTolerance) << alpha;
  }
}

TEST(Table, HasTheOrderOfTheCornerOverAll) {
  constexpr double kTolerance = 0.05;
  struct Case {
    double alpha, end;
  };
  // For α >= 1 slip is at infinity, to which y = 1e12 is near enough.
  for (const auto& [alpha, end] : {Case{1.0 / 3, 1.5}, Case{0.7, 1 / 0.3}, Case{1.0, 1e12},
                                   Case{3.0, 1e12}, Case{4.0, 1e12}}) {
    const BranchLaw law{1, alpha, 1};
    const double order = 1 / std::max(std::abs(1 - alpha), 0.5);  // at most 2
    const double observed =
        std::log2(TableError(law, 128, 0, end) / TableError(law, 512, 0, end)) / 2;
    EXPECT_NEAR(observed, order, kTolerance) << alpha;
  }
}

TEST(Table, IsExactForTheHyperbolaItIsSpacedBy) {
  // α = 2: φ = y/(1+y).
  const std::vector<double> drive = {0.1, 0.7, 3, 50, 2, -1e6};
  EXPECT_LE(ErrorAlong("table", {1, 2.0, 1}, drive, 3),
            1e-14);  // its nodes and y/(1+y) are rounded
}

}  // namespace
}  // namespace mindahl::methods::order_test
