#include "identification/cycle_energy.h"

#include <algorithm>

#include "mindahl/loop/cycles.h"
#include "mindahl/loop/reversals.h"
#include "mindahl/models/excitation.h"
#include "mindahl/models/loading_path.h"

namespace mindahl::identification {

std::vector<double> EnergyOfCycles(const models::FrictionModel& model, const models::BranchLaw& law,
                                   const models::SeriesSpring& rig,
                                   const AsymmetricCycles& cycles) {
  constexpr std::size_t kSamplesPerCycle = 2000;
  constexpr std::size_t kSettledCycles = 3;  // cycles, from where on one is like the other
  if (!(cycles.amplitude > 0)) return std::vector<double>(cycles.cycles, 0.0);
  const std::size_t count = std::min(cycles.cycles, kSettledCycles);
  std::vector<double> displacement =
      models::MakeExcitation({.amplitude = cycles.amplitude,
                              .cycles = static_cast<double>(count) + 0.25,
                              .samples_per_cycle = kSamplesPerCycle})
          .displacement;
  for (double& x : displacement) x *= cycles.first_direction;
  const std::vector<std::size_t> reversals = loop::FindReversals(displacement, 0.0);
  const models::LoadingPath path = models::MakeLoadingPath(
      displacement, reversals, model.memory,
      {.state = models::InitialState::kVirgin, .asymmetry = cycles.asymmetry});
  std::vector<double> force(displacement.size());
  models::EvaluateForce(model, law, path, displacement, force, rig);
  std::vector<double> energies =
      loop::CycleEnergies(loop::RecordView(displacement, force), reversals);
  energies.resize(cycles.cycles, energies.back());
  return energies;
}

}  // namespace mindahl::identification
