
#include <Eigen/Dense>
#include <boost/math/distributions/fisher_f.hpp>

#include "identification/diagnosis/adequacy.h"
#include "identification/inference/column_test.h"
#include "identification/inference/departures.h"
#include "identification/inference/estimates.h"
#include "identification/inference/noise.h"
#include "identification/stages.h"
#include "support/prelude.h"

// What residuals are asked for in addition to the model: degrees of freedom, several columns, and
// the move of a parameter, each by a calculation of its own.
namespace mindahl::identification::omitted_terms_test {
namespace {

using namespace loop;
using namespace models;

constexpr BranchLaw kLaw{4e7, 1.0 / 3, 40.0};
constexpr double kReach = 3e-6;  // [m], twice gross slip

Record LoopOf(std::size_t samples_per_cycle, double cycles) {
  const auto displacement =
      testing::Cycling(testing::Wave::kSine, kReach, cycles, static_cast<int>(samples_per_cycle));
  return testing::MakeRecord(displacement,
                             testing::Respond(testing::Model("mindlin-dahl"), kLaw, displacement));
}

TEST(WidenByDepartures, MovesEachEndByTheStepItsErrorItsSquareAndWhatIsApart) {
  Stages stages(LoopOf(100, 2));
  const Problem& problem = stages.problem;
  const auto& free = problem.parameters.free();
  Solution solution;
  for (std::size_t p = 0; p < problem.parameters.size(); ++p) {
    solution.theta.push_back(problem.parameters[p].theta);
  }
  const auto departures = Departures();
  const auto plain = std::ranges::find(departures, 0.0, &Departure::apart);
  const auto apart = std::ranges::find(departures, 0.5, &Departure::apart);
  ASSERT_TRUE(plain != departures.end() && apart != departures.end());
  constexpr double kQuantile = 2.0;
  /// The part of the interval [θ] that a fit with a step and an error adds to a parameter.
  const auto added = [&](std::size_t parameter, double step, double error, const auto& departure,
                         double size) {
    DepartureFit fit;
    fit.departure = static_cast<std::size_t>(departure - departures.begin());
    fit.size = size;
    fit.step.assign(free.size(), 0.0);
    fit.error.assign(free.size(), 0.0);
    const auto place = static_cast<std::size_t>(std::ranges::find(free, parameter) - free.begin());
    fit.step[place] = step;
    fit.error[place] = error;
    std::vector<ParameterEstimate> estimates(problem.parameters.reported().size());
    const auto& reported = problem.parameters.reported();
    const auto k =
        static_cast<std::size_t>(std::ranges::find(reported, parameter) - reported.begin());
    estimates[k].interval = {{.source = IntervalSource::kParabola, .lower = 0.0, .upper = 0.0}};
    WidenByDepartures(problem, solution, std::span(&fit, 1), kQuantile, estimates);
    EXPECT_EQ(estimates[k].interval.size(), 2U);
    const IntervalPart& part = estimates[k].interval.back();
    EXPECT_EQ(part.source, IntervalSource::kOmittedTerms);
    const Parameter& of = problem.parameters[parameter];
    const double theta = solution.theta[parameter];
    return std::pair(of.ToTheta(*part.lower) - theta, of.ToTheta(*part.upper) - theta);
  };
  const auto expect = [](const std::pair<double, double>& part, double middle, double half) {
    constexpr double kRounding = 1e-9;
    EXPECT_NEAR(part.first, middle - half, kRounding);
    EXPECT_NEAR(part.second, middle + half, kRounding);
  };
  for (const std::size_t p : {kStiffness, kSlipForce}) {
    for (const double sign : {1.0, -1.0}) {
      expect(added(p, sign * 0.5, 0.01, plain, 0.25), sign * 0.5, 2 * 0.01 + 0.25);
      expect(added(p, sign * 0.5, 0.01, apart, sign * 0.25), sign * 0.5, 2 * 0.01 + 0.25 + 0.125);
      // Neither step nor error, nor what is apart, counts beyond a factor of e³.
      expect(added(p, sign * 10, 0.01, plain, 0.25), sign * 3, 2 * 0.01 + 3);
      expect(added(p, sign * 0.5, 10, apart, 100.0), sign * 0.5, 2 * 3 + 0.25 + 3);
    }
  }
  // α is not of the force, and not below 0.
  const double alpha = problem.parameters[kShape].ToValue(solution.theta[kShape]);
  expect(added(kShape, 0.125, 0.01, apart, 0.25), 0.125, 2 * 0.01 + 0.015625);
  EXPECT_NEAR(added(kShape, -3.0, 0.01, plain, 0.0).first, -alpha, 1e-9);
}

}  // namespace
}  // namespace mindahl::identification::omitted_terms_test
