#include "identification/solve/unprojected_residual.h"

#include <ceres/cost_function.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "mindahl/core/error.h"

namespace mindahl::identification {
namespace {

/// Puts the loss of a residual in its place, and returns the derivative by the residual.
double ApplyLoss(const ceres::LossFunction& loss, double& residual) {
  std::array<double, 3> rho{};  // and its derivatives by the square
  loss.Evaluate(residual * residual, rho.data());
  const bool is_zero = !(rho[0] > 0);  // or its square is
  const double slope =
      is_zero ? std::sqrt(rho[1]) : rho[1] * std::abs(residual) / std::sqrt(rho[0]);
  residual = std::copysign(std::sqrt(rho[0]), residual);
  return slope;
}

class UnprojectedResidual final : public ceres::CostFunction {
 public:
  /// @param blocks  positions of the parameters
  UnprojectedResidual(const Problem& problem, double unit,
                      std::unique_ptr<ceres::LossFunction> loss, std::vector<std::size_t> blocks)
      : problem_(problem),
        unit_(unit),
        loss_(std::move(loss)),
        blocks_(std::move(blocks)),
        response_(problem) {
    set_num_residuals(static_cast<int>(problem.size()));
    mutable_parameter_block_sizes()->assign(blocks_.size(), 1);
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    std::vector<double> theta = problem_.parameters.Theta();
    std::vector<std::size_t> wanted;
    std::vector<double*> columns;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      theta[blocks_[b]] = *parameters[b];
      if (jacobians == nullptr || jacobians[b] == nullptr) continue;
      wanted.push_back(blocks_[b]);
      columns.push_back(jacobians[b]);
    }
    Linearization at;
    try {
      at = response_.LinearizeAt(theta, wanted);
    } catch (const InvalidArgument&) {  // no law: exp(θ) is 0 or infinite
      return false;
    }
    // Ceres would print what is no number.
    if (!at.residual.allFinite() || !at.jacobian.allFinite()) return false;
    at.residual /= unit_;
    Eigen::ArrayXd slopes = Eigen::ArrayXd::Constant(at.residual.size(), 1 / unit_);
    for (Eigen::Index i = 0; loss_ && i < slopes.size(); ++i) {
      slopes[i] *= ApplyLoss(*loss_, at.residual[i]);
    }
    at.jacobian.array().colwise() *= slopes;
    std::ranges::copy(at.residual, residuals);
    for (Eigen::Index k = 0; double* const column : columns) {
      std::ranges::copy(at.jacobian.col(k++), column);
    }
    return true;
  }

 private:
  const Problem& problem_;
  double unit_;
  std::unique_ptr<ceres::LossFunction> loss_;
  std::vector<std::size_t> blocks_;
  mutable Response response_;  // an evaluation reuses the buffers of the last one
};

}  // namespace

void AddResidualBlock(const Problem& problem, double unit,
                      std::unique_ptr<ceres::LossFunction> loss,
                      const std::function<double*(std::size_t)>& block_of, ceres::Problem& to) {
  const Parameters& parameters = problem.parameters;
  std::vector<std::size_t> positions;
  std::vector<double*> blocks;
  for (const std::size_t p : parameters.reported()) {
    if (!problem.is_virgin() && p == parameters.PositionOfOrigin(parameters[p].record)) continue;
    positions.push_back(p);
    blocks.push_back(block_of(p));
  }
  to.AddResidualBlock(new UnprojectedResidual(problem, unit, std::move(loss), std::move(positions)),
                      nullptr, blocks);
}

void BoundBlock(double* theta, bool fixed, double lower, double upper, ceres::Problem& problem) {
  if (!problem.HasParameterBlock(theta)) return;
  if (fixed) {
    problem.SetParameterBlockConstant(theta);
    return;
  }
  *theta = std::clamp(*theta, lower, upper);
  problem.SetParameterLowerBound(theta, 0, lower);
  problem.SetParameterUpperBound(theta, 0, upper);
}

}  // namespace mindahl::identification
