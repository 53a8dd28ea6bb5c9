// Adds what is known from elsewhere to a fit: here that α is near 1/3, as a residual of its own in
// the problem that the fit solves, and solves it by Ceres. The same problem without the prior is
// solved too: its minimum is the fit's.
#include <ceres/ceres.h>

#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "mindahl/identification/ceres_problem.h"
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
constexpr double kNoise = 1.0;  // [N] of a reading

/// (θ − mean)/deviation, the residual of a normal prior of a parameter.
struct NormalPrior {
  double mean;
  double deviation;
  template <typename T>
  bool operator()(const T* theta, T* residual) const {
    residual[0] = (theta[0] - mean) / deviation;
    return true;
  }
};

bool Solve(ceres::Problem& problem) {
  ceres::Solver::Options options;
  options.function_tolerance = 1e-16;
  options.parameter_tolerance = 1e-14;
  options.gradient_tolerance = 1e-14;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return summary.termination_type == ceres::CONVERGENCE;
}

}  // namespace

int main() {
  const std::vector<double> displacement =  // [m]
      models::MakeExcitation({.amplitude = 2e-6, .cycles = 3, .samples_per_cycle = 200})
          .displacement;
  std::vector<double> force;  // [N]
  models::ContactState contact(*models::FindFrictionModel("mindlin-dahl"), kTruth);
  std::mt19937 generator(1);
  std::normal_distribution<double> noise(0.0, kNoise);
  for (const double x : displacement) force.push_back(contact.Move(x) + noise(generator));

  identification::FitOptions options;
  options.initial_state = models::InitialState::kVirgin;
  const loop::RecordView record(displacement, force);
  identification::Fitter fitter(options);
  const identification::FitResult& fit = fitter.Fit(record);
  if (!fit.converged) return 1;

  // Residuals in units of the noise: half their sum of squares is minus the log-likelihood.
  identification::CeresProblem same({&record, 1}, options, fit, fit.force_noise);
  same.Find("alpha").theta += 0.01;  // not where the fit ended
  ceres::Problem problem;
  same.AddTo(problem);
  bool agrees = Solve(problem);
  for (const char* name : {"sigma", "alpha", "slip_force"}) {
    const double difference = same.Find(name).Value() / fit.Find(name)->value - 1;
    std::printf("%-12s differs from the fit by %.1e\n", name, difference);
    agrees = agrees && std::abs(difference) < 1e-5;  // a fit ends where a step gains 1e-10
  }

  constexpr double kPrior = 1.0 / 3;
  constexpr double kDeviation = 0.02;
  identification::CeresProblem with_prior({&record, 1}, options, fit, fit.force_noise);
  ceres::Problem informed;
  with_prior.AddTo(informed);
  informed.AddResidualBlock(
      new ceres::AutoDiffCostFunction<NormalPrior, 1, 1>(new NormalPrior{kPrior, kDeviation}),
      nullptr, &with_prior.Find("alpha").theta);
  agrees = Solve(informed) && agrees;

  // The product of two normal densities has their means weighted by their precisions.
  const identification::ParameterEstimate& alpha = *fit.Find("alpha");
  const double of_fit = 1 / (*alpha.standard_error * *alpha.standard_error);
  const double of_prior = 1 / (kDeviation * kDeviation);
  const double expected = (of_fit * alpha.value + of_prior * kPrior) / (of_fit + of_prior);
  const double found = with_prior.Find("alpha").Value();
  std::printf("alpha        %.4f ± %.4f of the fit, %.4f with the prior, %.4f expected\n",
              alpha.value, *alpha.standard_error, found, expected);
  // The likelihood is no parabola: a tenth of the error.
  return agrees && std::abs(found - expected) < 0.1 * *alpha.standard_error ? 0 : 1;
}
