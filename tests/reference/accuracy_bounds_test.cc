// Every public function of the models within the bound that its docstring states, over the whole
// box of docs/accuracy.md, against the closed forms at 150 or 500 digits.

#include <fmt/format.h>

#include <map>

#include "../../tools/accuracy/measurements.h"
#include "../support/histories.h"
#include "../support/worst.h"
#include "mindahl/models/backbone.h"
#include "mindahl/models/branch_law.h"
#include "support/prelude.h"

namespace mindahl::models::accuracy_bounds_test {
namespace {

std::string Describe(const BranchLaw& law, double x) {
  return fmt::format("alpha = {}, sigma = {}, Tc = {}, x = {}", law.shape_exponent,
                     law.tangential_stiffness, law.slip_force, x);
}

TEST(AccuracyBounds, HoldOverTheWholeBox) {
  const auto measurements = accuracy::Measurements();
  std::map<std::string, Worst> worst;
  std::size_t points = 0;
  accuracy::ForEveryPoint([&](const BranchLaw& law, double x) {
    const accuracy::Exact exact = accuracy::EvaluateExactly(law, x);
    for (const auto& measurement : measurements) {
      worst[measurement.function].Add(measurement.error(law, x, exact),
                                      [&] { return Describe(law, x); });
    }
    ++points;
  });
  EXPECT_GT(points, 10'000U);
  for (const auto& measurement : measurements) {
    const Worst& error = worst[measurement.function];
    EXPECT_LE(error.value, measurement.bound) << measurement.function << " at " << error.where;
    // A bound that nothing comes near would prove little.
    EXPECT_GE(error.value, measurement.bound / 20) << measurement.function;
  }
}

TEST(AccuracyBounds, OfTheScalarKernelsHoldInTheirOwnUnits) {
  constexpr double kForce = 4.0;  // [ε]: log1p, expm1 and three products, each within an ulp
  // exp passes on the error of its argument: |log u| <= 745 in double, half an ulp each.
  constexpr double kDerivative = 400.0;
  const auto error = [](double value, long double exact) {
    return std::abs(exact) < std::numeric_limits<double>::min()
               ? std::abs(value) / std::numeric_limits<double>::min()
               : accuracy::RelativeError(value, exact);
  };
  for (const double alpha : reference::kBoxShapeExponents) {
    for (const double y : reference::BoxDisplacements({1.0, 1.0}, alpha)) {
      const accuracy::Exact exact = accuracy::EvaluateExactly({1.0, alpha, 1.0}, y);
      const double force =
          backbone::WithShape(alpha, [&](const auto& shape) { return shape.Force(y); });
      const auto phi = backbone::Differentiate(y, alpha);
      EXPECT_LE(error(force, exact.force), kForce) << alpha << ", " << y;
      EXPECT_LE(std::max({error(phi.force, exact.force), error(phi.slope, exact.slope),
                          error(phi.elastic, exact.per_log_stiffness),
                          error(phi.shape_derivative, exact.per_shape)}),
                kDerivative)
          << alpha << ", " << y;
    }
  }
}

TEST(AccuracyBounds, GrossSlipDisplacementIsRoundedOnce) {
  constexpr double kBound = 1.0;  // [ε]
  for (const double shape_exponent : reference::kBoxShapeExponents) {
    if (shape_exponent >= 1) continue;
    for (const reference::Scale& scale : reference::kBoxScales) {
      using Real = reference::Digits500;
      const BranchLaw law{scale.stiffness, shape_exponent, scale.slip_force};
      const Real exact =
          Real(law.slip_force) / (Real(law.tangential_stiffness) * (1 - Real(law.shape_exponent)));
      EXPECT_LE(
          accuracy::RelativeError(GrossSlipDisplacement(law), static_cast<long double>(exact)),
          kBound)
          << Describe(law, 0);
    }
  }
}

TEST(AccuracyBounds, DahlsSteadyLoopHoldsItsOwn) {
  // steady_loop.h: T* within 16 ε; W within (16 + α) ε of itself, and of 4XT* near slip where
  // α < 0.05 makes W a difference of nearly equal numbers.
  constexpr double kPeak = 16.0;
  constexpr double kEnergy = 16.0;
  constexpr std::size_t kEvery = 11;  // of the displacements: the reference is solved for
  std::size_t count = 0;
  for (const double shape_exponent : reference::kBoxShapeExponents) {
    for (const reference::Scale& scale : {reference::kBoxScales[1], reference::kBoxScales[6]}) {
      const BranchLaw law{scale.stiffness, shape_exponent, scale.slip_force};
      for (const double x : reference::BoxDisplacements(scale, shape_exponent)) {
        if (count++ % kEvery != 0) continue;
        const accuracy::ExactDahlLoop exact = accuracy::EvaluateDahlExactly(law, x);
        EXPECT_LE(accuracy::RelativeError(SteadyPeakForce(Model("dahl"), law, x), exact.peak),
                  kPeak)
            << Describe(law, x);
        const double y = law.tangential_stiffness * x / law.slip_force;
        const bool onset = shape_exponent < 0.05 && std::abs(y - 1) < 0.1;
        EXPECT_LE(accuracy::ErrorInEpsilons(SteadyLoopEnergy(Model("dahl"), law, x), exact.energy,
                                            onset ? 4 * x * exact.peak : exact.energy),
                  kEnergy + shape_exponent)
            << Describe(law, x);
      }
    }
  }
}

}  // namespace
}  // namespace mindahl::models::accuracy_bounds_test
