#include "responses.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "mindahl/contact/mindlin_dahl_mapping.h"
#include "mindahl/loop/reversals.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/loading_path.h"
#include "mindahl/models/response.h"
#include "mindahl/models/simplified_law.h"

namespace mindahl::paper {

using models::BranchLaw;
using models::Excitation;
using models::FrictionModel;
using models::LoadingPath;

namespace {

const FrictionModel& Model(const char* name) { return *models::FindFrictionModel(name); }

std::vector<double> Evaluate(const FrictionModel& model, const BranchLaw& law,
                             const LoadingPath& path, const std::vector<double>& displacement) {
  std::vector<double> force(displacement.size());
  models::EvaluateForce(model, law, path, displacement, force);
  return force;
}

std::size_t FirstReversal(const std::vector<double>& displacement) {
  return loop::FindReversals(displacement, 0.0).front();
}

/// The virgin curve for so many samples, then eq. 27 step by step, at the T* of Mindlin's loop.
std::vector<double> SteadyBranches(const BranchLaw& law, const Excitation& excitation,
                                   std::size_t virgin) {
  std::vector<double> force;
  double last = 0.0;
  for (std::size_t i = 0; i < excitation.displacement.size(); ++i) {
    const double at = excitation.displacement[i];
    const double peak = contact::MindlinVirginForce(kContact, excitation.envelope[i]);
    force.push_back(
        i < virgin ? BackboneForce(law, at)
                   : models::SimplifiedDahlStep(law, peak, i > 0 ? force[i - 1] : 0.0, at - last));
    last = at;
  }
  return force;
}

/// Mindlin's loop between ±amplitude, on the branch that runs in the direction of `step`.
double LoopForce(double displacement, double amplitude, double step) {
  return step < 0 ? contact::MindlinUnloadingForce(kContact, displacement, amplitude)
                  : contact::MindlinReloadingForce(kContact, displacement, amplitude);
}

}  // namespace

BranchLaw ExactLaw() { return contact::MapMindlinToDahl(kContact); }

BranchLaw PrintedLaw() {
  return {kPrintedStiffness, contact::kMindlinShapeExponent, kContact.slip_force};
}

Excitation Sine(double lambda, double cycles) {
  return models::MakeExcitation({.amplitude = lambda * GrossSlipDisplacement(kContact),
                                 .cycles = cycles,
                                 .samples_per_cycle = kSamplesPerCycle});
}

Excitation GrowingSine(std::size_t samples_per_cycle) {
  return models::MakeExcitation({.waveform = models::Waveform::kGrowingSine,
                                 .amplitude = kLastEnvelope * GrossSlipDisplacement(kContact),
                                 .cycles = kGrowingCycles,
                                 .samples_per_cycle = samples_per_cycle,
                                 .growth = kGrowth});
}

std::vector<double> MindlinForce(const Excitation& excitation) {
  const std::vector<double>& displacement = excitation.displacement;
  const std::size_t first_reversal = FirstReversal(displacement);
  std::vector<double> force;
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    force.push_back(i <= first_reversal ? contact::MindlinVirginForce(kContact, displacement[i])
                                        : LoopForce(displacement[i], excitation.envelope[i],
                                                    displacement[i] - displacement[i - 1]));
  }
  return force;
}

std::vector<double> FullDahlForce(const BranchLaw& law, const Excitation& excitation) {
  return SteadyBranches(law, excitation, FirstReversal(excitation.displacement) + 1);
}

std::vector<double> SimplifiedDahlForce(const BranchLaw& law, const Excitation& excitation) {
  return SteadyBranches(law, excitation, 0);
}

std::vector<double> RememberingForce(const char* model, const Excitation& excitation) {
  const std::vector<double>& displacement = excitation.displacement;
  const LoadingPath path =
      models::MakeLoadingPath(displacement, loop::FindReversals(displacement, 0.0),
                              Model(model).memory, models::InitialContact{});
  return Evaluate(Model(model), ExactLaw(), path, displacement);
}

std::vector<double> RememberingMindlinForce(const Excitation& excitation) {
  const std::vector<double>& displacement = excitation.displacement;
  std::vector<double> force;
  double last_extreme = 0.0;
  double last_step = 0.0;
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    const double step = i == 0 ? 0.0 : displacement[i] - displacement[i - 1];
    if (step * last_step < 0) last_extreme = std::abs(displacement[i - 1]);
    force.push_back(std::abs(displacement[i]) >= last_extreme
                        ? contact::MindlinVirginForce(kContact, displacement[i])
                        : LoopForce(displacement[i], last_extreme, step));
    last_step = step;
  }
  return force;
}

std::vector<double> PercentOfPeak(const Excitation& excitation, const std::vector<double>& force,
                                  const std::vector<double>& reference) {
  std::vector<double> percent;
  for (std::size_t i = 0; i < force.size(); ++i) {
    const double peak = contact::MindlinVirginForce(kContact, excitation.envelope[i]);
    percent.push_back(100 * (force[i] - reference[i]) / peak);
  }
  return percent;
}

std::vector<double> WorstByCycle(const std::vector<double>& error, std::size_t samples_per_cycle) {
  std::vector<double> worst(error.size() / samples_per_cycle);
  for (std::size_t i = 0; i < worst.size() * samples_per_cycle; ++i) {
    double& cycle = worst[i / samples_per_cycle];
    cycle = std::max(cycle, std::abs(error[i]));
  }
  return worst;
}

}  // namespace mindahl::paper
