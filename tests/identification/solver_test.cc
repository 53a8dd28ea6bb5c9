#include "identification/solve/solver.h"

#include <Eigen/Dense>

#include "identification/sample_loop.h"
#include "identification/stages.h"
#include "support/prelude.h"

// Variable projection against what it stands for: the least squares of all parameters.
namespace mindahl::identification::solver_test {
namespace {

/// The largest component of Jᵀr by unit columns, over |r|: 0 at a minimum.
double GradientAt(Stages& stages, const Solution& solution) {
  const Eigen::VectorXd residual = stages.ResidualsAt(solution.theta);
  const Eigen::MatrixXd jacobian = stages.DifferencesAt(solution.theta);
  const auto& free = stages.problem.parameters.free();
  double worst = 0.0;
  for (std::size_t j = 0; j < free.size(); ++j) {
    const std::size_t p = free[j];
    const BoundSide side = SideOf(stages.problem.parameters[p], solution.theta[p]);
    if (side != BoundSide::kInside) continue;
    const auto column = jacobian.col(static_cast<Eigen::Index>(j));
    worst = std::max(worst, std::abs(column.dot(residual)) / (column.norm() * residual.norm()));
  }
  return worst;
}

/// A step can lower the cost by 1e-10 of it at the most: cosines are 1e-5 at the most. Differences
/// are worse, by samples near slip, where the law's second derivative has no bound.
constexpr double kStationary = 1e-4;

TEST(Solver, LeavesNoGradientInAnyParameter) {
  Record record = Timed(NoisyLoop(4), 0.01);
  for (std::size_t i = 0; i < record.size(); ++i) record.force[i] += 0.5 * record.time[i];
  Generator generator(4);
  const Record sprung =
      WithForceNoise(testing::SprungLoop(kLaw, 2e8), 0.01 * kLaw.slip_force, generator);
  for (const std::vector<std::string>& terms : {std::vector<std::string>{},
                                                {"force_drift"},
                                                {"plateau_slope", "force_drift"},
                                                {"rig_stiffness"}}) {
    const bool has_rig = !terms.empty() && terms[0] == "rig_stiffness";
    Stages stages(has_rig ? sprung : record, {.terms = terms});
    const Solution solution = stages.Solve();
    EXPECT_TRUE(solution.converged);
    EXPECT_LT(GradientAt(stages, solution), kStationary) << (terms.empty() ? "" : terms[0]);
    EXPECT_NEAR(solution.sum_of_squares / stages.ResidualsAt(solution.theta).squaredNorm(), 1.0,
                1e-10);
  }
  Stages two(std::vector<Record>{NoisyLoop(4), testing::Scaled(NoisyLoop(9), 0.6, 0.9)});
  const Solution joint = two.Solve();
  EXPECT_LT(GradientAt(two, joint), kStationary);
}

TEST(Solver, ReachesTheSameMinimumInNaturalCoordinates) {
  // Bounds that the user gives on σ make the solver search σ and Tc themselves; wide ones change
  // nothing else.
  const Solution eliminated = Stages(NoisyLoop(4)).Solve();
  const Solution natural = Stages(NoisyLoop(4), {.bounds = {{"sigma", {1e6, 1e9}}}}).Solve();
  EXPECT_NEAR(natural.sum_of_squares / eliminated.sum_of_squares, 1.0, 1e-9);
  for (std::size_t p = 0; p < natural.theta.size(); ++p) {
    EXPECT_NEAR(natural.theta[p], eliminated.theta[p], 1e-4);
  }
}

TEST(Solver, HeldStiffnessRigOrSlipForceLeaveTheOthersAtTheirMinimum) {
  Generator generator(6);
  const Record record = WithForceNoise(testing::SprungLoop({4e7, 0.4, 40.0}, 6e7), 0.05, generator);
  struct Held {
    const char* name;
    double value;
    bool rig;
  };
  for (const auto& [name, value, rig] : {Held{"sigma", 3e7, false},
                                         {"slip_force", 39.0, false},
                                         {"rig_stiffness", 5e7, true},
                                         {"sigma", 3.5e7, true},
                                         {"slip_force", 39.5, true}}) {
    SCOPED_TRACE(std::string(name) + (rig ? " with a rig" : ""));
    FitOptions options;
    if (rig) options.terms = {"rig_stiffness"};
    options.fixed[name] = value;
    Stages stages(record, options);
    const Solution solution = stages.Solve();
    EXPECT_TRUE(solution.converged);
    const std::size_t p = stages.problem.parameters.PositionOf(FindTerm(name)->id);
    EXPECT_NEAR(stages.problem.parameters[p].ToValue(solution.theta[p]) / value, 1.0, 1e-14);
    EXPECT_LT(GradientAt(stages, solution), kStationary);
  }
}

TEST(Solver, EliminatedColumnStaysAtItsBoundAndTheRestIsRefitted) {
  const Record record = testing::Shifted(NoisyLoop(4), 0.0, 5.0);
  Stages stages(record, {.bounds = {{"force_offset", {-20.0, 3.0}}}});
  const Solution solution = stages.Solve();
  const std::size_t p = stages.problem.parameters.PositionOf(TermId::kForceOffset);
  EXPECT_EQ(SideOf(stages.problem.parameters[p], solution.theta[p]), BoundSide::kUpper);
  EXPECT_NEAR(stages.problem.parameters[p].ToValue(solution.theta[p]), 3.0, 1e-12);
  EXPECT_LT(GradientAt(stages, solution), kStationary) << "of the others";
  EXPECT_NEAR(Stages(record, {.fixed = {{"force_offset", 3.0}}}).Solve().sum_of_squares /
                  solution.sum_of_squares,
              1.0, 1e-9);
  // A bound of the slip force as well, which is eliminated too.
  Stages below(record, {.bounds = {{"slip_force", {1.0, 55.0}}}});
  const Solution at_bound = below.Solve();
  EXPECT_NEAR(below.problem.parameters[kSlipForce].ToValue(at_bound.theta[kSlipForce]), 55.0, 1e-7);
  EXPECT_EQ(SideOf(below.problem.parameters[kSlipForce], at_bound.theta[kSlipForce]),
            BoundSide::kUpper);
}

TEST(Starts, ThinnedRecordKeepsAllReversalsAndTheHistory) {
  Record record = Timed(NoisyLoop(4), 0.1);
  for (std::size_t i = 0; i < record.size(); ++i) {
    record.normal_load.push_back(100.0 + static_cast<double>(i % 7));
  }
  Stages stages(std::vector<Record>{record, testing::Scaled(record, 0.5, 0.5)});
  const ScaledRecords thin = Thinned(stages.data);
  ASSERT_EQ(thin.records.size(), 2U);
  std::size_t counted = 0;
  for (std::size_t r = 0; r < 2; ++r) {
    const ScaledRecord& whole = stages.data.records[r];
    const ScaledRecord& part = thin.records[r];
    EXPECT_LT(part.size(), whole.size() / 2);
    ASSERT_EQ(part.reversals.size(), whole.reversals.size());
    for (std::size_t j = 0; j < whole.reversals.size(); ++j) {
      EXPECT_EQ(part.displacement[part.reversals[j]], whole.displacement[whole.reversals[j]]);
      EXPECT_EQ(part.force[part.reversals[j]], whole.force[whole.reversals[j]]);
    }
    EXPECT_EQ(part.displacement.front(), whole.displacement.front());
    EXPECT_EQ(part.displacement.back(), whole.displacement.back());
    EXPECT_EQ(part.load_ratio.size(), part.size());
    EXPECT_EQ(part.velocity.size(), part.size());
    for (const unsigned char counts : part.counts) counted += counts;
  }
  EXPECT_EQ(thin.counted, counted);
  EXPECT_EQ(thin.samples(), thin.records[0].size() + thin.records[1].size());
}

}  // namespace
}  // namespace mindahl::identification::solver_test
