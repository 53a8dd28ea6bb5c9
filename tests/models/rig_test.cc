// A spring in series with the contact: against the contact's own response taken as a parameter of
// the path, and against the laws as they are defined at 50 digits.

#include <boost/math/tools/toms748_solve.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <ostream>

#include "../../tools/reference/exact_history.h"
#include "../../tools/reference/force_and_gradient.h"
#include "../support/histories.h"
#include "../support/worst.h"
#include "mindahl/models/backbone.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/response.h"
#include "support/prelude.h"

namespace mindahl::models::rig_test {
namespace {

using Real = boost::multiprecision::cpp_bin_float_50;
using Law = reference::Law<Real>;

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

std::vector<double> RespondWithRig(const FrictionModel& model, const BranchLaw& law,
                                   const SeriesSpring& rig, const History& displacement,
                                   const InitialContact& initial = {}) {
  std::vector<double> force(displacement.size());
  EvaluateForce(model, law, PathOf(model, displacement, initial), displacement, force, rig);
  return force;
}

/// δ = x + T/k_r
History WithRig(const History& contact, const std::vector<double>& force, const SeriesSpring& rig) {
  History displacement(contact.size());
  for (std::size_t i = 0; i < contact.size(); ++i) {
    displacement[i] = contact[i] + force[i] / rig.stiffness;
  }
  return displacement;
}

/// Models that take a rig.
std::vector<FrictionModel> Models() {
  std::vector<FrictionModel> models;
  std::ranges::copy_if(FrictionModels(), std::back_inserter(models),
                       [](const FrictionModel& model) { return !model.scaled_by_peak; });
  return models;
}

// ---- The composed branch law ----------------------------------------------------------------

/// Φ by Newton's rule at 50 digits, from the answer to be checked; bisection where it leaves the
/// bracket. In ℓ = −log u, where the law is y = (1 − e^{−βℓ})/β, φ = 1 − e^{−ℓ}.
Real ExactShape(double alpha, double kappa, double total, double guess) {
  const Real beta = 1 - Real(alpha);
  if (beta > 0 && beta * total >= 1 + beta * kappa) return 1;
  const auto decay = [](const Real& rate, const Real& at) {
    return rate == 0 ? at : Real(-expm1(Real(-rate * at)) / rate);
  };
  Real low = 0;
  Real high = -1;  // none yet
  Real at = guess < 1 ? Real(-log1p(Real(-Real(guess)))) : Real(37);
  for (int i = 0; i < 200; ++i) {
    const Real contact = decay(beta, at);
    const Real spring = decay(1, at);
    const Real excess = contact + kappa * spring - total;
    (excess < 0 ? low : high) = at;
    Real next = at - excess / (1 - beta * contact + kappa * (1 - spring));
    if (!(next > low && (high < 0 || next < high))) {
      next = high < 0 ? Real(2 * at + 1) : Real((low + high) / 2);
    }
    const Real change = abs(Real(next - at));
    at = next;
    if (change <= Real("1e-30") * at) break;
  }
  return decay(1, at);
}

TEST(SeriesShape, IsAccurateForEveryShapeAndCompliance) {
  // backbone.h
  constexpr double kBound = 4.0;  // ε
  constexpr double kUseful = 0.5;
  Worst worst;
  for (const double alpha :
       {0.0,  1e-300,   1e-16, 1e-8,      1e-3,     0.03, 0.1, 1.0 / 3.0, 0.5,  0.7,  0.9,
        0.99, 1 - 1e-8, 1.0,   1 + 1e-15, 1 + 1e-8, 1.2,  2.0, 5.0,       30.0, 100.0}) {
    for (const double kappa : {0.0, 1e-300, 1e-18, 1e-5, 0.1, 0.3, 1.0, 3.0, 100.0, 1e7, 1e12}) {
      const backbone::InSeries<double> shape(alpha, kappa);
      const double beta = 1 - alpha;
      const double slip = beta > 0 ? 1 / beta + kappa : 1e6 * (1 + kappa);
      std::vector<double> totals = {slip, std::nextafter(slip, 0.0), 1e-280, 1e-100, 1e100, 1e199};
      for (double exponent = -36.7; exponent < 3; exponent += 3.1) {
        const double size = std::exp(exponent);
        for (const double total : {size, kappa * size, slip * (1 - size), slip - size, kappa + size,
                                   kappa - size, kappa + std::log(std::max(kappa, 1.0)) + size}) {
          if (total > 0) totals.push_back(total);
        }
      }
      for (const double total : totals) {
        const double force = shape.Force(total);
        const Real exact = ExactShape(alpha, kappa, total, force);
        worst.Add(static_cast<double>(abs(Real(force / exact - 1))) / kEpsilon, [&] {
          return "alpha " + std::to_string(alpha) + " kappa " + std::to_string(kappa) + " Y " +
                 std::to_string(total);
        });
      }
    }
  }
  EXPECT_LT(worst.value, kBound) << worst.where;
  EXPECT_GT(worst.value, kUseful) << "a bound that nothing comes near proves little";
}

// ---- Along histories ------------------------------------------------------------------------

TEST(Rig, LeavesTheForceThatTheContactHasAtItsOwnDisplacement) {
  // x drawn, T(x), δ = x + T/k_r, T(δ): both steps exact, nested and closed loops alike, as δ rises
  // and falls with x. Each side is within 5e-14·Tc (response.h); δ is rounded at most at
  // (|x| + Tc/k_r)·ε, which T follows with a slope below 2^α·σ and k_r: below 1e-14·Tc here.
  constexpr double kBound = 1.1e-13;
  Generator generator(62);
  Worst worst;
  for (const FrictionModel& model : Models()) {
    for (int i = 0; i < 3000; ++i) {
      const History contact = testing::RandomHistory(generator);
      const double alpha = i % 4 == 0 ? 1.0 / 3.0 : i % 7 == 0 ? 1.0 : Uniform(generator, 0, 2.5);
      const BranchLaw law{1.0, model.shape_exponent.value_or(alpha), 1.0};
      const SeriesSpring rig{LogUniform(generator, 1e-3, 1e3)};
      const InitialContact initial{.unloaded_displacement =
                                       i % 3 == 0 ? Uniform(generator, -1, 1) : 0.0};
      const std::vector<double> expected = Respond(model, law, contact, initial);
      const History displacement = WithRig(contact, expected, rig);
      const std::vector<double> force = RespondWithRig(model, law, rig, displacement, initial);
      for (std::size_t k = 0; k < force.size(); ++k) {
        ASSERT_LE(std::abs(force[k]), law.slip_force);
        worst.Add(std::abs(force[k] - expected[k]), [&] {
          return std::string(model.name) + " alpha " + std::to_string(law.shape_exponent) +
                 " spring " + std::to_string(rig.stiffness) + " sample " + std::to_string(k);
        });
      }
    }
  }
  EXPECT_LE(worst.value, kBound) << worst.where;
}

TEST(Rig, OfASteadyContactIsItself) {
  // A record that turns at both extremes first, off centre, and then has inner loops: the steady
  // amplitude of δ is that of x and T*/k_r together.
  constexpr double kBound = 1.1e-13;
  for (const FrictionModel& model : Models()) {
    for (const double alpha : {0.0, 1e-8, 1.0 / 3.0, 0.8, 1.0, 2.0}) {
      if (model.shape_exponent && alpha != *model.shape_exponent) continue;
      for (const double size : {1e-9, 0.05, 0.6, 1.4, 4.0}) {
        for (const double stiffness : {1e-6, 0.2, 1.0, 7.0, 1e6}) {
          for (const double sense : {1.0, -1.0}) {
            History contact;
            for (const double x :
                 {-0.4, 0.3, 1.0, 0.1, -1.0, 0.2, 0.7, 0.1, 0.5, -0.6, -0.9, 0.8}) {
              contact.push_back(sense * size * x + 0.3 * size);
            }
            const BranchLaw law{1.0, alpha, 1.0};
            const InitialContact steady{.state = InitialState::kSteady};
            const std::vector<double> expected = Respond(model, law, contact, steady);
            const SeriesSpring rig{stiffness};
            const std::vector<double> force =
                RespondWithRig(model, law, rig, WithRig(contact, expected, rig), steady);
            for (std::size_t i = 0; i < force.size(); ++i) {
              EXPECT_NEAR(force[i], expected[i], kBound * std::min(1.0, 10 * size))
                  << model.name << " alpha " << alpha << " size " << size << " spring " << stiffness
                  << " sample " << i;
            }
          }
        }
      }
    }
  }
}

TEST(Rig, ThatIsInfinitelyStiffIsNoneBitForBit) {
  Generator generator(64);
  for (const FrictionModel& model : FrictionModels()) {
    const History history = testing::RandomHistory(generator);
    const BranchLaw law{1.0, 0.4, 1.0};
    EXPECT_EQ(RespondWithRig(model, law, {}, history), Respond(model, law, history));
    // And a very stiff one is none to rounding: 5e-14·Tc of either.
    if (model.scaled_by_peak) continue;
    const auto stiff = RespondWithRig(model, law, {1e200}, history);
    const auto rigid = Respond(model, law, history);
    for (std::size_t i = 0; i < stiff.size(); ++i) EXPECT_NEAR(stiff[i], rigid[i], 1e-13);
  }
}

TEST(Rig, IsRefusedWhereItMeansNothing) {
  const History history = {0.0, 1.0};
  const BranchLaw law{1.0, 0.5, 1.0};
  for (const double stiffness : {0.0, -1.0, -std::numeric_limits<double>::infinity(),
                                 std::numeric_limits<double>::quiet_NaN(), 1e-101}) {
    EXPECT_THROW(RespondWithRig(Model("mindlin-dahl"), law, {stiffness}, history), InvalidArgument)
        << stiffness;
  }
  EXPECT_THROW(RespondWithRig(Model("simplified-dahl"), law, {1.0}, history), InvalidArgument);
  EXPECT_NO_THROW(RespondWithRig(Model("simplified-dahl"), law, {}, history));
  // Dahl's law is 2^α steeper from slip to slip.
  EXPECT_THROW(RespondWithRig(Model("dahl"), {1.0, 400.0, 1.0}, {1e-70}, {1e75, 9e74}),
               InvalidArgument);
}

// ---- Derivatives ----------------------------------------------------------------------------

struct Point {
  Real log_stiffness, exponent, log_slip_force, unloaded, log_spring;
};

/// The root of an increasing function.
Real Solve(const std::function<Real(const Real&)>& function, const Real& low, const Real& high) {
  std::uintmax_t iterations = 200;
  const auto close = [](const Real& a, const Real& b) {
    return abs(Real(b - a)) <= Real("1e-42") * std::max(Real(abs(a)), Real(abs(b)));
  };
  const auto [left, right] =
      boost::math::tools::toms748_solve(function, low, high, close, iterations);
  return (left + right) / 2;
}

/// T along δ: for every sample the x of the contact is found for which x + T(x)/k_r = δ.
std::vector<Real> ExactForces(const FrictionModel& model, InitialState state,
                              const History& history, const Point& point) {
  const Law law = {exp(point.log_stiffness), point.exponent, exp(point.log_slip_force)};
  const Real spring = exp(point.log_spring);
  const Real travel = law.slip_force / spring;
  const bool masing = model.memory == Memory::kReturnPoint;
  const auto [lowest, highest] = std::ranges::minmax(history);
  const bool steady = state == InitialState::kSteady;
  const Real origin = steady ? Real((Real(lowest) + Real(highest)) / 2) : point.unloaded;
  const Real amplitude = (Real(highest) - Real(lowest)) / 2;
  std::vector<Real> past;
  Real at = 0;
  Real force = 0;
  if (steady && masing) {
    const Real contact = Solve(
        [&](const Real& x) { return Real(x + reference::Backbone(law, x) / spring - amplitude); },
        0, amplitude);
    past = {contact, -contact};
  } else if (steady) {  // from the lower extreme, where the histories set out: −T* to T* over 2X
    const Real peak = Solve(
        [&](const Real& t) {
          const Real contact = std::max(Real(amplitude - t / spring), Real(0));
          return Real(t - reference::DahlStep(law, Real(-t), Real(2 * contact)));
        },
        0, law.slip_force);
    at = -amplitude + peak / spring;
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
    const Real x = Solve(
        [&](const Real& trial) { return Real(trial + force_at(trial) / spring - displacement); },
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
  for (const double x : {-0.31, 0.61, 0.61, 0.93, 0.11, 0.57, -0.49, -1.02, 0.03, 1.13, -0.23}) {
    history.push_back(size * (x + 0.06));
  }
  return history;
}

struct Case {
  std::string model;
  InitialState state;
  double shape_exponent;
  double size;       // of the history over the elastic limit
  double stiffness;  // of the spring over σ
};

std::string NameOf(const ::testing::TestParamInfo<Case>& info) {
  std::string name =
      info.param.model + (info.param.state == InitialState::kVirgin ? "_virgin" : "_steady");
  std::ranges::replace(name, '-', '_');
  return name + "_" + std::to_string(info.index);
}

std::vector<Case> Cases() {
  std::vector<Case> cases;
  for (const char* model : {"mindlin-dahl", "dahl"}) {
    for (const InitialState state : {InitialState::kVirgin, InitialState::kSteady}) {
      for (const double alpha : {0.0, 1e-8, 1.0 / 3.0, 1 - 1e-15, 1.0, 2.0, 20.0}) {
        for (const auto& [size, stiffness] :
             {std::pair{0.05, 0.3}, {0.9, 40.0}, {3.1, 1.0}, {17.0, 0.08}}) {
          cases.push_back({model, state, alpha, size, stiffness});
        }
      }
    }
  }
  return cases;
}

class RigGradient : public ::testing::TestWithParam<Case> {};

TEST_P(RigGradient, AgreesWithDifferencesOfTheExactLaws) {
  // As in gradient_test.cc: a dozen roundings a branch, amplified by a few dozen where a branch
  // starts near slip. Differences at 50 digits over 1e-16 are good to 1e-16, forward in α = 0.
  constexpr double kForce = 5e-14;     // of Tc
  constexpr double kGradient = 2e-13;  // of the column's largest entry
  constexpr double kLogRemaining = 4 * kEpsilon;
  const Case& test = GetParam();
  const BranchLaw law{4.839e8, test.shape_exponent, 30.0};
  const SeriesSpring rig{test.stiffness * law.tangential_stiffness};
  const History history = UpwardHistory(test.size * law.slip_force / law.tangential_stiffness);
  const FrictionModel& model = Model(test.model);
  std::vector<double> force(history.size());
  std::vector<double> gradient(history.size() * kGradientColumns);
  EvaluateForceAndGradient(model, law, PathOf(model, history, {.state = test.state}), history,
                           force, gradient, rig);

  const Point point = {log(Real(law.tangential_stiffness)), Real(law.shape_exponent),
                       log(Real(law.slip_force)), Real(0), log(Real(rig.stiffness))};
  const std::vector<Real> exact_force = ExactForces(model, test.state, history, point);
  for (std::size_t i = 0; i < history.size(); ++i) {
    EXPECT_NEAR(force[i], static_cast<double>(exact_force[i]), kForce * law.slip_force) << i;
  }
  const Real step("1e-16");
  const auto largest_of = [](const std::vector<Real>& values) {
    Real largest = 0;
    for (const Real& value : values) largest = std::max(largest, Real(abs(value)));
    return largest;
  };
  for (const auto& [column, member] : {std::pair{kPerLogStiffness, &Point::log_stiffness},
                                       {kPerShapeExponent, &Point::exponent},
                                       {kPerLogSlipForce, &Point::log_slip_force},
                                       {kPerUnloadedDisplacement, &Point::unloaded},
                                       {kPerLogSeriesStiffness, &Point::log_spring}}) {
    if (column == kPerUnloadedDisplacement && test.state == InitialState::kSteady) continue;
    const bool in_displacement = column == kPerUnloadedDisplacement;
    // δ₀ in units of the elastic limit, as the other parameters are of order 1.
    const Real change =
        in_displacement ? Real(step * law.slip_force / law.tangential_stiffness) : step;
    Point above = point;
    Point below = point;
    above.*member += change;
    if (below.*member > 0 || member != &Point::exponent) below.*member -= change;
    const std::vector<Real> high = ExactForces(model, test.state, history, above);
    const std::vector<Real> low = ExactForces(model, test.state, history, below);
    std::vector<Real> exact;
    for (std::size_t i = 0; i < high.size(); ++i) {
      exact.push_back((high[i] - low[i]) / (above.*member - below.*member));
    }
    // ∂T/∂ln Tc is a difference of T and others, and has the digits of these.
    const Real largest = column == kPerLogSlipForce
                             ? std::max(largest_of(exact), largest_of(exact_force))
                             : largest_of(exact);
    const bool holds_log = column == kPerShapeExponent && model.memory == Memory::kNone;
    const double bound = holds_log ? std::max(kGradient, kLogRemaining / test.size) : kGradient;
    for (std::size_t i = 0; i < history.size(); ++i) {
      const Real error = abs(Real(gradient[i * kGradientColumns + column]) - exact[i]);
      EXPECT_LE(static_cast<double>(error), bound * static_cast<double>(largest))
          << "column " << column << ", sample " << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(EveryModel, RigGradient, ::testing::ValuesIn(Cases()), NameOf);

}  // namespace
}  // namespace mindahl::models::rig_test
