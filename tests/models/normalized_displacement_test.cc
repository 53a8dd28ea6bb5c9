#include "mindahl/models/response.h"
#include "models/normalized_response.h"
#include "support/histories.h"
#include "support/prelude.h"

namespace mindahl::models::normalized_displacement_test {
namespace {

constexpr double kSlipForce = 7.0;  // [N]

/// Cycles between ±peak and nested ones, all below slip.
History Forces(Generator& generator, double peak) {
  History force;
  double from = 0.0;
  for (int stroke = 0; stroke < 9; ++stroke) {
    const double to =
        (stroke % 2 == 0 ? 1 : -1) * peak * (stroke < 4 ? 1.0 : Uniform(generator, 0.1, 1));
    for (int i = 1; i <= 12; ++i) force.push_back(from + (to - from) * i / 12);
    from = to;
  }
  return force;
}

LoadingPath PathOfForces(const FrictionModel& model, const History& force,
                         const InitialContact& initial = {}) {
  return MakeLoadingPath(force, loop::FindReversals(force, 0.0), model.memory, initial);
}

History Reduced(const FrictionModel& model, const ForcedLaw& law, const History& force,
                const InitialContact& initial = {}) {
  History d(force.size());
  NormalizedDisplacement displacement;
  EXPECT_TRUE(displacement.Evaluate(model, law, PathOfForces(model, force, initial), force, d));
  return d;
}

struct Gradient {
  explicit Gradient(std::size_t size)
      : log_slip_force(size), shape_exponent(size), unloaded_force(size) {}
  History log_slip_force;
  History shape_exponent;
  History unloaded_force;
};

TEST(NormalizedDisplacement, GradientIsThatOfDifferences) {
  // Central differences of step h err by h²/6 of the third derivative, which (1 − φ)^−3 < 1e4
  // bounds here, and by rounding over h.
  constexpr double kStep = 1e-5;
  constexpr double kTolerance = 1e-5;
  Generator generator(2);
  for (const std::string_view name : {"mindlin-dahl", "dahl"}) {
    for (const InitialState state : {InitialState::kVirgin, InitialState::kSteady}) {
      for (const double alpha : {0.2, 1.0 / 3, 0.7, 1.0, 1.5}) {
        const History force = Forces(generator, 0.85 * kSlipForce);
        const FrictionModel& model = Model(name);
        const InitialContact initial{.state = state, .unloaded_displacement = 0.05};
        Gradient gradient(force.size());
        History d(force.size());
        NormalizedDisplacement displacement;
        ASSERT_TRUE(displacement.Differentiate(
            model, {kSlipForce, alpha}, PathOfForces(model, force, initial), force, d,
            {gradient.log_slip_force, gradient.shape_exponent, gradient.unloaded_force}));
        // Each column alone is the same.
        Gradient alone(force.size());
        const std::array<DisplacementGradient, 3> columns = {{{{alone.log_slip_force, {}, {}}},
                                                              {{{}, alone.shape_exponent, {}}},
                                                              {{{}, {}, alone.unloaded_force}}}};
        for (const DisplacementGradient& column : columns) {
          ASSERT_TRUE(displacement.Differentiate(
              model, {kSlipForce, alpha}, PathOfForces(model, force, initial), force, d, column));
        }
        EXPECT_EQ(alone.log_slip_force, gradient.log_slip_force);
        EXPECT_EQ(alone.shape_exponent, gradient.shape_exponent);
        EXPECT_EQ(alone.unloaded_force, gradient.unloaded_force);
        const auto expect = [&](const History& derivative, const History& above,
                                const History& below, double width, std::string_view by) {
          for (std::size_t i = 0; i < d.size(); ++i) {
            EXPECT_NEAR(derivative[i], (above[i] - below[i]) / width,
                        kTolerance * (1 + std::abs(derivative[i])))
                << name << " " << alpha << " by " << by << " at " << i;
          }
        };
        expect(gradient.log_slip_force,
               Reduced(model, {kSlipForce * std::exp(kStep), alpha}, force, initial),
               Reduced(model, {kSlipForce * std::exp(-kStep), alpha}, force, initial), -2 * kStep,
               "-ln Tc");
        expect(gradient.shape_exponent, Reduced(model, {kSlipForce, alpha + kStep}, force, initial),
               Reduced(model, {kSlipForce, alpha - kStep}, force, initial), 2 * kStep, "alpha");
        if (state == InitialState::kSteady) continue;
        InitialContact above = initial;
        InitialContact below = initial;
        above.unloaded_displacement += kStep;
        below.unloaded_displacement -= kStep;
        expect(gradient.unloaded_force, Reduced(model, {kSlipForce, alpha}, force, above),
               Reduced(model, {kSlipForce, alpha}, force, below), 2 * kStep, "T0");
      }
    }
  }
}

TEST(NormalizedDisplacement, OfAForceAtSlipIsNone) {
  const History force = {0.0, 0.5, 0.99, 1.0, 0.5};
  History d(force.size());
  NormalizedDisplacement displacement;
  const FrictionModel& model = Model("mindlin-dahl");
  EXPECT_FALSE(displacement.Evaluate(model, {1.0, 0.4}, PathOfForces(model, force), force, d));
  EXPECT_TRUE(displacement.Evaluate(model, {1.001, 0.4}, PathOfForces(model, force), force, d));
}

}  // namespace
}  // namespace mindahl::models::normalized_displacement_test
