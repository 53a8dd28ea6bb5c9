// What a method keeps of the past: reversals, loops that close between samples, amplitudes.

#include "mindahl/models/loading_path.h"
#include "mindahl/models/response.h"
#include "responses.h"
#include "support/prelude.h"

namespace mindahl::methods::memory_test {
namespace {

using namespace models;

constexpr std::array kFollowers = {std::string_view("euler"), std::string_view("rk4"),
                                   std::string_view("dopri5"), std::string_view("backward-euler"),
                                   std::string_view("exponential")};
constexpr BranchLaw kLaw{.tangential_stiffness = 1, .shape_exponent = 1.0 / 3, .slip_force = 1};

TEST(ReturnPoint, LoopsThatCloseInMidSampleKeepTheOrder) {
  // 11 samples a cycle fall on no extreme of the nested loops, so each closes between samples. The
  // order is that of methods before slip, to a step's share of the way to it (order_test.cc).
  constexpr double kLambda = 0.8;
  const std::vector<double> drive = Displacements({.waveform = Waveform::kNested,
                                                   .amplitude = kLambda * 1.5,
                                                   .cycles = 8,
                                                   .samples_per_cycle = 11});
  double longest = 0.0;
  for (std::size_t i = 1; i < drive.size(); ++i) {
    longest = std::max(longest, std::abs(drive[i] - drive[i - 1]));
  }
  const Drive imposed{.displacement = drive};
  const auto exact = RespondBy("exact", "mindlin", kLaw, imposed);
  for (const std::string_view method : kFollowers) {
    const double order = FindMethod(method)->order;
    const std::size_t steps = method == "dopri5" ? 8 : 32;  // above the roundings
    const auto error = [&](std::size_t count) {
      return LargestDifference(
          RespondBy(method, "mindlin", kLaw, imposed, {.steps = count, .tolerance = 1e9}), exact);
    };
    const double share = longest / static_cast<double>(steps) / (1 - kLambda);
    EXPECT_NEAR(std::log2(error(steps / 2) / error(steps)), order, 2 * order * share) << method;
  }
}

TEST(ReturnPoint, AClosedLoopLeavesNothingBehind) {
  // The same way with and without an inner loop, which closes between the last two samples.
  const std::vector<double> with_loop = {0.4, 0.9, 0.5, 0.7, 0.45, 0.62, 0.3, 0.55, 0.2, -0.1};
  const std::vector<double> without = {0.4, 0.9, 0.5, 0.45, 0.3, 0.2, -0.1};
  for (const Method& method : Methods()) {
    const auto last = [&](const std::vector<double>& drive) {
      return RespondBy(method.name, "mindlin", kLaw, {.displacement = drive},
                       {.steps = method.default_steps})
          .back();
    };
    // Elements add roundings up, and nothing else does.
    EXPECT_NEAR(last(with_loop), last(without), method.masing_only ? 1e-14 : 0.0) << method.name;
  }
}

TEST(ReturnPoint, NothingDriftsInTenThousandCycles) {
  // A large cycle with an inner loop on either side, the same numbers every time.
  constexpr std::size_t kCycles = 10'000;
  const std::vector<double> cycle = {0.6, 1.1, 0.5, 0.7, 0.3, -0.4, -1.1, -0.8, -0.95, -0.2, 0.1};
  std::vector<double> drive;
  for (std::size_t i = 0; i < kCycles; ++i) drive.insert(drive.end(), cycle.begin(), cycle.end());
  // An element that never slips keeps each rounding, ε/2 of its force: in the worst case all of one
  // sign.
  const double elements = static_cast<double>(drive.size()) * 1.2e-16;
  for (const Method& method : Methods()) {
    const auto force = RespondBy(method.name, "mindlin", kLaw, {.displacement = drive},
                                 {.steps = method.masing_only ? 8 : method.default_steps});
    const auto nth = [&](std::size_t n) {
      return std::span(force).subspan(n * cycle.size(), cycle.size());
    };
    EXPECT_LE(LargestDifference(nth(2), nth(kCycles - 1)), method.masing_only ? elements : 0.0)
        << method.name;
  }
}

TEST(Envelope, StepsConvergeToTheExactPathOfAGrowingAmplitude) {
  const Excitation growing = MakeExcitation({.waveform = Waveform::kGrowingSine,
                                             .amplitude = 0.9 * 1.5,
                                             .cycles = 4,
                                             .samples_per_cycle = 40,
                                             .growth = 3});
  const Drive drive{.displacement = growing.displacement, .envelope = growing.envelope};
  const FrictionModel& model = *FindFrictionModel("simplified-dahl");
  std::vector<double> exact(growing.displacement.size());
  EvaluateForce(model, kLaw, MakeEnvelopePath(growing.displacement, growing.envelope, 0.0),
                growing.displacement, exact);
  EXPECT_EQ(RespondBy("exact", "simplified-dahl", kLaw, drive), exact);
  for (const std::string_view method : kFollowers) {
    const double order = std::min(FindMethod(method)->order, 4.0);
    const auto error = [&](std::size_t steps) {
      return LargestDifference(
          RespondBy(method, "simplified-dahl", kLaw, drive, {.steps = steps, .tolerance = 1e9}),
          exact);
    };
    // At least its order: 2^p a doubling, less a tenth for the next term.
    EXPECT_LT(error(8), error(4) * std::exp2(0.1 - order) + 1e-14) << method;
  }
}

TEST(Envelope, IsOnlyLookedAtByModelsThatReferToTheirSteadyLoop) {
  const std::vector<double> drive = {0.3, 0.6, 0.1, -0.5};
  const std::vector<double> envelope = {0.3, 0.6, 0.6, 0.6};
  for (const FrictionModel& model : FrictionModels()) {
    const bool same =
        RespondBy("exact", model.name, kLaw, {.displacement = drive, .envelope = envelope}) ==
        RespondBy("exact", model.name, kLaw, {.displacement = drive});
    EXPECT_EQ(same, !model.scaled_by_peak) << model.name;
  }
}

}  // namespace
}  // namespace mindahl::methods::memory_test
