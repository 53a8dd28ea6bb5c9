#include "support/imposed_force.h"

#include <boost/multiprecision/cpp_bin_float.hpp>

#include "../../tools/reference/exact_history.h"
#include "../support/histories.h"
#include "mindahl/models/response.h"
#include "models/normalized_response.h"
#include "support/prelude.h"

namespace mindahl::models::imposed_force_test {
namespace {

using Real = boost::multiprecision::cpp_bin_float_50;

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr double kExponents[] = {0.0, 1e-9, 0.2, 1.0 / 3, 0.5, 0.9, 1 - 1e-12, 1.0, 1.5, 3.0};

/// A walk or white sequence of forces within ±reach, with dwells; where reach is near Tc, so are
/// some of them.
History RandomForces(Generator& generator, double slip_force) {
  const double nearest = LogUniform(generator, 1e-13, 1.0);  // to slip, over Tc
  const double reach = slip_force * (1 - nearest);
  History force(3 + generator() % 58);
  double at = 0.0;
  for (double& value : force) {
    const double step = Uniform(generator, -reach, reach);
    if (generator() % 8 != 0) at = generator() % 3 == 0 ? std::copysign(reach, step) : step;
    value = at;
  }
  return force;
}

/// x with f(x) = F >= 0, as printed.
Real Stretch(const reference::Law<Real>& law, const Real& force) {
  const Real remaining = 1 - force / law.slip_force;
  const Real beta = 1 - law.exponent;
  const Real elastic_limit = law.slip_force / law.stiffness;
  if (beta == 0) return -elastic_limit * log(remaining);
  return elastic_limit * (1 - reference::PositivePower(remaining, beta)) / beta;
}

/// The displacement at the end of a history of force, and what it is known to.
struct Expected {
  Real displacement = 0;
  double bound = 0.0;

  void Add(const Real& step, double tolerance) {
    displacement += step;
    bound += tolerance * static_cast<double>(abs(step));
  }
};

/// Of a branch: (6 + |1 − α|·|ln u|) ε, 1 ε for its sum with what is before it, 1 for the sum with
/// the rounded one.
double BranchTolerance(const reference::Law<Real>& law, const Real& remaining) {
  const double beta = std::abs(1 - static_cast<double>(law.exponent));
  return (8 + beta * std::abs(std::log(static_cast<double>(remaining)))) * kEpsilon;
}

/// δ = Σ 2·sgn·x(|eₖ₊₁ − eₖ|/2) over the extrema of the force that are remembered.
Expected MasingDisplacement(const reference::Law<Real>& law, const std::vector<Real>& force) {
  Expected expected;
  Real from = 0;
  double times = 1.0;
  for (const Real& extremum : reference::DominantExtrema(force)) {
    const Real half = Real(abs(extremum - from)) / times;
    const Real size = times * Stretch(law, half);
    expected.Add(extremum < from ? Real(-size) : size,
                 BranchTolerance(law, 1 - half / law.slip_force));
    from = extremum;
    times = 2.0;
  }
  return expected;
}

/// Sample by sample, (v₀^β − v^β)/(βκ) with v = 1 − sT/Tc.
Expected DahlDisplacement(const reference::Law<Real>& law, const std::vector<Real>& force) {
  Expected expected;
  Real from = 0;
  for (const Real& to : force) {
    if (to == from) continue;
    const int sign = to > from ? 1 : -1;
    const Real before = 1 - sign * from / law.slip_force;
    const Real after = 1 - sign * to / law.slip_force;
    const Real size = pow(before, Real(1 - law.exponent)) *
                      Stretch(law, Real(law.slip_force * (1 - after / before)));
    expected.Add(sign * size, BranchTolerance(law, Real(after / before)));
    // What 2 ε·Tc of the force are at either end.
    const Real softness = pow(before, Real(-law.exponent)) + pow(after, Real(-law.exponent));
    expected.bound += static_cast<double>(2 * kEpsilon * law.slip_force / law.stiffness * softness);
    from = to;
  }
  return expected;
}

TEST(ImposedForce, IsExactOnAnyHistoryToTheRoundingOfItsBranches) {
  Generator generator(2211);
  for (const double exponent : kExponents) {
    for (int i = 0; i < 15; ++i) {
      const BranchLaw law{LogUniform(generator, 1e-3, 1e9), exponent,
                          LogUniform(generator, 1e-6, 1e6)};
      const reference::Law<Real> exact{law.tangential_stiffness, exponent, law.slip_force};
      const History force = RandomForces(generator, law.slip_force);
      const std::vector<double> masing = DisplacementUnder(Model("mindlin-dahl"), law, force);
      const std::vector<double> dahl = DisplacementUnder(Model("dahl"), law, force);
      std::vector<Real> past;
      for (std::size_t k = 0; k < force.size(); ++k) {
        past.emplace_back(force[k]);
        const Expected expected = MasingDisplacement(exact, past);
        ASSERT_LE(std::abs(static_cast<double>(masing[k] - expected.displacement)), expected.bound)
            << "alpha = " << exponent << ", history " << i << ", sample " << k;
      }
      const Expected expected = DahlDisplacement(exact, past);
      ASSERT_LE(std::abs(static_cast<double>(dahl.back() - expected.displacement)), expected.bound)
          << "alpha = " << exponent << ", history " << i;
    }
  }
}

// ---

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
  EXPECT_TRUE(
      EvaluateNormalizedDisplacement(model, law, PathOfForces(model, force, initial), force, d));
  return d;
}

struct Gradient {
  explicit Gradient(std::size_t size)
      : log_slip_force(size), shape_exponent(size), unloaded_force(size) {}
  History log_slip_force;
  History shape_exponent;
  History unloaded_force;
};

TEST(EvaluateNormalizedDisplacement, GradientIsThatOfDifferences) {
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
        ASSERT_TRUE(EvaluateNormalizedDisplacement(
            model, {kSlipForce, alpha}, PathOfForces(model, force, initial), force, d,
            {gradient.log_slip_force, gradient.shape_exponent, gradient.unloaded_force}));
        // Each column alone is the same.
        Gradient alone(force.size());
        const std::array<DisplacementGradient, 3> columns = {{{{alone.log_slip_force, {}, {}}},
                                                              {{{}, alone.shape_exponent, {}}},
                                                              {{{}, {}, alone.unloaded_force}}}};
        for (const DisplacementGradient& column : columns) {
          ASSERT_TRUE(EvaluateNormalizedDisplacement(
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

TEST(EvaluateNormalizedDisplacement, OfAForceAtSlipIsNone) {
  const History force = {0.0, 0.5, 0.99, 1.0, 0.5};
  History d(force.size());
  const FrictionModel& model = Model("mindlin-dahl");
  EXPECT_FALSE(
      EvaluateNormalizedDisplacement(model, {1.0, 0.4}, PathOfForces(model, force), force, d));
  EXPECT_TRUE(
      EvaluateNormalizedDisplacement(model, {1.001, 0.4}, PathOfForces(model, force), force, d));
}

}  // namespace
}  // namespace mindahl::models::imposed_force_test
