#include "identification/inference/shape_tests.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/probability.h"
#include "identification/inference/evidence.h"

namespace mindahl::identification {
namespace {

constexpr std::array kNames = {"virgin", "unloading", "reloading"};
constexpr std::size_t kFewestOfKind = 10;

/// Compares fits that differ in α.
Evidence EvidenceOfShape(const Noise& noise, const Estimates& estimates) {
  return {noise.samples, static_cast<double>(noise.samples) * estimates.WhiteShare(kShape)};
}

/// Kind of the branch of each sample, an index of kNames. A contact unloads on its way back from
/// its first push; of a steady one that is not known, and taken to have been to positive
/// displacements.
std::vector<std::size_t> Kinds(const Problem& problem, const Solution& best, Response& response) {
  std::vector<std::size_t> kinds;
  response.Bind(problem);
  for (std::size_t r = 0; r < problem.data->records.size(); ++r) {
    const models::LoadingPath& path = response.PathOf(r, best.theta);
    const models::Branch& first = path.branches.front();
    const bool first_up = first.start != models::BranchStart::kUnloaded || first.direction > 0;
    std::size_t kind = 2;
    for (const models::BranchRun& run : path.runs) {
      const models::Branch& branch = path.branches[static_cast<std::size_t>(run.branch)];
      const bool back = (branch.direction > 0) != first_up;
      // A steady loop's virgin curve is not in the record: a sample on it is an extreme that came
      // back to the last bit, and ends the stroke before.
      if (branch.start != models::BranchStart::kSteadyCentre) {
        kind = branch.start == models::BranchStart::kUnloaded ? 0 : back ? 1 : 2;
      }
      kinds.insert(kinds.end(), run.end - run.begin, kind);
    }
  }
  return kinds;
}

}  // namespace

std::optional<MindlinTest> TestMindlin(const FittedProblem& fitted, const FitOptions& options,
                                       SearchBuffers& buffers) {
  const auto& [problem, best, noise, estimates] = fitted;
  if (problem.parameters[kShape].fixed) return std::nullopt;
  const Problem held = problem.WithFixed(kShape, kMindlinExponent);
  Solution solution;
  buffers.solver.Bind(held, buffers.response);
  buffers.solver.Solve(best.theta, SolverOptionsOf(options), solution);
  MindlinTest test;
  test.likelihood_ratio =
      EvidenceOfShape(noise, estimates)
          .FStatistic(solution.sum_of_squares, best.sum_of_squares, noise.variance);
  test.p_value =
      PValueOfF(test.likelihood_ratio, noise.degrees_of_freedom(problem.parameters.free().size()));
  return test;
}

bool ContradictsInterval(const MindlinTest& test, const ParameterEstimate& alpha) {
  constexpr double kOutside95 = 0.05;
  if (!alpha.lower95 || !alpha.upper95) return false;
  const bool is_excluded = kMindlinExponent < *alpha.lower95 || kMindlinExponent > *alpha.upper95;
  return is_excluded && test.p_value > kOutside95;
}

bool WantsRig(const Problem& problem, const Solution& best, const MindlinTest& test,
              const Thresholds& thresholds) {
  return test.p_value < thresholds.significance &&
         kMindlinExponent - best.theta[kShape] > thresholds.shape_effect &&
         !problem.parameters.has_rig();
}

std::optional<RigAlternative> TryRig(const FittedProblem& fitted, ThinnedRecords& thin,
                                     const MindlinTest& test, const FitOptions& options,
                                     SearchBuffers& buffers) {
  const Problem& problem = fitted.problem;
  const Solution& best = fitted.solution;
  // The law of a load that varies has none, nor has that of an imposed force.
  const bool is_wanted = WantsRig(problem, best, test, options.thresholds);
  if (!is_wanted || problem.data->load_varies || problem.data->is_forced()) return std::nullopt;
  FitOptions with_rig = options;
  with_rig.terms.emplace_back("rig_stiffness");
  with_rig.fixed["alpha"] = kMindlinExponent;
  with_rig.start.clear();
  Candidate sprung(*problem.data, with_rig, problem.state, std::pmr::get_default_resource());
  Solution solution;
  sprung.solution = &solution;
  FindStartsOf(sprung, thin, with_rig, std::numeric_limits<double>::infinity(), buffers,
               std::pmr::get_default_resource());
  Descend(sprung, with_rig, buffers, nullptr);
  // Both have as many parameters: ΔAICc is 2 ln Λ.
  const double loss =
      EvidenceOfShape(fitted.noise, fitted.estimates)
          .FStatistic(solution.sum_of_squares, best.sum_of_squares, fitted.noise.variance);
  if (!solution.converged || !(loss < options.thresholds.indistinguishable)) return std::nullopt;
  return RigAlternative{
      .rig_stiffness = sprung.problem.parameters.RigAt(solution.theta).stiffness,
      .tangential_stiffness = sprung.problem.parameters.LawAt(solution.theta).tangential_stiffness};
}

std::vector<BranchShape> FitBranchShapes(const FittedProblem& fitted, Response& response) {
  const auto& [problem, best, noise, estimates] = fitted;
  if (problem.parameters[kShape].fixed || best.side[kShape] != BoundSide::kInside) return {};
  const std::vector<std::size_t> kinds = Kinds(problem, best, response);
  std::array<std::size_t, kNames.size()> samples{};
  std::size_t row = 0;
  for (const ScaledRecord& record : problem.data->records) {
    for (const unsigned char counts : record.counts) samples[kinds[row++]] += counts;
  }
  std::vector<std::size_t> present;
  for (std::size_t kind = 0; kind < kNames.size(); ++kind) {
    if (samples[kind] >= kFewestOfKind) present.push_back(kind);
  }
  if (present.size() < 2) return {};

  const Eigen::MatrixXd& jacobian = estimates.jacobian();
  const auto shape_column = static_cast<Eigen::Index>(
      std::ranges::find(problem.parameters.free(), kShape) - problem.parameters.free().begin());
  // α's column in parts, the first in its place, the others at the end.
  const auto parts = static_cast<Eigen::Index>(present.size());
  Eigen::MatrixXd split(jacobian.rows(), jacobian.cols() + parts - 1);
  split.leftCols(jacobian.cols()) = jacobian;
  split.rightCols(parts - 1).setZero();
  const auto column_of = [&](Eigen::Index part) {
    return part == 0 ? shape_column : jacobian.cols() + part - 1;
  };
  for (Eigen::Index i = 0; i < jacobian.rows(); ++i) {
    const auto kind = std::ranges::find(present, kinds[static_cast<std::size_t>(i)]);
    if (kind == present.end() || kind == present.begin()) continue;
    split(i, column_of(kind - present.begin())) = jacobian(i, shape_column);
    split(i, shape_column) = 0;
  }
  Eigen::VectorXd norms = split.colwise().norm().transpose();
  for (double& norm : norms) {
    if (norm == 0) norm = 1;
  }
  split = split * norms.cwiseInverse().asDiagonal();
  const Eigen::VectorXd& values = estimates.residual();
  const Eigen::MatrixXd normal = split.transpose() * split;
  const Eigen::MatrixXd factor =
      Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>(normal).pseudoInverse();
  const Eigen::VectorXd step = -factor * (split.transpose() * values);
  const Eigen::MatrixXd correlated = CorrelatedProduct(*problem.data, noise.autocorrelation, split);
  // The misfit of one law for all branches is not noise here.
  const double sum_of_squares = values.squaredNorm();
  if (!(sum_of_squares > 0)) return {};
  const double left = (values + split * step).squaredNorm() / sum_of_squares;
  const Eigen::MatrixXd covariance =
      noise.variance * noise.repeating * std::min(left, 1.0) * factor * correlated * factor;
  std::vector<BranchShape> shapes;
  for (Eigen::Index k = 0; k < parts; ++k) {
    const Eigen::Index column = column_of(k);
    const std::size_t kind = present[static_cast<std::size_t>(k)];
    shapes.push_back({kNames[kind], samples[kind],
                      best.theta[kShape] + step[column] / norms[column],
                      std::sqrt(covariance(column, column)) / norms[column]});
  }
  return shapes;
}

}  // namespace mindahl::identification
