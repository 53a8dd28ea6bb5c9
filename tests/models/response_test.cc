#include "mindahl/models/response.h"

#include "../support/histories.h"
#include "mindahl/contact/cattaneo_mindlin.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/excitation.h"
#include "mindahl/models/simplified_law.h"
#include "support/prelude.h"

namespace mindahl::models::response_test {
namespace {

/// The contact of Peyret et al. (2017) §3; σ from eq. 21, not the printed value.
constexpr double kRadius = 0.0027;
constexpr double kCompliance = 4.42e-11;
constexpr double kSlipForce = 0.3 * 100;
constexpr BranchLaw kPaperLaw = {8 * kRadius / kCompliance, 1.0 / 3.0, kSlipForce};

constexpr std::size_t kCycles = 5;
constexpr std::size_t kPerCycle = 1000;  // samples

std::vector<double> PaperSine(double lambda, double cycles, std::size_t samples_per_cycle) {
  return MakeExcitation({.amplitude = lambda * GrossSlipDisplacement(kPaperLaw),
                         .cycles = cycles,
                         .samples_per_cycle = samples_per_cycle})
      .displacement;
}

TEST(FullDahl, IsMindlinIdentically) {
  // Against eqs 13 to 15; the sums of forces here and there round by a few ε of Tc.
  constexpr double kRounding = 1e-14;  // of Tc
  const contact::MindlinContact mindlin{kRadius, kCompliance, kSlipForce};
  for (const double lambda : {0.01, 0.3, 0.8, 0.99, 1.0, 1.2, 3.0}) {
    const History history = PaperSine(lambda, kCycles, kPerCycle);
    const double amplitude = *std::ranges::max_element(history);
    const std::vector<double> force = Respond(Model("mindlin-dahl"), kPaperLaw, history);
    for (std::size_t i = 0; i < history.size(); ++i) {
      const std::size_t phase = (i + kPerCycle / 4) % kPerCycle;  // 0 at the lower extreme
      const double expected = i <= kPerCycle / 4 ? MindlinVirginForce(mindlin, history[i])
                              : phase < kPerCycle / 2
                                  ? MindlinReloadingForce(mindlin, history[i], amplitude)
                                  : MindlinUnloadingForce(mindlin, history[i], amplitude);
      ASSERT_NEAR(force[i], expected, kRounding * kSlipForce)
          << "lambda = " << lambda << ", sample " << i;
    }
  }
}

/// Largest |T − Mindlin| in each cycle of a sine, in % of T*.
std::vector<double> ErrorsByCycle(const History& history, const std::vector<double>& force) {
  const std::vector<double> mindlin = Respond(Model("mindlin"), kPaperLaw, history);
  const double peak = *std::ranges::max_element(mindlin);
  std::vector<double> errors(kCycles);
  for (std::size_t i = 0; i < kCycles * kPerCycle; ++i) {
    double& worst = errors[i / kPerCycle];
    worst = std::max(worst, 100 * std::abs(force[i] - mindlin[i]) / peak);
  }
  return errors;
}

std::vector<double> SimplifiedDahlErrors(double lambda) {
  const History history = PaperSine(lambda, kCycles, kPerCycle);
  std::vector<double> force(history.size());
  EvaluateSimplifiedDahl(kPaperLaw, history, {}, force);
  return ErrorsByCycle(history, force);
}

/// docs/theory.md §2; each value to half a unit of its last printed digit, and a little for the
/// sampling of the sine.
void ExpectErrors(const std::vector<double>& errors, const std::vector<double>& printed,
                  const std::vector<double>& half_units) {
  for (std::size_t i = 0; i < errors.size(); ++i) {
    EXPECT_NEAR(errors[i], printed[i], 1.05 * half_units[i]) << "cycle " << i + 1;
  }
}

TEST(SimplifiedDahl, ConvergesFivefoldACycleInMicroSlip) {
  ExpectErrors(SimplifiedDahlErrors(0.8), {11.4, 3.57, 0.719, 0.144, 0.029},
               {0.05, 0.005, 0.0005, 0.0005, 0.0005});
}

TEST(SimplifiedDahl, IsRightFromTheSecondCycleOnInGrossSlip) {
  constexpr double kRounding = 1e-10;
  ExpectErrors(SimplifiedDahlErrors(1.2), {13.3, 0, 0, 0, 0},
               {0.05, kRounding, kRounding, kRounding, kRounding});
}

TEST(MasingMemory, AddsUpAMillionNestedReversalsAsARandomWalkOfRoundings) {
  // T = f(e₀) + Σ 2·sgn·f(|eₖ₊₁ − eₖ|/2), summed in long double.
  constexpr std::size_t kReversals = 1'000'000;
  constexpr double kBound = 2e-13;  // response.h, 1e-13, and the test's own arguments
  const BranchLaw law{1.0, 1.0 / 3.0, 1.0};
  History history(kReversals);
  for (std::size_t i = 0; i < kReversals; ++i) {
    const double size = 3.0 * static_cast<double>(kReversals - i) / kReversals;
    history[i] = i % 2 == 0 ? size : -size;
  }
  const std::vector<double> force = Respond(Model("mindlin-dahl"), law, history);
  long double sum = 0;
  double from = 0.0;
  for (std::size_t i = 0; i < kReversals; ++i) {
    const double step = history[i] - from;
    const double span = i == 0 ? 1.0 : 2.0;
    sum += static_cast<long double>(span) * BackboneForce(law, step / span);
    from = history[i];
    if (i % 1000 == 0 || i + 1 == kReversals) {
      ASSERT_NEAR(force[i], static_cast<double>(sum), kBound) << i;
    }
  }
}

TEST(EvaluateForce, RejectsSizesThatDiffer) {
  const History history = {0.0, 1.0, 0.5};
  const LoadingPath path = PathOf(Model("mindlin"), history);
  const BranchLaw law{1.0, 1.0 / 3.0, 1.0};
  std::vector<double> two(2);
  std::vector<double> three(3);
  EXPECT_THROW(EvaluateForce(Model("mindlin"), law, path, history, two), InvalidArgument);
  const History longer = {0.0, 1.0, 0.5, 2.0};
  std::vector<double> four(4);
  EXPECT_THROW(EvaluateForce(Model("mindlin"), law, path, longer, four), InvalidArgument);
  const History shorter = {0.0, 1.0};
  EXPECT_THROW(EvaluateForce(Model("mindlin"), law, path, shorter, two), InvalidArgument);
  EXPECT_THROW(EvaluateForce(Model("mindlin"), {-1.0, 0.5, 1.0}, path, history, three),
               InvalidArgument);
}

}  // namespace
}  // namespace mindahl::models::response_test
