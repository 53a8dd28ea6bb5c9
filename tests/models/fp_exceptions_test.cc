// No invalid operation, overflow or division by zero inside the models, over the whole box of
// docs/accuracy.md. Underflow and inexact are part of the answers.

#include <cfenv>

#include "../../tools/accuracy/measurements.h"
#include "../support/histories.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/contact_state.h"
#include "mindahl/models/response.h"
#include "mindahl/models/steady_loop.h"
#include "support/prelude.h"

namespace mindahl::models::fp_exceptions_test {
namespace {

constexpr int kTrapped = FE_INVALID | FE_OVERFLOW | FE_DIVBYZERO;

/// The flags that `call` raises, by name; empty when none.
template <typename Call>
std::string RaisedBy(Call call) {
  std::feclearexcept(kTrapped);
  call();
  const int raised = std::fetestexcept(kTrapped);
  std::string names;
  if ((raised & FE_INVALID) != 0) names += " invalid";
  if ((raised & FE_OVERFLOW) != 0) names += " overflow";
  if ((raised & FE_DIVBYZERO) != 0) names += " division by zero";
  return names;
}

/// The box, and beyond it no displacement, hardly any and all of it.
template <typename Visit>
void ForEveryPoint(Visit visit) {
  accuracy::ForEveryPoint(visit);
  for (const double alpha : {0.0, 1e-300, 1.0 / 3.0, 1.0, 2.0, 100.0}) {
    for (const double x : {0.0, 1e-300, 1e-18, 1.0, 1.5, 2.0, 1e12, 4e99}) {
      visit({1.0, alpha, 1.0}, x);
    }
  }
}

std::string Describe(const BranchLaw& law, double x) {
  return "alpha = " + std::to_string(law.shape_exponent) +
         ", y = " + std::to_string(law.tangential_stiffness * x / law.slip_force);
}

TEST(FloatingPointExceptions, ComeFromNoFunctionOfTheBranchLaw) {
  ForEveryPoint([](const BranchLaw& law, double x) {
    EXPECT_EQ(RaisedBy([&] {
                for (const double at : {x, -x, 0.0}) {
                  BackboneForce(law, at);
                  BackboneRemaining(law, at);
                }
                GrossSlipDisplacement(law);
              }),
              "")
        << Describe(law, x);
  });
}

TEST(FloatingPointExceptions, ComeFromNoSteadyLoop) {
  for (const FrictionModel& model : FrictionModels()) {
    ForEveryPoint([&](const BranchLaw& law, double x) {
      EXPECT_EQ(RaisedBy([&] {
                  SteadyPeakForce(model, law, x);
                  SteadyLoopEnergy(model, law, x);
                }),
                "")
          << model.name << ", " << Describe(law, x);
    });
  }
}

TEST(FloatingPointExceptions, ComeFromNoResponseItsGradientOrState) {
  for (const FrictionModel& model : FrictionModels()) {
    ForEveryPoint([&](const BranchLaw& law, double x) {
      const History history = {0.0, x / 2, x, x, -x, 0.0, std::nextafter(x, 0.0), x / 3, 2 * x, -x};
      std::vector<double> force(history.size());
      std::vector<double> gradient(history.size() * kGradientColumns);
      for (const InitialState state : {InitialState::kVirgin, InitialState::kSteady}) {
        const LoadingPath path = PathOf(model, history, {.state = state});
        EXPECT_EQ(RaisedBy([&] { EvaluateForce(model, law, path, history, force); }), "")
            << model.name << ", " << Describe(law, x);
        for (const double value : force) {
          ASSERT_LE(std::abs(value), law.slip_force) << model.name << ", " << Describe(law, x);
        }
        EXPECT_EQ(
            RaisedBy([&] { EvaluateForceAndGradient(model, law, path, history, force, gradient); }),
            "")
            << model.name << ", " << Describe(law, x);
        for (const double value : gradient) {
          ASSERT_TRUE(std::isfinite(value)) << model.name << ", " << Describe(law, x);
        }
      }
      EXPECT_EQ(RaisedBy([&] {
                  ContactState contact(model, law);
                  for (const double displacement : history) {
                    contact.Move(displacement);
                    ASSERT_GE(contact.TangentStiffness(), 0);
                  }
                }),
                "")
          << model.name << ", " << Describe(law, x);
    });
  }
}

}  // namespace
}  // namespace mindahl::models::fp_exceptions_test
