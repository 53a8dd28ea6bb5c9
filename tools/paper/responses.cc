#include "responses.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "mindahl/contact/mindlin_dahl_mapping.h"
#include "mindahl/loop/reversals.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/loading_path.h"
#include "mindahl/models/response.h"

namespace mindahl::paper {

using models::BranchLaw;
using models::Excitation;
using models::FrictionModel;
using models::LoadingPath;

namespace {

const FrictionModel& Model(const char* name) { return *models::FindFrictionModel(name); }

/// Eq. 26 on the virgin curve, eq. 27 after it.
models::BranchScale FullDahlScale(double signed_force, double peak, bool virgin) {
  const char* equation = virgin ? "mindlin-dahl" : "simplified-dahl";
  return Model(equation).scale(signed_force, peak, virgin);
}

FrictionModel PrintedFullDahl() {
  FrictionModel model = Model("simplified-dahl");
  model.name = "full-dahl";
  model.title = "Full-Dahl as printed, with a T* from outside";
  model.scale = FullDahlScale;
  return model;
}

std::vector<double> Evaluate(const FrictionModel& model, const BranchLaw& law,
                             const LoadingPath& path, const std::vector<double>& displacement) {
  std::vector<double> force(displacement.size());
  models::EvaluateForce(model, law, path, displacement, force);
  return force;
}

std::size_t FirstReversal(const std::vector<double>& displacement) {
  return loop::FindReversals(displacement, 0.0).front();
}

/// Amplitudes at which the law's T* is Mindlin's: the branch law depends on σx alone.
std::vector<double> AmplitudesOfMindlinsPeak(const BranchLaw& law, const Excitation& excitation) {
  const double ratio = ExactLaw().tangential_stiffness / law.tangential_stiffness;
  std::vector<double> amplitude = excitation.envelope;
  for (double& value : amplitude) value *= ratio;
  return amplitude;
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
  LoadingPath path = models::MakeEnvelopePath(excitation.displacement,
                                              AmplitudesOfMindlinsPeak(law, excitation), 0.0);
  const std::size_t first_reversal = FirstReversal(excitation.displacement);
  for (std::size_t i = 0; i <= first_reversal; ++i) {
    path.branches[i].origin = 0.0;
    path.branches[i].parent = -1;
    path.branches[i].start = models::BranchStart::kUnloaded;
  }
  return Evaluate(PrintedFullDahl(), law, path, excitation.displacement);
}

std::vector<double> SimplifiedDahlForce(const BranchLaw& law, const Excitation& excitation) {
  const LoadingPath path = models::MakeEnvelopePath(excitation.displacement,
                                                    AmplitudesOfMindlinsPeak(law, excitation), 0.0);
  return Evaluate(Model("simplified-dahl"), law, path, excitation.displacement);
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
