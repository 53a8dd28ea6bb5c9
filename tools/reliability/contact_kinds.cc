#include <algorithm>
#include <cmath>
#include <utility>

#include "kind.h"
#include "mindahl/loop/reversals.h"
#include "mindahl/methods/iwan.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/loading_path.h"
#include "mindahl/models/response.h"
#include "simulation.h"

/// Contacts that are not the law which is fitted.
namespace mindahl::reliability {
namespace {

using loop::Record;
using models::BranchLaw;

Loop DahlsOwnLaw(const Truth& truth, std::size_t level, Draws& draws) {
  Truth driven = truth;
  driven.reach = At(level, {3.0, 1.5, 1.0});
  Record record = Drive(
      Sine(driven, draws), [&](std::span<const double> displacement, std::span<double> force) {
        const models::FrictionModel& model = *models::FindFrictionModel("dahl");
        const models::LoadingPath path = models::MakeLoadingPath(
            displacement, loop::FindReversals(displacement, 0.0), model.memory, {});
        models::EvaluateForce(model, truth.law, path, displacement, force);
      });
  AddNoise(record, truth, draws);
  Expected expected = AllOf(truth.law);
  expected.sigma->highest *= std::pow(2.0, truth.law.shape_exponent);
  return {record, expected};
}

/// Segalman's four parameters: slip displacements with the density φ^χ up to the largest, at which
/// a share β of the force lets go at once.
Loop PowerLawSpectrum(const Truth& truth, std::size_t level, Draws& draws) {
  constexpr std::size_t kElements = 200;
  const double exponent = At(level, {-0.2, -0.5, -0.8});
  const double at_once = draws.Uniform(0.0, 2.0);
  const double largest = SlipDisplacement(truth.law);
  methods::IwanElements elements;
  double force = 0.0;
  for (std::size_t i = 0; i < kElements; ++i) {
    // Of equal stiffness: φ at equal steps of the distribution.
    const double share = (static_cast<double>(i) + 0.5) / kElements;
    elements.stiffness.push_back(1.0 / kElements);
    elements.slip_force.push_back(largest * std::pow(share, 1 / (exponent + 1)) / kElements);
    force += elements.slip_force.back();
  }
  elements.stiffness.push_back(at_once * force / largest);
  elements.slip_force.push_back(at_once * force);
  const double scale = truth.law.slip_force / ((1 + at_once) * force);
  double sigma = 0.0;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    elements.stiffness[i] *= scale;
    elements.slip_force[i] *= scale;
    sigma += elements.stiffness[i];
  }
  Record record = Drive(Sine(truth, draws),
                        [&](std::span<const double> displacement, std::span<double> forces) {
                          methods::EvaluateIwanForce(elements, displacement, forces);
                        });
  AddNoise(record, truth, draws);
  return {record, StiffnessAndSlipForce(sigma, truth.law.slip_force)};
}

/// Branches that begin softer than they go on: a spring that hardens over a third of the way to
/// slip in series with the contact's elements.
Loop HardeningBranch(const Truth& truth, std::size_t level, Draws& draws) {
  const double softer = At(level, {0.05, 0.2, 0.5});
  const double length = SlipDisplacement(truth.law) / 3;
  Record record =
      Drive(Sine(truth, draws), [&](std::span<const double> displacement, std::span<double> force) {
        // A turn at every reversal: the contact follows the way that the spring leaves it.
        std::vector<double> moved(displacement.size(), displacement.front());
        double from = displacement.front();
        double carried = 0.0;
        double direction = 0.0;
        double base = displacement.front();
        for (std::size_t i = 1; i < displacement.size(); ++i) {
          const double step = displacement[i] - displacement[i - 1];
          if (step * direction < 0 || (direction == 0 && step != 0)) {
            direction = step < 0 ? -1.0 : 1.0;
            from = displacement[i - 1];
            base = moved[i - 1];
          }
          const double travel = std::abs(displacement[i] - from);
          carried = travel - softer * length * (1 - std::exp(-travel / length));
          moved[i] = base + direction * carried;
        }
        Masing(truth.law)(moved, force);
      });
  AddNoise(record, truth, draws);
  Expected expected = StiffnessAndSlipForce(truth.law.tangential_stiffness, truth.law.slip_force);
  expected.sigma->lowest *= 1 - softer;
  return {record, expected};
}

Loop SixtyAsperities(const Truth& truth, std::size_t level, Draws& draws) {
  constexpr std::size_t kAsperities = 60;
  const double spread = At(level, {0.2, 0.5, 1.0});
  std::vector<BranchLaw> laws;
  double sigma = 0.0;
  double slip_force = 0.0;
  for (std::size_t i = 0; i < kAsperities; ++i) {
    laws.push_back(
        {truth.law.tangential_stiffness * std::exp(spread * draws.Normal()) / kAsperities,
         truth.law.shape_exponent,
         truth.law.slip_force * std::exp(spread * draws.Normal()) / kAsperities});
    sigma += laws.back().tangential_stiffness;
    slip_force += laws.back().slip_force;
  }
  Record record =
      Drive(Sine(truth, draws), [&](std::span<const double> displacement, std::span<double> force) {
        std::vector<double> one(force.size());
        for (const BranchLaw& law : laws) {
          Masing(law)(displacement, one);
          for (std::size_t i = 0; i < one.size(); ++i) force[i] += one[i];
        }
      });
  AddNoise(record, truth, draws);
  return {record, StiffnessAndSlipForce(sigma, slip_force)};
}

Loop VelocityWeakening(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Ideal(truth, draws);
  const double weakening = At(level, {0.03, 0.10, 0.30});
  const double scale = draws.Uniform(0.1, 0.6);  // of the largest velocity
  const std::vector<double> velocity = Velocity(record);
  for (std::size_t i = 0; i < record.size(); ++i) {
    record.force[i] *= 1 + weakening * std::expm1(-std::abs(velocity[i]) / scale);
  }
  AddNoise(record, truth, draws);
  Expected expected = StiffnessAndSlipForce(truth.law.tangential_stiffness, truth.law.slip_force);
  expected.slip_force->lowest *= 1 - weakening;
  return {record, expected};
}

/// From one contact to another of a larger Tc, as `share` goes from 0 to 1.
template <typename Share>
Record Changing(const Truth& truth, const Motion& motion, double growth, Share share) {
  BranchLaw last = truth.law;
  last.slip_force *= 1 + growth;
  const Record before = Drive(motion, Masing(truth.law));
  const Record after = Drive(motion, Masing(last));
  Record record = before;
  for (std::size_t i = 0; i < record.size(); ++i) {
    const double weight = share(record, i);
    record.force[i] = (1 - weight) * before.force[i] + weight * after.force[i];
  }
  return record;
}

Loop RunningIn(const Truth& truth, std::size_t level, Draws& draws) {
  const double growth = At(level, {0.02, 0.10, 0.40});
  Truth longer = truth;
  longer.cycles = std::max<std::size_t>(truth.cycles, 3);
  Record record = Changing(longer, Sine(longer, draws), growth, Progress);
  AddNoise(record, truth, draws);
  Expected expected = AllOf(truth.law);
  expected.slip_force->highest *= 1 + growth;
  return {record, expected};
}

Loop GrowsWithAmplitude(const Truth& truth, std::size_t level, Draws& draws) {
  constexpr double kSpread = 4.0;
  const double growth = At(level, {0.02, 0.10, 0.40});
  Truth longer = truth;
  longer.cycles = std::max<std::size_t>(truth.cycles, 3);
  longer.reach = std::max(truth.reach, 2.0);
  const Motion motion = Wave(longer, {.waveform = models::Waveform::kGrowingSine,
                                      .cycles = static_cast<double>(longer.cycles),
                                      .growth = kSpread});
  Record record = Changing(longer, motion, growth, [](const Record& of, std::size_t row) {
    return std::pow(kSpread, Progress(of, row) - 1);
  });
  AddNoise(record, truth, draws);
  Expected expected = AllOf(truth.law);
  expected.slip_force->highest *= 1 + growth;
  return {record, expected};
}

/// Beyond a displacement the surfaces part, and nothing is carried.
Loop ContactLostOnOneSide(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Ideal(truth, draws);
  const double limit = (1 - 2 * At(level, {0.05, 0.20, 0.50})) * Amplitude(truth);
  for (std::size_t i = 0; i < record.size(); ++i) {
    if (record.displacement[i] > limit) record.force[i] = 0.0;
  }
  AddNoise(record, truth, draws);
  return {record, AllOf(truth.law)};
}

/// Static above kinetic friction: a peak where sliding begins, gone after a part of the stroke.
Loop AdhesionPeak(const Truth& truth, std::size_t level, Draws& draws) {
  constexpr double kSliding = 0.9;
  Record record = Ideal(truth, draws);
  const double peak = At(level, {0.03, 0.10, 0.40});
  const double decay = draws.Uniform(0.05, 0.3) * Amplitude(truth);
  double slid = 0.0;
  for (std::size_t i = 1; i < record.size(); ++i) {
    const double share = std::abs(record.force[i]) / truth.law.slip_force;
    if (share < kSliding) {
      slid = 0.0;
      continue;
    }
    const double grown = (share - kSliding) / (1 - kSliding);  // for no jump at its foot
    slid += std::abs(record.displacement[i] - record.displacement[i - 1]);
    record.force[i] *= 1 + peak * grown * std::exp(-slid / decay);
  }
  AddNoise(record, truth, draws);
  Expected expected = StiffnessAndSlipForce(truth.law.tangential_stiffness, truth.law.slip_force);
  expected.slip_force->highest *= 1 + peak;
  return {record, expected};
}

}  // namespace

