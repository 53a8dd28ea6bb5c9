#include "identification/solve/robust_search.h"

#include <ceres/ceres.h>
#include <ceres/normal_prior.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "identification/solve/ceres_options.h"
#include "identification/solve/unprojected_record.h"

namespace mindahl::identification {
namespace {

std::unique_ptr<ceres::LossFunction> LossOf(Loss loss) {
  switch (loss) {
    case Loss::kHuber:
      return std::make_unique<ceres::HuberLoss>(kHuberConstant);
    case Loss::kCauchy:
      return std::make_unique<ceres::CauchyLoss>(kCauchyConstant);
    case Loss::kTukey:
      return std::make_unique<ceres::TukeyLoss>(kTukeyConstant);
    case Loss::kNone:
      break;
  }
  return nullptr;
}

}  // namespace

void SolveRobustly(const Problem& problem, Loss loss, double scale, const SolverOptions& options,
                   Solution& solution) {
  std::vector<double>& theta = solution.theta;
  const std::unique_ptr<ceres::LossFunction> loss_function = LossOf(loss);
  ceres::Problem::Options of_problem;
  of_problem.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem ceres_problem(of_problem);
  for (std::size_t r = 0; r < problem.data->records.size(); ++r) {
    const auto record = std::make_shared<UnprojectedRecord>(problem, r, scale);
    std::vector<double*> blocks;
    for (const std::size_t p : record->blocks()) blocks.push_back(&theta[p]);
    for (std::size_t i = 0; i < record->samples(); ++i) {
      if (!record->Counts(i)) continue;
      ceres_problem.AddResidualBlock(CostOfSample(record, i).release(), loss_function.get(),
                                     blocks);
    }
  }
  for (const std::size_t p : problem.parameters.with_prior()) {
    const Parameter& parameter = problem.parameters[p];
    ceres_problem.AddResidualBlock(
        new ceres::NormalPrior(Eigen::MatrixXd::Constant(1, 1, parameter.prior_root_weight / scale),
                               Eigen::VectorXd::Constant(1, parameter.prior_theta)),
        nullptr, &theta[p]);
  }
  for (std::size_t p = 0; p < theta.size(); ++p) {
    if (!ceres_problem.HasParameterBlock(&theta[p])) continue;
    const Parameter& parameter = problem.parameters[p];
    if (parameter.fixed) {
      ceres_problem.SetParameterBlockConstant(&theta[p]);
      continue;
    }
    theta[p] = std::clamp(theta[p], parameter.lower, parameter.upper);
    ceres_problem.SetParameterLowerBound(&theta[p], 0, parameter.lower);
    ceres_problem.SetParameterUpperBound(&theta[p], 0, parameter.upper);
  }
  ceres::Solver::Summary summary;
  ceres::Solve(CeresOptionsOf(options, ceres::DENSE_NORMAL_CHOLESKY), &ceres_problem, &summary);
  solution.converged = summary.termination_type == ceres::CONVERGENCE;
  solution.report.solver = "solve";
  solution.report.termination = ceres::TerminationTypeToString(summary.termination_type);
  solution.report.message = summary.message;
  solution.report.iterations += static_cast<int>(summary.iterations.size());
  solution.side.assign(theta.size(), BoundSide::kInside);
  for (const std::size_t p : problem.parameters.free()) {
    solution.side[p] = SideOf(problem.parameters[p], theta[p]);
  }
}

}  // namespace mindahl::identification
