// Fits arrays that a program has in memory: displacement and force, without a file. Here they are
// simulated, so that the result can be held against the truth; yours come from the rig.
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "mindahl/identification/fit.h"
#include "mindahl/loop/record.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/contact_state.h"
#include "mindahl/models/excitation.h"
#include "mindahl/models/friction_model.h"

namespace {

using namespace mindahl;

constexpr models::BranchLaw kTruth{
    .tangential_stiffness = 4e7, .shape_exponent = 1.0 / 3, .slip_force = 40.0};
constexpr double kNoise = 0.1;  // [N] of a reading
// Of noise alone one estimate in 10 million is farther off.
constexpr double kMostStandardErrors = 5.4;

/// Whether an estimate is as near to the truth as its error says; prints both.
bool Agrees(const identification::FitResult& fit, const char* name, double truth) {
  const identification::ParameterEstimate& estimate = *fit.Find(name);
  const double error = estimate.standard_error.value_or(0.0);
  std::printf("%-12s %12.6g ± %8.2g %-4s truth %g\n", name, estimate.value, error,
              estimate.unit.c_str(), truth);
  return std::abs(estimate.value - truth) <= kMostStandardErrors * error;
}

}  // namespace

int main() {
  const std::vector<double> displacement =  // [m]
      models::MakeExcitation({.amplitude = 2e-6, .cycles = 3}).displacement;
  std::vector<double> force;  // [N]
  models::ContactState contact(*models::FindFrictionModel("mindlin-dahl"), kTruth);
  std::mt19937 generator(1);
  std::normal_distribution<double> noise(0.0, kNoise);
  for (const double x : displacement) force.push_back(contact.Move(x) + noise(generator));

  // Nothing is copied: a view of the arrays, which may have time and normal load too.
  identification::Fitter fitter;
  const identification::FitResult& fit = fitter.Fit(loop::RecordView(displacement, force));
  if (!fit.converged) {
    std::fprintf(stderr, "no fit: %s\n", fit.solver.message.c_str());
    return 1;
  }
  const bool agrees = Agrees(fit, "sigma", kTruth.tangential_stiffness) &
                      Agrees(fit, "alpha", kTruth.shape_exponent) &
                      Agrees(fit, "slip_force", kTruth.slip_force);
  for (const identification::Finding& finding : fit.findings) {
    const std::string_view code = finding.code;
    std::printf("finding: %.*s\n", static_cast<int>(code.size()), code.data());
  }
  return agrees ? 0 : 1;
}
