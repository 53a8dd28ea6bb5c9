#include "identification/solve/turning_points.h"

#include "identification/inference/turning_point_test.h"
#include "identification/stages.h"
#include "support/prelude.h"

// Turning points between samples: what an overshoot does to the forces, and when it is fitted.
namespace mindahl::identification::turning_points_test {
namespace {

using namespace loop;
using namespace models;

constexpr BranchLaw kLaw{4e7, 0.4, 40.0};
constexpr double kReach = 1.4e-6;  // [m]

/// Every n-th sample of a record: its extremes lie between them.
Record Sparse(const Record& dense, std::size_t begin, std::size_t every) {
  Record record;
  for (std::size_t i = begin; i < dense.size(); i += every) {
    record.displacement.push_back(dense.displacement[i]);
    record.force.push_back(dense.force[i]);
  }
  return record;
}

/// Strokes of growing, then falling size: inner loops that close on outer ones.
testing::History Nested() {
  testing::History history;
  double at = 0.0;
  for (const double end : {1.0, -0.9, 0.6, -0.3, 0.4, -0.8, 0.95}) {
    for (int i = 1; i <= 60; ++i) history.push_back(kReach * (at + (end - at) * i / 60));
    at = end;
  }
  return history;
}

/// A prior that is a million times as sharp as the record holds its parameter.
TEST(TurningPoints, PriorsAreInTheirFit) {
  const testing::History history = Nested();
  FitOptions options;
  const double stiffness = 1.02 * kLaw.tangential_stiffness;
  Stages stages(Sparse(MakeRecord(history, Respond(Model("mindlin-dahl"), kLaw, history)), 3, 7),
                options);
  const Solution start = stages.Solve();
  options.priors["sigma"] = {stiffness, 1e-9 * stiffness};
  stages.data.prior_noise = 1e-3;
  stages.problem.parameters =
      Parameters(stages.data, options, InitialState::kVirgin, Stages::Memory());
  Response response;
  const TurningPointFit fit = FitTurningPoints(
      stages.problem, start, std::vector<double>(LongestOvershoots(stages.data).size(), 0.0),
      SolverOptions{}, response);
  EXPECT_NEAR(fit.solution.theta[kStiffness],
              stages.problem.parameters[kStiffness].ToTheta(stiffness), 1e-6);
  EXPECT_GT(std::abs(start.theta[kStiffness] - fit.solution.theta[kStiffness]), 1e-3);
}

TEST(TurningPoints, ColumnsAreTheDerivativesByTheOvershoots) {
  constexpr double kStep = 1e-6;
  constexpr double kDifferences = 1e-5;  // of forces of order one: rounding over the step, twice
  for (const char* model : {"mindlin-dahl", "dahl"}) {
    for (const InitialState state : {InitialState::kVirgin, InitialState::kSteady}) {
      SCOPED_TRACE(std::string(model) + (state == InitialState::kVirgin ? ", virgin" : ", steady"));
      BranchLaw law = kLaw;
      if (std::string(model) == "dahl") law.shape_exponent = 1.0;
      const testing::History history = Nested();
      FitOptions options;
      options.model = &Model(model);
      // The second record of Masing's law bears three times the load.
      const bool is_series = std::string(model) == "mindlin-dahl";
      if (is_series) options.normal_loads = {20.0, 60.0};
      const Record sparse = Sparse(MakeRecord(history, Respond(Model(model), law, history)), 3, 7);
      Stages stages(std::vector<Record>(is_series ? 2 : 1, sparse), options, state);
      const Parameters& parameters = stages.problem.parameters;
      std::vector<double> theta;
      for (std::size_t p = 0; p < parameters.size(); ++p) theta.push_back(parameters[p].theta);
      theta[kStiffness] = parameters[kStiffness].ToTheta(law.tangential_stiffness);
      theta[kSlipForce] = parameters[kSlipForce].ToTheta(law.slip_force);
      theta[kShape] = law.shape_exponent;
      // Unloaded off the middle: else the second extreme is the mirror of the first, and the
      // contact there at the corner where it comes back to its virgin curve.
      for (std::size_t r = 0; r < stages.data.records.size(); ++r) {
        theta[parameters.PositionOf("displacement_offset", r)] =
            state == InitialState::kVirgin ? -0.2 : 0.0;
      }
      std::vector<double> overshoot;
      for (const double longest : LongestOvershoots(stages.data)) {
        overshoot.push_back(0.3 * longest + 0.001 * static_cast<double>(overshoot.size()));
      }
      ASSERT_GE(overshoot.size(), 6U);
      const auto residuals = [&](const std::vector<double>& at) {
        const auto turned = PutInTurningPoints(stages.data, at);
        stages.problem.data = &turned->data;
        Eigen::VectorXd values = stages.ResidualsAt(theta);
        stages.problem.data = &stages.data;
        return values;
      };
      const auto turned = PutInTurningPoints(stages.data, overshoot);
      EXPECT_EQ(turned->data.records[0].size(),
                stages.data.records[0].size() + stages.data.records[0].reversals.size());
      stages.problem.data = &turned->data;
      Response response;
      response.Bind(stages.problem);
      const TurningPointColumns columns(stages.problem, theta, response);
      const Eigen::MatrixXd exact(columns.columns());
      stages.problem.data = &stages.data;
      double largest = 0.0;
      for (std::size_t k = 0; k < overshoot.size(); ++k) {
        std::vector<double> above = overshoot;
        std::vector<double> below = overshoot;
        above[k] += kStep;
        below[k] -= kStep;
        const Eigen::VectorXd difference = (residuals(above) - residuals(below)) / (2 * kStep);
        const Eigen::VectorXd column = exact.col(static_cast<Eigen::Index>(k));
        EXPECT_LT((column - difference).cwiseAbs().maxCoeff(), kDifferences) << k;
        largest = std::max(largest, column.cwiseAbs().maxCoeff());
      }
      EXPECT_GT(largest, 0.1) << "there is something to see";
      // What they explain is taken off a column to rounding.
      Eigen::VectorXd explained = exact.col(1) + 0.5 * exact.col(2);
      columns.ProjectOut(explained);
      EXPECT_LT(explained.norm(), 1e-7);
    }
  }
}

/// How far beyond the outermost sample of a motion its turning points are said to lie, on average
/// over those of a record of 10 cycles whose extremes fall anywhere between samples, less the
/// truth.
double LargestErrorOfOvershoot(Wave wave, int samples_a_cycle) {
  constexpr int kFine = 64;
  constexpr double kCycles = 10.0;
  double largest = 0.0;
  for (std::size_t begin = 0; begin < kFine; begin += 5) {
    const auto displacement = Cycling(wave, kReach, kCycles, samples_a_cycle * kFine);
    const Record record = Sparse(
        MakeRecord(displacement, Respond(Model("mindlin-dahl"), kLaw, displacement)), begin, kFine);
    const Stages stages(record);
    const ScaledRecord& scaled = stages.data.records[0];
    const auto [least, greatest] = std::ranges::minmax(displacement);
    for (std::size_t k = 0; k < scaled.reversals.size(); ++k) {
      const double sample = record.displacement[scaled.reversals[k]];
      const double truth = sample > 0 ? greatest - sample : sample - least;
      const double said = OvershootOfMotion(scaled, k) * stages.data.length;
      largest = std::max(largest, std::abs(said - truth) / kReach);
    }
  }
  return largest;
}

TEST(TurningPoints, OfASmoothMotionAreThoseOfThePolynomialThroughFiveSamples) {
  for (const int samples : {12, 25, 50}) {
    const double step = 2 * M_PI / samples;
    EXPECT_LT(LargestErrorOfOvershoot(Wave::kSine, samples), std::pow(step, 6) / 200) << samples;
  }
}

TEST(TurningPoints, OfASharpMotionAreWhereItsLinesMeet) {
  constexpr double kRounding = 1e-9;  // of differences of samples over small differences of slopes
  EXPECT_LT(LargestErrorOfOvershoot(Wave::kTriangle, 24), kRounding);
}

TEST(TurningPoints, BetweenSamplesLeaveIntervalsTheirCoverage) {
  // 25 samples a cycle, 1 % noise: the outermost samples for turning points would leave Tc's
  // intervals 48 to 90 % (0.3 and 1 % noise). 95 % of 200, less three standard deviations.
  constexpr int kLoops = 200;
  constexpr double kLeast = 0.95 - 3 * 0.0154;
  const auto dense = Cycling(Wave::kSine, kReach, 3.0, 25 * 64);
  const Record exact =
      Sparse(MakeRecord(dense, Respond(Model("mindlin-dahl"), kLaw, dense)), 0, 64);
  for (const double noise : {0.003, 0.01}) {
    Generator generator(3);
    int covered = 0;
    Fitter fitter;
    for (int k = 0; k < kLoops; ++k) {
      const Record record = WithForceNoise(exact, noise * kLaw.slip_force, generator);
      const ParameterEstimate& estimate =
          *fitter.Fit(RecordView(record), Depth::kErrors).Find("slip_force");
      if (estimate.lower95 <= kLaw.slip_force && kLaw.slip_force <= estimate.upper95) ++covered;
    }
    EXPECT_GE(covered, kLeast * kLoops) << noise;
  }
}

TEST(TurningPoints, OfMoreThanTwoHundredReversalsAreFitted) {
  const auto displacement = Cycling(Wave::kSine, kReach, 110.0, 160);
  const Record record =
      Sparse(MakeRecord(displacement, Respond(Model("mindlin-dahl"), kLaw, displacement)), 1, 8);
  FitOptions options;
  options.initial_state = InitialState::kVirgin;
  const RecordView view = record;
  Fitter fitter(options);
  const FitResult& fit = fitter.Fit(view, Depth::kEstimate);
  ASSERT_GT(fit.records[0].reversals.size(), 200U);
  EXPECT_EQ(fit.records[0].overshoot.size(), fit.records[0].reversals.size());
  EXPECT_NEAR(fit.law.tangential_stiffness / kLaw.tangential_stiffness, 1.0, testing::kNoiseFree);
  EXPECT_NEAR(fit.law.slip_force / kLaw.slip_force, 1.0, testing::kNoiseFree);
}

TEST(TurningPoints, PayForAParameterEach) {
  // Noise alone gains some 2 ln Λ = 6 by six overshoots, and is to gain 12: the samples, of which
  // no more are independent, bound what it has gained.
  Thresholds anything;
  anything.turning_point_chance = 0.9;
  const auto displacement = Cycling(Wave::kTriangle, kReach, 3.0, 80);
  const auto force = Respond(Model("mindlin-dahl"), kLaw, displacement);
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    Generator generator(seed);
    Record record = MakeRecord(displacement, force);
    for (double& value : record.force) value += 0.5 * Normal(generator);
    FitOptions options;
    options.initial_state = InitialState::kVirgin;
    Stages stages(record, options);
    const Solution best = stages.Solve();
    ASSERT_EQ(stages.data.records[0].reversals.size(), 6U);
    stages.options.thresholds = anything;
    const auto turned =
        FitTurningPointsIfNeeded(stages.problem, best, stages.options, stages.buffers);
    if (!turned || !turned->records->data.turns_are_fitted) continue;
    const auto samples = static_cast<double>(stages.data.counted);
    EXPECT_GT(samples * std::log(best.sum_of_squares / turned->solution.sum_of_squares), 12.0);
  }
}

TEST(TurningPoints, NeedTwoSamplesThatCountAParameter) {
  // Six reversals and five parameters: 22 samples that count at the least. The others still move.
  const auto displacement = Cycling(Wave::kSine, kReach, 3.0, 160);
  const Record record =
      Sparse(MakeRecord(displacement, Respond(Model("mindlin-dahl"), kLaw, displacement)), 1, 8);
  for (const std::size_t counting : {21U, 22U, 40U}) {
    FitOptions options;
    options.initial_state = InitialState::kVirgin;
    options.preparation.held_out = {std::vector<bool>(record.size(), true)};
    for (std::size_t i = 0; i < counting; ++i) {
      options.preparation.held_out[0][i * record.size() / counting] = false;
    }
    Stages stages(record, options);
    const Solution best = stages.Solve();
    ASSERT_EQ(stages.data.counted, counting);
    ASSERT_EQ(stages.data.records[0].reversals.size(), 6U);
    ASSERT_EQ(stages.problem.parameters.free().size(), 5U);
    Thresholds anything;
    anything.turning_point_chance = 0.9;
    stages.options.thresholds = anything;
    const auto turned =
        FitTurningPointsIfNeeded(stages.problem, best, stages.options, stages.buffers);
    const bool fitted = turned && turned->records->data.turns_are_fitted;
    if (counting < 22) {
      EXPECT_FALSE(fitted);
    } else if (counting >= 40) {
      EXPECT_TRUE(fitted);
    }
  }
}

TEST(TurningPoints, ThatWouldLieInsideAreRefusedAfterAll) {
  // Outermost samples that read too far out: a linear step would turn before them, which no
  // overshoot may.
  const auto displacement = Cycling(Wave::kSine, kReach, 3.0, 160);
  Record record = MakeRecord(displacement, Respond(Model("mindlin-dahl"), kLaw, displacement));
  for (std::size_t i = 40; i < record.size(); i += 80) {
    record.displacement[i] += std::copysign(0.02 * kReach, record.displacement[i]);
  }
  Stages stages(record);
  const Solution best = stages.Solve();
  const std::vector<double> at_samples(LongestOvershoots(stages.data).size(), 0.0);
  const TurningPointStep step =
      StepTurningPoints(stages.problem, best, at_samples, stages.buffers.response);
  EXPECT_LT(step.left.squaredNorm(), 0.5 * best.sum_of_squares) << "the step is tempting";
  EXPECT_FALSE(FitTurningPointsIfNeeded(stages.problem, best, stages.options, stages.buffers));
}

}  // namespace
}  // namespace mindahl::identification::turning_points_test
