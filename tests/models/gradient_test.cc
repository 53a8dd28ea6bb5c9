// The gradients of fits, with and without a spring in series, against central differences of the
// literal laws at 50 digits.

#include <boost/math/tools/toms748_solve.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>

#include "../../tools/reference/exact_history.h"
#include "../../tools/reference/force_and_gradient.h"
#include "../support/histories.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/response.h"
#include "support/prelude.h"

namespace mindahl::models::gradient_test {
namespace {

using Real = boost::multiprecision::cpp_bin_float_50;
using Law = reference::Law<Real>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// What the force depends on, as the gradient's columns see it.
struct Point {
  Real log_stiffness, exponent, log_slip_force, unloaded, log_spring;
};

struct Case {
  const FrictionModel* model = nullptr;
  InitialState state = InitialState::kVirgin;
  double shape_exponent = 0.0;
  double size = 0.0;             // of the history over the elastic limit
  double stiffness = kInfinity;  // of the spring over σ
};

/// The root of an increasing function.
Real Solve(const std::function<Real(const Real&)>& function, const Real& low, const Real& high) {
  std::uintmax_t iterations = 200;
  const auto close = [](const Real& a, const Real& b) {
    return abs(Real(b - a)) <= Real("1e-36") * std::max(Real(abs(a)), Real(abs(b)));
  };
  const auto [left, right] =
      boost::math::tools::toms748_solve(function, low, high, close, iterations);
  return (left + right) / 2;
}

Real Largest(const std::vector<Real>& values) {
  Real largest = 0;
  for (const Real& value : values) largest = std::max(largest, Real(abs(value)));
  return largest;
}

/// T along δ: for every sample the x of the contact is found for which x + T(x)/k_r = δ.
std::vector<Real> ExactForces(const Case& test, const History& history, const Point& point) {
  const Law law = {exp(point.log_stiffness), point.exponent, exp(point.log_slip_force)};
  const Real softness = std::isinf(test.stiffness) ? Real(0) : Real(exp(-point.log_spring));
  const Real travel = law.slip_force * softness;
  const bool masing = test.model->memory == Memory::kReturnPoint;
  const auto [lowest, highest] = std::ranges::minmax(history);
  const bool steady = test.state == InitialState::kSteady;
  const Real origin = steady ? Real((Real(lowest) + Real(highest)) / 2) : point.unloaded;
  const Real amplitude = (Real(highest) - Real(lowest)) / 2;
  std::vector<Real> past;
  Real at = 0;
  Real force = 0;
  if (steady && masing) {
    const Real contact = Solve(
        [&](const Real& x) { return Real(x + reference::Backbone(law, x) * softness - amplitude); },
        0, amplitude);
    past = {contact, -contact};
  } else if (steady) {  // from the lower extreme, where the histories set out: −T* to T* over 2X
    const Real peak = Solve(
        [&](const Real& t) {
          const Real contact = std::max(Real(amplitude - t * softness), Real(0));
          return Real(t - reference::DahlStep(law, Real(-t), Real(2 * contact)));
        },
        0, law.slip_force);
    at = -amplitude + peak * softness;
    force = -peak;
  }
  std::vector<Real> forces;
  for (std::size_t i = 0; i < history.size(); ++i) {
    const Real displacement = Real(history[i]) - origin;
    if (i > 0 && history[i] == history[i - 1]) {
      forces.push_back(forces.back());
      continue;
    }
    const auto force_at = [&](const Real& x) {
      if (!masing) return x == at ? force : reference::DahlStep(law, force, Real(x - at));
      past.push_back(x);
      const Real result = reference::MasingForce(law, past);
      past.pop_back();
      return result;
    };
    const Real x = travel == 0
                       ? displacement
                       : Solve(
                             [&](const Real& trial) {
                               return Real(trial + force_at(trial) * softness - displacement);
                             },
                             Real(displacement - 2 * travel), Real(displacement + 2 * travel));
    const Real result = force_at(x);
    forces.push_back(result);
    past.push_back(x);
    at = x;
    force = result;
  }
  return forces;
}

/// Off centre, unequal reversals, an inner loop, a dwell, no sample on a corner; sets out upwards.
History UpwardHistory(double size) {
  History history;
  for (const double x : {-0.31, 0.22, 0.61, 0.61, 0.93, 0.11, 0.38, 0.57, -0.49, -1.02, -0.66, 0.03,
                         1.13, 0.52, -0.23, -1.17, 0.9}) {
    history.push_back(size * (x + 0.06));
  }
  return history;
}

void ExpectDerivatives(const Case& test) {
  // 17 branches of a dozen roundings each; one column of a branch that starts near slip is a
  // product with v^{α−1}, which amplifies them by what is measured to be a few dozen. Central
  // differences at 50 digits over 1e-12 are good to 1e-24, forward ones from α = 0 over 1e-16 to
  // 1e-16; next to α = 1 the law itself loses as many digits as are between.
  constexpr double kForce = 5e-14;     // of Tc
  constexpr double kGradient = 2e-13;  // of the column's largest entry
  // Without memory ∂T/∂α holds ln v, and v = 1 − s·t is known to ε: ε/t of it, t the history's
  // size.
  constexpr double kLogRemaining = 4 * std::numeric_limits<double>::epsilon();
  const BranchLaw law{4.839e8, test.shape_exponent, 30.0};
  const SeriesSpring rig{test.stiffness * law.tangential_stiffness};
  const History history = UpwardHistory(test.size * law.slip_force / law.tangential_stiffness);
  std::vector<double> force(history.size());
  std::vector<double> gradient(history.size() * kGradientColumns);
  EvaluateForceAndGradient(*test.model, law, PathOf(*test.model, history, {.state = test.state}),
                           history, force, gradient, rig);

  const bool rigid = std::isinf(test.stiffness);
  const Point point = {log(Real(law.tangential_stiffness)), Real(law.shape_exponent),
                       log(Real(law.slip_force)), Real(0),
                       rigid ? Real(0) : Real(log(Real(rig.stiffness)))};
  const std::vector<Real> exact_force = ExactForces(test, history, point);
  for (std::size_t i = 0; i < history.size(); ++i) {
    EXPECT_NEAR(force[i], static_cast<double>(exact_force[i]), kForce * law.slip_force) << i;
  }
  const Real step(test.shape_exponent == 0 ? "1e-16" : "1e-12");
  for (const auto& [column, member] : {std::pair{kPerLogStiffness, &Point::log_stiffness},
                                       {kPerShapeExponent, &Point::exponent},
                                       {kPerLogSlipForce, &Point::log_slip_force},
                                       {kPerUnloadedDisplacement, &Point::unloaded},
                                       {kPerLogSeriesStiffness, &Point::log_spring}}) {
    const bool in_displacement = column == kPerUnloadedDisplacement;
    if ((in_displacement && test.state == InitialState::kSteady) ||
        (column == kPerLogSeriesStiffness && rigid)) {
      for (std::size_t i = 0; i < history.size(); ++i) {
        EXPECT_EQ(gradient[i * kGradientColumns + column], 0.0) << "column " << column;
      }
      continue;
    }
    // δ₀ in units of the elastic limit, as the other parameters are of order 1.
    const Real change =
        in_displacement ? Real(step * law.slip_force / law.tangential_stiffness) : step;
    Point above = point;
    Point below = point;
    above.*member += change;
    if (below.*member > 0 || member != &Point::exponent) below.*member -= change;
    const std::vector<Real> high = ExactForces(test, history, above);
    const std::vector<Real> low = ExactForces(test, history, below);
    std::vector<Real> exact;
    for (std::size_t i = 0; i < high.size(); ++i) {
      exact.push_back((high[i] - low[i]) / (above.*member - below.*member));
    }
    // ∂T/∂ln Tc is a difference of T and others, and has the digits of these.
    const Real largest = column == kPerLogSlipForce ? std::max(Largest(exact), Largest(exact_force))
                                                    : Largest(exact);
    const bool holds_log = column == kPerShapeExponent && test.model->memory == Memory::kNone;
    const double bound = holds_log ? std::max(kGradient, kLogRemaining / test.size) : kGradient;
    for (std::size_t i = 0; i < history.size(); ++i) {
      const Real error = abs(Real(gradient[i * kGradientColumns + column]) - exact[i]);
      EXPECT_LE(static_cast<double>(error), bound * static_cast<double>(largest))
          << "column " << column << ", sample " << i;
    }
  }
}

TEST(Gradient, AgreesWithDifferencesOfTheExactLaws) {
  for (const FrictionModel& model : FrictionModels()) {
    for (const double alpha : {0.0, 1e-8, 1.0 / 3.0, 1 - 1e-15, 1.0, 2.0, 20.0}) {
      if (alpha != model.shape_exponent.value_or(alpha)) continue;
      for (const InitialState state : {InitialState::kVirgin, InitialState::kSteady}) {
        for (const auto& [size, stiffness] : {std::pair{1e-3, kInfinity},
                                              {0.97, kInfinity},
                                              {3.1, kInfinity},
                                              {0.05, 0.3},
                                              {3.1, 1.0},
                                              {17.0, 0.08}}) {
          SCOPED_TRACE(::testing::Message() << model.name << ", alpha " << alpha
                                            << (state == InitialState::kSteady ? ", steady" : "")
                                            << ", size " << size << ", spring " << stiffness);
          ExpectDerivatives({&model, state, alpha, size, stiffness});
        }
      }
    }
  }
}

}  // namespace
}  // namespace mindahl::models::gradient_test
