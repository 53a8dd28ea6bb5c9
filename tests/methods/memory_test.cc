// What a method keeps of the past: reversals, loops that close between samples, amplitudes.

#include "mindahl/models/loading_path.h"
#include "mindahl/models/response.h"
#include "responses.h"
#include "support/prelude.h"

namespace mindahl::methods::memory_test {
namespace {

using namespace models;

constexpr BranchLaw kLaw{.tangential_stiffness = 1, .shape_exponent = 1.0 / 3, .slip_force = 1};

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

}  // namespace
}  // namespace mindahl::methods::memory_test
