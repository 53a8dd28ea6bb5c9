#include "identification/cycle_energy.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mindahl/models/loading_path.h"

namespace mindahl::identification {

std::vector<double> EnergyOfCycles(const models::FrictionModel& model, const models::BranchLaw& law,
                                   const models::SeriesSpring& rig,
                                   const AsymmetricCycles& cycles) {
  constexpr std::size_t kSteps = 1000;       // a stroke
  constexpr std::size_t kSettledCycles = 3;  // cycles, from where on one is like the other
  const std::size_t count = std::min(cycles.cycles, kSettledCycles);
  std::vector<double> displacement = {0.0};
  std::vector<std::size_t> reversals;
  const double first = cycles.first_direction * cycles.amplitude;
  displacement.push_back(first);
  for (std::size_t stroke = 0; stroke < 2 * count; ++stroke) {
    reversals.push_back(displacement.size() - 1);
    const double from = stroke % 2 == 0 ? first : -first;
    for (std::size_t i = 1; i <= kSteps; ++i) {
      const double phase = std::numbers::pi * static_cast<double>(i) / kSteps;
      displacement.push_back(from * std::cos(phase));
    }
  }
  const models::LoadingPath path = models::MakeLoadingPath(
      displacement, reversals, model.memory,
      {.state = models::InitialState::kVirgin, .asymmetry = cycles.asymmetry});
  std::vector<double> force(displacement.size());
  models::EvaluateForce(model, law, path, displacement, force, rig);
  std::vector<double> energies;
  for (std::size_t cycle = 0; cycle < count; ++cycle) {
    double energy = 0.0;
    const std::size_t begin = reversals[2 * cycle];
    for (std::size_t i = begin; i < begin + 2 * kSteps; ++i) {
      energy += (force[i] + force[i + 1]) / 2 * (displacement[i + 1] - displacement[i]);
    }
    energies.push_back(energy);
  }
  energies.resize(cycles.cycles, energies.back());
  return energies;
}

}  // namespace mindahl::identification
