// A mass that is thrown along a contact and held by a spring, until friction has brought it to
// rest: the contact moved step by step in a time-stepping loop. Prints displacement, force and
// energies of Mindlin's contact and of Dahl's own law, and fails where the energies do not add up.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "mindahl/models/branch_law.h"
#include "mindahl/models/contact_state.h"
#include "mindahl/models/friction_model.h"

namespace {

using namespace mindahl;
using namespace mindahl::models;

// A steel ball of 50 mm radius on a steel plane under 50 N.
constexpr BranchLaw kLaw{
    .tangential_stiffness = 4.8e7, .shape_exponent = 1.0 / 3, .slip_force = 15.0};
constexpr double kMass = 0.1;              // [kg]
constexpr double kSpringStiffness = 5e6;   // [N/m]
constexpr double kInitialVelocity = 0.03;  // [m/s], beyond gross slip
constexpr double kTimeStep = 1e-7;         // [s]
constexpr int kSteps = 40'000;
constexpr int kStepsPerRow = 2'000;

/// Largest error of the energy balance over the initial energy.
double Vibrate(const FrictionModel& model) {
  std::printf("%.*s\n%12s %14s %10s %12s %12s %12s %10s\n", static_cast<int>(model.title.size()),
              model.title.data(), "time [s]", "displ. [m]", "force [N]", "kinetic [J]",
              "spring [J]", "contact [J]", "sum/initial");
  ContactState contact(model, kLaw);
  const double initial_energy = kMass * kInitialVelocity * kInitialVelocity / 2;
  double displacement = 0.0;
  double velocity = kInitialVelocity;
  double acceleration = 0.0;
  double taken_up = 0.0;  // work [J] that is lost, but for what is still stored
  double worst = 0.0;
  for (int step = 1; step <= kSteps; ++step) {  // velocity Verlet
    const double travel = kTimeStep * (velocity + kTimeStep / 2 * acceleration);
    const double before = contact.Force();
    displacement += travel;
    const double force = contact.Move(displacement);
    taken_up += travel * (before + force) / 2;
    const double next = -(kSpringStiffness * displacement + force) / kMass;
    velocity += kTimeStep / 2 * (acceleration + next);
    acceleration = next;

    const double kinetic = kMass * velocity * velocity / 2;
    const double spring = kSpringStiffness * displacement * displacement / 2;
    const double balance = (kinetic + spring + taken_up) / initial_energy;
    worst = std::max(worst, std::abs(balance - 1));
    if (step % kStepsPerRow == 0) {
      std::printf("%12.4g %14.5g %10.5g %12.4g %12.4g %12.4g %10.7f\n", step * kTimeStep,
                  displacement, force, kinetic, spring, taken_up, balance);
    }
  }
  return worst;
}

}  // namespace

int main() {
  // Of the initial energy: (ωΔt)², ω² = (k + 2^α·σ)/m, as the integrator is of second order.
  const double tolerance =
      (kSpringStiffness + std::exp2(kLaw.shape_exponent) * kLaw.tangential_stiffness) / kMass *
      kTimeStep * kTimeStep;
  bool balanced = true;
  for (const char* name : {"mindlin", "dahl"}) {
    const double error = Vibrate(*FindFrictionModel(name));
    std::printf("energies add up within %.2g of the initial, tolerance %.2g\n\n", error, tolerance);
    balanced = balanced && error <= tolerance;
  }
  return balanced ? 0 : 1;
}
