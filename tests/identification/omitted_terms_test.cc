
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

/// Number of a term's columns that are independent of each other and of the law's.
double OwnColumns(const Eigen::MatrixXd& law, const DepartureColumns& columns, std::size_t term) {
  const auto count = std::ranges::count(columns.of, term);
  Eigen::MatrixXd own(law.rows(), count);
  Eigen::Index next = 0;
  for (std::size_t c = 0; c < columns.of.size(); ++c) {
    if (columns.of[c] != term) continue;
    const Eigen::VectorXd unit = columns.columns.col(static_cast<Eigen::Index>(c)).normalized();
    const Eigen::VectorXd left = unit - law * law.colPivHouseholderQr().solve(unit);
    if (left.norm() >= 0.02) own.col(next++) = left;  // as column_test.h asks of a column
  }
  if (next == 0) return 0.0;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
  qr.setThreshold(1e-3);
  return static_cast<double>(qr.compute(own.leftCols(next)).rank());
}

TEST(ColumnTest, CountsItsOwnColumnsAmongTheParametersOfAShortRecord) {
  // 21 samples, 3 columns of the law and 7 that are asked for: a third of the samples.
  constexpr Eigen::Index kOfLaw = 3;
  constexpr Eigen::Index kOthers = 7;
  Stages stages(LoopOf(10, 2));
  const auto samples = static_cast<Eigen::Index>(stages.problem.size());
  ASSERT_EQ(samples, 21);
  Generator generator(8);
  const Eigen::MatrixXd law = Drawn(samples, kOfLaw, generator);
  const Eigen::MatrixXd others = Drawn(samples, kOthers, generator);
  const Eigen::VectorXd values = Drawn(samples, 1, generator);
  const Eigen::VectorXd residual = values - law * law.colPivHouseholderQr().solve(values);

  const ColumnTest test(stages.problem, {}, {}, law, others, residual);
  ASSERT_EQ(test.effective_samples(), 21.0) << "the case needs residuals that look white";
  constexpr double kDegrees = 21 - 3 - 7;
  EXPECT_EQ(test.degrees_of_freedom(), kDegrees);
  Eigen::MatrixXd all(samples, kOfLaw + kOthers);
  all << law, others;
  const double left = LeftBy(all, residual);
  constexpr double kRounding = 1e-10;  // of products of columns, which are squared once
  EXPECT_NEAR(test.variance() / (left / kDegrees), 1, kRounding);
  const double f = (residual.squaredNorm() - left) / kOthers / (left / kDegrees);
  const double p_value =
      boost::math::cdf(boost::math::complement(boost::math::fisher_f(kOthers, kDegrees), f));
  EXPECT_NEAR(test.p_value() / p_value, 1, 1e-8);
}

TEST(MoveOf, IsInHalvesOfTheInterval) {
  Stages stages(LoopOf(100, 2));
  const Problem& problem = stages.problem;
  Solution solution;
  for (std::size_t p = 0; p < problem.parameters.size(); ++p) {
    solution.theta.push_back(problem.parameters[p].theta);
  }
  solution.theta[kStiffness] = problem.parameters[kStiffness].ToTheta(5e7);
  DepartureFit fit;
  fit.step.assign(problem.parameters.free().size(), 0.0);
  const auto place = std::ranges::find(problem.parameters.free(), kStiffness);
  ASSERT_NE(place, problem.parameters.free().end());
  fit.step[static_cast<std::size_t>(place - problem.parameters.free().begin())] = 0.2;
  // θ of σ is its logarithm: from 5e7 to 5e7·e^0.2, in halves of 7e7 − 4e7.
  ParameterEstimate estimate;
  estimate.value = 5e7;
  estimate.lower95 = 4e7;
  estimate.upper95 = 7e7;
  EXPECT_NEAR(MoveOf(problem, solution, fit, kStiffness, estimate),
              5e7 * (std::exp(0.2) - 1) / 1.5e7, 1e-12);
  estimate.upper95.reset();
  EXPECT_EQ(MoveOf(problem, solution, fit, kStiffness, estimate), 0.0);
}

TEST(TestAdequacy, CountsEveryColumnOfATermInItsAicc) {
  // A friction that grows along the stroke, of which several terms explain a part.
  Record record = LoopOf(200, 3);
  Generator generator(5);
  for (std::size_t i = 0; i < record.size(); ++i) {
    const double place = record.displacement[i] / kReach;
    record.force[i] = record.force[i] * (1 + 0.05 * place + 0.03 * place * place) +
                      0.002 * kLaw.slip_force * Normal(generator);
  }
  Stages stages(record);
  const testing::WeightedFit weighted = testing::FitWeighted(stages);
  const Estimates estimates(stages.problem, weighted.solution, weighted.noise, {}, {},
                            stages.buffers.response);
  const AdequacyTest test =
      TestAdequacy({stages.problem, weighted.solution, weighted.noise, estimates}, {}, {},
                   stages.buffers.response);
  const DepartureColumns columns = ColumnsOfDepartures(
      stages.problem, weighted.solution.theta, stages.buffers.response, stages.problem.size());
  const Evidence evidence(stages.data.counted, test.effective_samples);
  std::size_t of_several = 0;
  for (const DepartureFit& fit : test.fits) {
    if (fit.step.empty()) continue;  // no more than noise explains
    const double count = OwnColumns(estimates.jacobian(), columns, fit.departure);
    const double ratio = evidence.LikelihoodRatio(1.0, 1.0 - fit.explains);
    EXPECT_NEAR(fit.delta_aicc + ratio, 2 * count, 1e-6 * ratio)
        << Departures()[fit.departure].code;
    of_several += count > 1 ? 1 : 0;
  }
  EXPECT_GE(of_several, 1u) << "the case needs a term of several columns";
}

TEST(CausesOf, ForceReadingThatGainsOrLosesMoreThanAllDoesNotSaturate) {
  // A sensor loses a part or all of the force beyond nine tenths of the peak, and no more.
  const auto is_named = [](double lost, double size_p_value) {
    DepartureFit fit;
    while (Departures()[fit.departure].code != "force_saturates") ++fit.departure;
    fit.p_value = 1e-9;
    fit.delta_aicc = -90;
    fit.explains = 0.8;
    fit.size = lost;
    fit.size_p_value = size_p_value;
    AdequacyTest test;
    test.fits = {fit};
    return CausesOf(test, {}).size() == 1;
  };
  constexpr double kCertain = 1e-9;
  EXPECT_TRUE(is_named(0.3, kCertain));
  EXPECT_TRUE(is_named(1.0, kCertain));
  EXPECT_FALSE(is_named(1.2, kCertain));
  EXPECT_FALSE(is_named(-0.3, kCertain));
  EXPECT_FALSE(is_named(0.3, 0.5));
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
