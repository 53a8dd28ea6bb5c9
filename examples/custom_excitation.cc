// The force of a contact along a motion of one's own: a chirp that grows and comes to rest off its
// centre. The response is exact for any samples; the same path then serves for several laws.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "mindahl/identification/fit.h"
#include "mindahl/loop/record.h"
#include "mindahl/loop/reversals.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/loading_path.h"
#include "mindahl/models/response.h"

namespace {

using namespace mindahl;

constexpr std::size_t kSamples = 4000;
constexpr double kAmplitude = 2e-6;  // [m]
constexpr models::BranchLaw kLaw{
    .tangential_stiffness = 4e7, .shape_exponent = 1.0 / 3, .slip_force = 40.0};
// A fit without noise ends where the solver's steps are below 1e-9 of the parameters.
constexpr double kTolerance = 1e-6;

/// [m], the contact unloaded at 0: five strokes that grow, ever faster, about a centre that
/// wanders.
std::vector<double> Chirp() {
  std::vector<double> displacement;
  for (std::size_t i = 0; i < kSamples; ++i) {
    const double at = static_cast<double>(i) / (kSamples - 1);
    const double phase = 2 * std::numbers::pi * (2 * at + 3 * at * at);
    displacement.push_back(kAmplitude * (at * std::sin(phase) + 0.3 * at * at));
  }
  return displacement;
}

/// ∮ T dδ [J] by the trapezoidal rule.
double Work(const std::vector<double>& displacement, const std::vector<double>& force) {
  double work = 0.0;
  for (std::size_t i = 1; i < displacement.size(); ++i) {
    work += (force[i] + force[i - 1]) / 2 * (displacement[i] - displacement[i - 1]);
  }
  return work;
}

}  // namespace

int main() {
  const std::vector<double> displacement = Chirp();
  // Without noise every excursion is a reversal.
  const std::vector<std::size_t> reversals = loop::FindReversals(displacement, /*gate=*/0.0);
  std::vector<double> force(displacement.size());
  for (const char* name : {"mindlin-dahl", "dahl", "jenkins"}) {
    const models::FrictionModel& model = *models::FindFrictionModel(name);
    models::BranchLaw law = kLaw;
    if (model.shape_exponent) law.shape_exponent = *model.shape_exponent;
    const models::LoadingPath path =
        models::MakeLoadingPath(displacement, reversals, model.memory, models::InitialContact{});
    models::EvaluateForce(model, law, path, displacement, force);
    std::printf("%-14s peak force %.6g N, work %.6g J\n", name, *std::ranges::max_element(force),
                Work(displacement, force));
    if (*std::ranges::max_element(force) > kLaw.slip_force) return 1;

    // The motion identifies the contact that made it.
    identification::Fitter fitter(
        {.model = &model, .initial_state = models::InitialState::kVirgin});
    const identification::FitResult& fit = fitter.Fit(loop::RecordView(displacement, force));
    const double stiffness_error = fit.law.tangential_stiffness / law.tangential_stiffness - 1;
    const double slip_error = fit.law.slip_force / law.slip_force - 1;
    std::printf("  fitted: sigma within %.1g, Tc within %.1g\n", std::abs(stiffness_error),
                std::abs(slip_error));
    if (!(std::abs(stiffness_error) < kTolerance && std::abs(slip_error) < kTolerance)) return 1;
  }
  return 0;
}
