#include <algorithm>
#include <cmath>
#include <numbers>

#include "kind.h"
#include "mindahl/models/contact_state.h"
#include "mindahl/models/friction_model.h"
#include "simulation.h"

/// What a test rig adds to the contact's force or displacement.
namespace mindahl::reliability {
namespace {

using loop::Record;

double Sign(double value) { return value < 0 ? -1.0 : 1.0; }

Loop SeriesSpring(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Ideal(truth, draws);
  const double stiffness = At(level, {20, 3, 0.7}) * truth.law.tangential_stiffness;
  for (std::size_t i = 0; i < record.size(); ++i) {
    record.displacement[i] += record.force[i] / stiffness;
  }
  AddNoise(record, truth, draws);
  const double apparent = 1 / (1 / truth.law.tangential_stiffness + 1 / stiffness);
  return {record, StiffnessAndSlipForce(apparent, truth.law.slip_force)};
}

/// A rig whose compliance falls with the force, as of joints that close: 1/k at no force, half of
/// it at Tc.
Loop HardeningRig(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Ideal(truth, draws);
  const double stiffness = At(level, {20, 3, 0.7}) * truth.law.tangential_stiffness;
  for (std::size_t i = 0; i < record.size(); ++i) {
    const double carried = std::abs(record.force[i]) / truth.law.slip_force;
    record.displacement[i] += record.force[i] / (stiffness * (1 + carried));
  }
  AddNoise(record, truth, draws);
  Expected expected = StiffnessAndSlipForce(truth.law.tangential_stiffness, truth.law.slip_force);
  expected.sigma->lowest = 1 / (1 / truth.law.tangential_stiffness + 1 / stiffness);
  return {record, expected};
}

/// A drive that pushes the contact by either face of a gap.
class LooseDrive {
 public:
  LooseDrive(const models::BranchLaw& law, double gap)
      : contact_(*models::FindFrictionModel("mindlin-dahl"), law), half_gap_(gap / 2) {}

  double Move(double drive) {
    const double face = Sign(drive - contact_.Displacement());
    const double pushed = drive - face * half_gap_;
    const bool touches = face * (pushed - contact_.Displacement()) >= 0;
    if (touches) return contact_.Move(pushed);
    // The face draws back, and the contact follows as far as its own force takes it.
    if (face * contact_.Force() <= 0) return 0.0;
    if (face * contact_.Peek(pushed) > 0) return contact_.Move(pushed);
    double inside = contact_.Displacement();
    double outside = pushed;
    for (int i = 0; i < 60; ++i) {
      const double middle = inside + (outside - inside) / 2;
      (face * contact_.Peek(middle) > 0 ? inside : outside) = middle;
    }
    contact_.Move(outside);
    return 0.0;
  }