std::vector<Kind> ContactKinds() {
  return {
      {"Dahl's own law", Half::kHeldOut, DahlsOwnLaw,
       "reach 3, 1.5, 1; sigma may be that of the virgin contact or of a reversal"},
      {"power-law spectrum", Half::kDevelopment, PowerLawSpectrum,
       "Segalman's four parameters, exponent -0.2, -0.5, -0.8; asked are sigma and Tc"},
      {"hardening branch", Half::kHeldOut, HardeningBranch,
       "stiffness 5, 20, 50 % lower after each reversal; sigma may be either", false},
      {"sixty asperities", Half::kHeldOut, SixtyAsperities,
       "log-normal sigma and Tc, spread 0.2, 0.5, 1; asked are their sums"},
      {"friction falls with velocity", Half::kDevelopment, VelocityWeakening,
       "by 3, 10, 30 %; asked are sigma and any Tc between"},
      {"running-in", Half::kHeldOut, RunningIn,
       "Tc grows by 2, 10, 40 % over the record; it may be any between"},
      {"Tc grows with the amplitude", Half::kDevelopment, GrowsWithAmplitude,
       "by up to 2, 10, 40 % over a growing sine; it may be any between"},
      {"contact lost on one side", Half::kHeldOut, ContactLostOnOneSide,
       "over 5, 20, 50 % of the stroke"},
      {"adhesion peak", Half::kDevelopment, AdhesionPeak,
       "3, 10, 40 % above the plateau; asked are sigma and any Tc between"},
  };
}

}  // namespace mindahl::reliability
