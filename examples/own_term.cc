// A force of one's own in addition to the contact's, fitted with it: the cubic force of a guide's
// flexure, C·δ³. Any force that is known but for a factor is a column of the record, and its factor
// a parameter like any other, with error, interval and verdict.
#include <cmath>
#include <cstdio>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "mindahl/identification/fit.h"
#include "mindahl/identification/terms.h"
#include "mindahl/loop/record.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/contact_state.h"
#include "mindahl/models/excitation.h"
#include "mindahl/models/friction_model.h"

namespace {

using namespace mindahl;

constexpr models::BranchLaw kTruth{
    .tangential_stiffness = 4e7, .shape_exponent = 1.0 / 3, .slip_force = 40.0};
constexpr double kFlexure = 0.5;  // [N/µm³]
constexpr double kNoise = 0.1;    // [N] of a reading
// Of noise alone one estimate in 10 million is farther off.
constexpr double kMostStandardErrors = 5.4;

loop::Record Measure() {
  loop::Record record;
  // Growing strokes tell the contact, which forgets, from the flexure, which does not.
  const models::Excitation motion = models::MakeExcitation(
      {.waveform = models::Waveform::kGrowingSine, .amplitude = 3e-6, .cycles = 5});
  record.displacement = motion.displacement;
  models::ContactState contact(*models::FindFrictionModel("mindlin-dahl"), kTruth);
  std::mt19937 generator(1);
  std::normal_distribution<double> noise(0.0, kNoise);
  for (const double x : record.displacement) {
    record.force.push_back(contact.Move(x) + kFlexure * std::pow(x * 1e6, 3) + noise(generator));
  }
  return record;
}

bool Agrees(const identification::ParameterEstimate& estimate, double truth) {
  const double error = estimate.standard_error.value_or(0.0);
  std::printf("%-18s %12.6g ± %8.2g %-6s truth %g\n", estimate.name.c_str(), estimate.value, error,
              estimate.unit.c_str(), truth);
  return std::abs(estimate.value - truth) <= kMostStandardErrors * error;
}

}  // namespace

int main() {
  loop::Record record = Measure();
  identification::Fitter plain;
  const double rms_without = plain.Fit(record).rms;

  // The column of the term, one value a sample: what the force is in proportion to.
  loop::Covariate cubic{.name = "cubic", .unit = "um^3", .values = {}};
  for (const double x : record.displacement) cubic.values.push_back(std::pow(x * 1e6, 3));
  record.covariates.push_back(cubic);
  identification::FitOptions options;
  options.covariates = {cubic.name};
  identification::Fitter fitter(options);
  const identification::FitResult& fit = fitter.Fit(record);

  std::printf("residual without the term %.3g N, with it %.3g N, noise %.3g N\n", rms_without,
              fit.rms, kNoise);
  const std::string name = identification::NameOfCovariate(cubic.name);
  const bool agrees = Agrees(*fit.Find("sigma"), kTruth.tangential_stiffness) &
                      Agrees(*fit.Find("alpha"), kTruth.shape_exponent) &
                      Agrees(*fit.Find("slip_force"), kTruth.slip_force) &
                      Agrees(*fit.Find(name), kFlexure);
  return agrees && fit.converged && fit.rms < rms_without / 2 ? 0 : 1;
}
