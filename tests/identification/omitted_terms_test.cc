#include "identification/gram/omitted_terms.h"

#include <Eigen/Dense>

#include "identification/diagnosis/adequacy.h"
#include "identification/diagnosis/hull.h"
#include "identification/gram/gram.h"
#include "identification/inference/departures.h"
#include "identification/inference/estimates.h"
#include "identification/inference/noise.h"
#include "identification/stages.h"
#include "support/prelude.h"

// The test of adequacy finds omitted terms as a separate calculation does.
namespace mindahl::identification::omitted_terms_test {
namespace {

constexpr BranchLaw kLaw{4e7, 1.0 / 3, 40.0};
constexpr double kReach = 3e-6;  // [m], twice gross slip

Eigen::MatrixXd Drawn(Eigen::Index rows, Eigen::Index columns, Generator& generator) {
  Eigen::MatrixXd drawn(rows, columns);
  for (Eigen::Index j = 0; j < columns; ++j) {
    for (Eigen::Index i = 0; i < rows; ++i) drawn(i, j) = Normal(generator);
  }
  return drawn;
}

/// Sum of squares of what the columns leave of a vector.
double LeftBy(const Eigen::MatrixXd& columns, const Eigen::VectorXd& values) {
  return (values - columns * columns.colPivHouseholderQr().solve(values)).squaredNorm();
}

TEST(Gram, StepsAsLeastSquaresOfAllColumnsDo) {
  constexpr Eigen::Index kRows = 60;
  Generator generator(8);
  const Eigen::MatrixXd law = 1e3 * Drawn(kRows, 3, generator);
  Eigen::MatrixXd omitted = Drawn(kRows, 4, generator);
  omitted.col(3) = omitted.col(0) + omitted.col(1);  // tells nothing more
  const Eigen::VectorXd residual = Drawn(kRows, 1, generator);
  Gram gram(law, omitted, residual, Thresholds().own_part);
  const std::vector<Eigen::Index> all = {0, 1, 2, 3};
  const GramAxes axes = gram.AxesOf(all);
  ASSERT_EQ(axes.values.size(), 3);
  const GramStep step = gram.StepBy(axes, axes.values.inverse());
  Eigen::MatrixXd both(kRows, 6);
  both << law, omitted.leftCols(3);
  const Eigen::VectorXd left = residual + law * step.law + omitted * step.omitted;
  constexpr double kRounding = 1e-8;  // of products, which are squared once
  EXPECT_NEAR(left.squaredNorm() / LeftBy(both, residual), 1, kRounding);
  EXPECT_NEAR((LeftBy(law, residual) - axes.coefficients.square().sum()) / left.squaredNorm(), 1,
              kRounding);
  const Eigen::MatrixXd covariance = (both.transpose() * both).inverse().topLeftCorner(3, 3);
  EXPECT_LT((step.covariance - covariance).norm() / covariance.norm(), kRounding);
  // Noise of four times the variance in every direction, whatever its correlation.
  Eigen::MatrixXd columns(kRows, 7);
  columns << law, omitted;
  gram.SetNoise(4 * columns.transpose() * columns);
  const GramAxes noisy = gram.AxesOf(all);
  EXPECT_LT((noisy.noise - 4).abs().maxCoeff(), kRounding);
  EXPECT_LT((gram.StepBy(noisy, noisy.values.inverse()).covariance - 4 * covariance).norm() /
                covariance.norm(),
            kRounding);
}

TEST(WidenByOmittedTerms, MovesEachEndByTheStepAndTwiceItsError) {
  Stages stages(testing::LoopOf(kLaw, Cycling(Wave::kSine, kReach, 2, 100)));
  const Problem& problem = stages.problem;
  const auto& free = problem.parameters.free();
  const auto& reported = problem.parameters.reported();
  Solution solution;
  for (std::size_t p = 0; p < problem.parameters.size(); ++p) {
    solution.theta.push_back(problem.parameters[p].theta);
  }
  constexpr double kQuantile = 0.5;  // what it adds stays within the limits of the search
  /// The part of the interval [θ] that a step with an error adds to a parameter.
  const auto added = [&](std::size_t parameter, double step, double error) {
    AdequacyTest test;
    test.step.setZero(std::ssize(free));
    test.error.setZero(std::ssize(free));
    const Eigen::Index place = std::ranges::find(free, parameter) - free.begin();
    test.step[place] = step;
    test.error[place] = error;
    std::vector<ParameterEstimate> estimates(reported.size());
    const auto k =
        static_cast<std::size_t>(std::ranges::find(reported, parameter) - reported.begin());
    // The interval starts empty, so the union with it is the omitted term's part alone.
    estimates[k].lower95 = HUGE_VAL;
    estimates[k].upper95 = -HUGE_VAL;
    WidenByOmittedTerms(problem, solution, test, kQuantile, estimates);
    const Parameter& of = problem.parameters[parameter];
    const double theta = solution.theta[parameter];
    return std::pair(of.ToTheta(*estimates[k].lower95) - theta,
                     of.ToTheta(*estimates[k].upper95) - theta);
  };
  const auto expect = [](const std::pair<double, double>& part, double middle, double half) {
    constexpr double kRounding = 1e-9;
    EXPECT_NEAR(part.first, middle - half, kRounding);
    EXPECT_NEAR(part.second, middle + half, kRounding);
  };
  for (const std::size_t p : {kStiffness, kSlipForce}) {
    for (const double sign : {1.0, -1.0}) {
      expect(added(p, sign * 0.5, 0.01), sign * 0.5, 0.01);
      // Neither step nor error counts beyond a factor of e³.
      expect(added(p, sign * 10, 10), sign * 3, 3);
    }
  }
  // α is not below 0.
  const double alpha = problem.parameters[kShape].ToValue(solution.theta[kShape]);
  EXPECT_NEAR(added(kShape, -3.0, 0.01).first, -alpha, 1e-9);
}

}  // namespace
}  // namespace mindahl::identification::omitted_terms_test
