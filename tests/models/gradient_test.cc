// The gradients of fits against central differences of the literal laws at 100 digits.

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <ostream>
#include <tuple>

#include "../../tools/reference/exact_history.h"
#include "../../tools/reference/force_and_gradient.h"
#include "../support/histories.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/response.h"
#include "support/prelude.h"

namespace mindahl::models::gradient_test {
namespace {

using Real = boost::multiprecision::cpp_bin_float_100;
using Law = reference::Law<Real>;

/// What the force depends on, as the gradient's columns see it.
struct Point {
  Real log_stiffness, exponent, log_slip_force, unloaded;
};

Law LawAt(const Point& point) {
  return {exp(point.log_stiffness), point.exponent, exp(point.log_slip_force)};
}

std::vector<Real> Shifted(const History& history, const Real& origin) {
  std::vector<Real> shifted;
  for (const double displacement : history) shifted.push_back(Real(displacement) - origin);
  return shifted;
}

/// Forces along `past` from its sample `first` on.
std::vector<Real> MasingForces(const Law& law, const std::vector<Real>& past, std::size_t first) {
  std::vector<Real> force;
  for (std::size_t i = first; i < past.size(); ++i) {
    force.push_back(reference::MasingForce(
        law, std::vector<Real>(past.begin(), past.begin() + static_cast<std::ptrdiff_t>(i) + 1)));
  }
  return force;
}

using Step = std::function<Real(const Real& force, const Real& step)>;

std::vector<Real> SteppedForces(const std::vector<Real>& history, Real at, Real force,
                                const Step& step) {
  std::vector<Real> forces;
  for (const Real& displacement : history) {
    if (displacement != at) force = step(force, Real(displacement - at));
    at = displacement;
    forces.push_back(force);
  }
  return forces;
}

Real Largest(const std::vector<Real>& values) {
  Real largest = 0;
  for (const Real& value : values) largest = std::max(largest, Real(abs(value)));
  return largest;
}

/// T* of Dahl's steady loop between ±X, by bisection of its definition: −T* leads to T* over 2X.
Real DahlPeak(const Law& law, const Real& amplitude) {
  Real low = 0;
  Real high = law.slip_force;
  for (int i = 0; i < 170; ++i) {
    const Real middle = (low + high) / 2;
    const bool short_of_it = reference::DahlStep(law, Real(-middle), Real(2 * amplitude)) > middle;
    (short_of_it ? low : high) = middle;
  }
  return (low + high) / 2;
}

std::vector<Real> ExactForces(const std::string& model, InitialState state, const History& history,
                              const Point& point) {
  const Law law = LawAt(point);
  if (state == InitialState::kVirgin) {
    const std::vector<Real> path = Shifted(history, point.unloaded);
    if (model == "dahl") {
      return SteppedForces(path, 0, 0, [&](const Real& force, const Real& step) {
        return reference::DahlStep(law, force, step);
      });
    }
    if (model == "simplified-dahl") {
      // The amplitude does not move with the unloaded displacement (response.h).
      const Real peak = reference::Backbone(law, Largest(Shifted(history, 0)));
      return SteppedForces(path, 0, 0, [&](const Real& force, const Real& step) {
        return reference::SimplifiedDahlStep(law, peak, force, step);
      });
    }
    return MasingForces(law, path, 0);
  }
  const auto [lowest, highest] = std::ranges::minmax(history);
  const Real centre = (Real(lowest) + Real(highest)) / 2;
  const Real amplitude = (Real(highest) - Real(lowest)) / 2;
  const std::vector<Real> path = Shifted(history, centre);
  // The histories used here set out upwards, from the lower extreme.
  if (model == "dahl") {
    return SteppedForces(
        path, Real(-amplitude), Real(-DahlPeak(law, amplitude)),
        [&](const Real& force, const Real& step) { return reference::DahlStep(law, force, step); });
  }
  if (model == "simplified-dahl") {
    const Real peak = reference::Backbone(law, amplitude);
    return SteppedForces(path, Real(-amplitude), Real(-peak),
                         [&](const Real& force, const Real& step) {
                           return reference::SimplifiedDahlStep(law, peak, force, step);
                         });
  }
  std::vector<Real> past = {amplitude, -amplitude};
  past.insert(past.end(), path.begin(), path.end());
  return MasingForces(law, past, 2);
}

/// Central differences in three parameters, forward ones in α where it cannot be negative: at 100
/// digits a step of 1e-17 leaves the truncation, 1e-17 at worst, as the error.
std::vector<std::vector<Real>> ExactGradient(const std::string& model, InitialState state,
                                             const History& history, const Point& point) {
  const Real step("1e-17");
  std::vector<std::vector<Real>> gradient;
  for (const auto member :
       {&Point::log_stiffness, &Point::exponent, &Point::log_slip_force, &Point::unloaded}) {
    Point above = point;
    Point below = point;
    above.*member += step;
    if (below.*member > 0 || member != &Point::exponent) below.*member -= step;
    const std::vector<Real> high = ExactForces(model, state, history, above);
    const std::vector<Real> low = ExactForces(model, state, history, below);
    std::vector<Real> column;
    for (std::size_t i = 0; i < high.size(); ++i) {
      column.push_back((high[i] - low[i]) / (above.*member - below.*member));
    }
    gradient.push_back(column);
  }
  return gradient;
}

/// Off centre, with unequal reversals, an inner loop, a dwell and no sample on a corner.
History UpwardHistory(double size) {
  History history;
  for (const double x : {-0.31, 0.22,  0.61, 0.61, 0.93, 0.47, 0.11,  0.38,  0.57,  0.05, -0.49,
                         -1.02, -0.66, 0.03, 0.71, 1.13, 0.52, -0.23, -0.87, -1.17, -0.4, 0.9}) {
    history.push_back(size * (x + 0.06));
  }
  return history;
}

struct Case {
  std::string model;
  InitialState state;
  double shape_exponent;
  double size;  // of the history over the elastic limit
};

std::string NameOf(const ::testing::TestParamInfo<Case>& info) {
  std::string name =
      info.param.model + (info.param.state == InitialState::kVirgin ? "_virgin" : "_steady");
  std::ranges::replace(name, '-', '_');
  return name + "_" + std::to_string(info.index);
}

std::vector<Case> Cases() {
  std::vector<Case> cases;
  for (const FrictionModel& model : FrictionModels()) {
    for (const InitialState state : {InitialState::kVirgin, InitialState::kSteady}) {
      for (const double alpha : {0.0, 1e-8, 1.0 / 3.0, 1 - 1e-15, 1.0, 1 + 1e-8, 2.0, 20.0}) {
        if (model.shape_exponent && alpha != *model.shape_exponent) continue;
        for (const double size : {1e-3, 0.97, 3.1}) {
          cases.push_back({std::string(model.name), state, alpha, size});
        }
      }
    }
  }
  return cases;
}

class Gradient : public ::testing::TestWithParam<Case> {};

TEST_P(Gradient, AgreesWithDifferencesOfTheExactLaws) {
  // 22 branches of a dozen roundings each; one column of a branch that starts near slip is a
  // product with v^{α−1}, which amplifies them by what is measured to be a few dozen.
  constexpr double kForce = 5e-14;     // of Tc
  constexpr double kGradient = 2e-13;  // of the column's largest entry
  // Without memory ∂T/∂α holds ln v, and v = 1 − s·t is known to ε: ε/t of it, t the history's
  // size.
  constexpr double kLogRemaining = 4 * std::numeric_limits<double>::epsilon();
  const Case& test = GetParam();
  const BranchLaw law{4.839e8, test.shape_exponent, 30.0};
  const double limit = law.slip_force / law.tangential_stiffness;
  const History history = UpwardHistory(test.size * limit);
  const FrictionModel& model = Model(test.model);

  std::vector<double> force(history.size());
  std::vector<double> gradient(history.size() * kGradientColumns);
  EvaluateForceAndGradient(model, law, PathOf(model, history, {.state = test.state}), history,
                           force, gradient);

  const Point point = {log(Real(law.tangential_stiffness)), Real(law.shape_exponent),
                       log(Real(law.slip_force)), Real(0)};
  const std::vector<Real> exact_force = ExactForces(test.model, test.state, history, point);
  for (std::size_t i = 0; i < history.size(); ++i) {
    EXPECT_NEAR(force[i], static_cast<double>(exact_force[i]), kForce * law.slip_force) << i;
  }
  const auto exact = ExactGradient(test.model, test.state, history, point);
  for (std::size_t column = 0; column < kGradientColumns; ++column) {
    const bool rigid = column == kPerLogSeriesStiffness;  // rig_test.cc has the others
    if (rigid || (column == kPerUnloadedDisplacement && test.state == InitialState::kSteady)) {
      for (std::size_t i = 0; i < history.size(); ++i) {
        EXPECT_EQ(gradient[i * kGradientColumns + column], 0.0) << "column " << column;
      }
      continue;
    }
    // ∂T/∂ln Tc is the difference T − ∂T/∂ln σ and has the digits of these.
    const Real largest = column == kPerLogSlipForce
                             ? std::max(Largest(exact[column]), Largest(exact_force))
                             : Largest(exact[column]);
    const bool holds_log = column == kPerShapeExponent && model.memory == Memory::kNone;
    const double bound = holds_log ? std::max(kGradient, kLogRemaining / test.size) : kGradient;
    for (std::size_t i = 0; i < history.size(); ++i) {
      const Real error = abs(Real(gradient[i * kGradientColumns + column]) - exact[column][i]);
      EXPECT_LE(static_cast<double>(error / largest), bound)
          << "column " << column << ", sample " << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(EveryModel, Gradient, ::testing::ValuesIn(Cases()), NameOf);

TEST(Gradient, IsFiniteOnTheCornersAndAtTheEndsOfTheRange) {
  // T = Tc exactly, no displacement at all, and 1e12 gross-slip displacements.
  for (const FrictionModel& model : FrictionModels()) {
    for (const double alpha : {0.0, 1e-300, 1e-16, 1.0 / 3.0, 0.5, 1.0, 2.0, 100.0, 1e100}) {
      for (const double size : {0.0, 1e-18, 1.0, 1.5, 2.0, 1e12, 1e300}) {
        const History history = {0.0, size, size, -size, 0.0, size / 2, -2 * size, 2 * size};
        // For α > 1 the force still grows beyond 1e200 elastic limits: refused (edges_test.cc).
        if (alpha > 1 && size > 1e200) continue;
        for (const InitialState state : {InitialState::kVirgin, InitialState::kSteady}) {
          std::vector<double> force(history.size());
          std::vector<double> gradient(history.size() * kGradientColumns);
          EvaluateForceAndGradient(model, {1.0, alpha, 1.0},
                                   PathOf(model, history, {.state = state}), history, force,
                                   gradient);
          for (std::size_t i = 0; i < history.size(); ++i) {
            EXPECT_TRUE(std::isfinite(force[i])) << model.name << ' ' << alpha << ' ' << size;
          }
          for (std::size_t i = 0; i < gradient.size(); ++i) {
            EXPECT_TRUE(std::isfinite(gradient[i]))
                << model.name << " alpha " << alpha << " size " << size << " row "
                << i / kGradientColumns << " column " << i % kGradientColumns;
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace mindahl::models::gradient_test
