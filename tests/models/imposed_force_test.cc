#include "support/imposed_force.h"

#include <boost/multiprecision/cpp_bin_float.hpp>

#include "../../tools/reference/exact_history.h"
#include "../support/histories.h"
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

}  // namespace
}  // namespace mindahl::models::imposed_force_test