 private:
  models::ContactState contact_;
  double half_gap_;
};

Loop Backlash(const Truth& truth, std::size_t level, Draws& draws) {
  const double gap = At(level, {0.01, 0.05, 0.20}) * Amplitude(truth);
  Record record =
      Drive(Sine(truth, draws), [&](std::span<const double> displacement, std::span<double> force) {
        LooseDrive drive(truth.law, gap);
        for (std::size_t i = 0; i < force.size(); ++i) {
          force[i] = drive.Move(displacement[i]);
        }
      });
  AddNoise(record, truth, draws);
  return {record, AllOf(truth.law)};
}

/// Joints that slip: part of the rig's travel follows the force by a play.
Loop RigWithHysteresis(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Ideal(truth, draws);
  const double compliance = At(level, {0.05, 0.20, 0.80}) / truth.law.tangential_stiffness;
  const double play = 0.3 * truth.law.slip_force;
  double followed = record.force.front();
  for (std::size_t i = 0; i < record.size(); ++i) {
    followed = std::clamp(followed, record.force[i] - play, record.force[i] + play);
    record.displacement[i] += compliance * (record.force[i] + followed) / 2;
  }
  AddNoise(record, truth, draws);
  const double stiffest = 1 / (1 / truth.law.tangential_stiffness + compliance / 2);
  const double softest = 1 / (1 / truth.law.tangential_stiffness + compliance);
  return {record,
          {.sigma = Range{softest, stiffest},
           .slip_force = Range{truth.law.slip_force, truth.law.slip_force}}};
}

/// m·a of a sine, which is a spring below zero in parallel.
Loop Inertia(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Measured(truth, draws);
  for (std::size_t i = 0; i < record.size(); ++i) {
    record.force[i] -= At(level, {0.02, 0.10, 0.40}) * truth.law.slip_force *
                       record.displacement[i] / Amplitude(truth);
  }
  return {record, AllOf(truth.law)};
}

Loop ViscousForce(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Measured(truth, draws);
  const std::vector<double> velocity = Velocity(record);
  for (std::size_t i = 0; i < record.size(); ++i) {
    record.force[i] += At(level, {0.02, 0.10, 0.40}) * truth.law.slip_force * velocity[i];
  }
  return {record, AllOf(truth.law)};
}

/// Each slip lets go of a part of the force, which the spring of the contact builds up again.
Loop StickSlip(const Truth& truth, std::size_t level, Draws& draws) {
  constexpr double kSliding = 0.95;
  Record record = Ideal(truth, draws);
  const double drop = At(level, {0.03, 0.10, 0.30});
  const double period =
      draws.Uniform(1.5, 4.0) * drop * truth.law.slip_force / truth.law.tangential_stiffness;
  for (std::size_t i = 0; i < record.size(); ++i) {
    if (std::abs(record.force[i]) < kSliding * truth.law.slip_force) continue;
    const double cycles = record.displacement[i] / period;
    const double tooth = Sign(record.force[i]) * (cycles - std::floor(cycles) - 0.5);
    record.force[i] += drop * truth.law.slip_force * tooth * Sign(record.force[i]);
  }
  AddNoise(record, truth, draws);
  return {record, StiffnessAndSlipForce(truth.law.tangential_stiffness, truth.law.slip_force)};
}

Loop ParallelSpring(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Measured(truth, draws);
  for (std::size_t i = 0; i < record.size(); ++i) {
    record.force[i] += At(level, {0.02, 0.10, 0.40}) * truth.law.slip_force *
                       record.displacement[i] / Amplitude(truth);
  }
  return {record, AllOf(truth.law)};
}

Loop UnequalDirections(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Ideal(truth, draws);
  const double asymmetry = At(level, {0.02, 0.10, 0.40});
  for (double& force : record.force) force *= 1 + asymmetry * Sign(force);
  AddNoise(record, truth, draws);
  return {record, StiffnessAndSlipForce(truth.law.tangential_stiffness, truth.law.slip_force)};
}

/// Coulomb's friction in parallel, stiff: the load cell cannot tell it from the contact's.
Loop GuideFriction(const Truth& truth, std::size_t level, Draws& draws) {
  constexpr double kSmallest = 1e-3;  // of the largest velocity
  Record record = Measured(truth, draws);
  const double friction = At(level, {0.02, 0.10, 0.30}) * truth.law.slip_force;
  const std::vector<double> velocity = Velocity(record);
  for (std::size_t i = 0; i < record.size(); ++i) {
    record.force[i] += friction * std::clamp(velocity[i] / kSmallest, -1.0, 1.0);
  }
  Expected expected = AllOf(truth.law);
  expected.slip_force = Range{truth.law.slip_force + friction, truth.law.slip_force + friction};
  return {record, expected};
}

/// The rig rings after each turn, some periods a stroke.
Loop Ringing(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Measured(truth, draws);
  const auto stroke = static_cast<double>(truth.samples_per_cycle) / 2;
  const double periods = draws.Uniform(4.0, 12.0);
  const double decay = draws.Uniform(4.0, 12.0);
  const std::vector<std::size_t> turns = Turns(record);
  for (std::size_t k = 0; k < turns.size(); ++k) {
    const std::size_t end = k + 1 < turns.size() ? turns[k + 1] : record.size();
    const double height = At(level, {0.01, 0.04, 0.15}) * truth.law.slip_force *
                          Sign(record.displacement[end - 1] - record.displacement[turns[k]]);
    for (std::size_t i = turns[k]; i < end; ++i) {
      const double way = static_cast<double>(i - turns[k]) / stroke;
      record.force[i] +=
          height * std::exp(-decay * way) * std::sin(2 * std::numbers::pi * periods * way);
    }
  }
  return {record, AllOf(truth.law)};
}

}  // namespace

std::vector<Kind> RigKinds() {
  return {
      {"rig in series", Half::kDevelopment, SeriesSpring,
       "a spring of 20, 3, 0.7 sigma; asked are the stiffness of both and Tc"},
      {"hardening rig", Half::kHeldOut, HardeningRig,
       "a spring of 20, 3, 0.7 sigma that doubles up to Tc; sigma may be with or without it",
       false},
      {"backlash", Half::kHeldOut, Backlash, "a gap of 1, 5, 20 % of X"},
      {"rig with hysteresis", Half::kDevelopment, RigWithHysteresis,
       "in series, compliance 5, 20, 80 % of the contact's; asked are the stiffness of both and "
       "Tc"},
      {"inertia", Half::kHeldOut, Inertia, "m a of 2, 10, 40 % of Tc"},
      {"viscous force", Half::kDevelopment, ViscousForce, "up to 2, 10, 40 % of Tc"},
      {"stick-slip", Half::kHeldOut, StickSlip,
       "a sawtooth of 3, 10, 30 % of Tc about the plateau; asked are sigma and the mean plateau"},
      {"tilted plateau", Half::kDevelopment, ParallelSpring,
       "a parallel spring, 2, 10, 40 % of Tc"},
      {"unequal directions", Half::kHeldOut, UnequalDirections,
       "forces 2, 10, 40 % larger one way, smaller the other; asked are sigma and the mean Tc"},
      {"friction in the guide", Half::kDevelopment, GuideFriction,
       "Coulomb's, 2, 10, 30 % of Tc; asked is the sum for Tc"},
      {"ringing after each turn", Half::kHeldOut, Ringing, "1, 4, 15 % of Tc"},
  };
}

}  // namespace mindahl::reliability
