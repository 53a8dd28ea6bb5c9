// A spring in series with the contact: against the contact's own response taken as a parameter of
// the path.

#include <boost/multiprecision/cpp_bin_float.hpp>

#include "../support/histories.h"
#include "../support/worst.h"
#include "mindahl/models/backbone.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/response.h"
#include "support/prelude.h"

namespace mindahl::models::rig_test {
namespace {

using Real = boost::multiprecision::cpp_bin_float_50;

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// δ = x + T/k_r
History WithRig(const History& contact, const std::vector<double>& force, const SeriesSpring& rig) {
  History displacement(contact.size());
  for (std::size_t i = 0; i < contact.size(); ++i) {
    displacement[i] = contact[i] + force[i] / rig.stiffness;
  }
  return displacement;
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
      const backbone::InSeries shape(alpha, kappa);
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
  for (const FrictionModel& model : FrictionModels()) {
    for (int i = 0; i < 3000; ++i) {
      const History contact = testing::RandomHistory(generator);
      const double alpha = i % 4 == 0 ? 1.0 / 3.0 : i % 7 == 0 ? 1.0 : Uniform(generator, 0, 2.5);
      const BranchLaw law{1.0, model.shape_exponent.value_or(alpha), 1.0};
      const SeriesSpring rig{LogUniform(generator, 1e-3, 1e3)};
      const InitialContact initial{.unloaded_displacement =
                                       i % 3 == 0 ? Uniform(generator, -1, 1) : 0.0};
      const std::vector<double> expected = Respond(model, law, contact, initial);
      const History displacement = WithRig(contact, expected, rig);
      const std::vector<double> force = Respond(model, law, displacement, initial, rig);
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

TEST(Rig, ThatIsInfinitelyStiffIsNoneBitForBit) {
  Generator generator(64);
  for (const FrictionModel& model : FrictionModels()) {
    const History history = testing::RandomHistory(generator);
    const BranchLaw law{1.0, 0.4, 1.0};
    EXPECT_EQ(Respond(model, law, history, {}, {}), Respond(model, law, history));
    // And a very stiff one is none to rounding: 5e-14·Tc of either.
    const auto stiff = Respond(model, law, history, {}, {1e200});
    const auto rigid = Respond(model, law, history);
    for (std::size_t i = 0; i < stiff.size(); ++i) EXPECT_NEAR(stiff[i], rigid[i], 1e-13);
  }
}

TEST(Rig, IsRefusedWhereItMeansNothing) {
  const History history = {0.0, 1.0};
  const BranchLaw law{1.0, 0.5, 1.0};
  for (const double stiffness : {0.0, -1.0, -std::numeric_limits<double>::infinity(),
                                 std::numeric_limits<double>::quiet_NaN(), 1e-101}) {
    EXPECT_THROW(Respond(Model("mindlin-dahl"), law, history, {}, {stiffness}), InvalidArgument)
        << stiffness;
  }
  // Dahl's law is 2^α steeper from slip to slip.
  EXPECT_THROW(Respond(Model("dahl"), {1.0, 100.0, 1.0}, {{1e85, 9e84}}, {}, {1e-80}),
               InvalidArgument);
}

}  // namespace
}  // namespace mindahl::models::rig_test
