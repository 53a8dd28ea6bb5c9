#include "mindahl/identification/ceres_problem.h"

#include <ceres/ceres.h>
#include <ceres/gradient_checker.h>
#include <fmt/format.h>

#include "identification/sample_loop.h"
#include "mindahl/identification/fit.h"
#include "mindahl/identification/terms.h"
#include "recovery/recovered.h"
#include "support/prelude.h"

// The unprojected problem as Ceres sees it: its gradients, and its minimum beside the fit's.
namespace mindahl::identification::ceres_problem_test {
namespace {

/// A loop with time, half of it in partial slip; dense enough for no turn between the samples.
Record TimedLoop(const std::string& model, double reach, std::uint64_t seed, double noise = 0.01) {
  const FrictionModel& friction = Model(model);
  BranchLaw law = kLaw;
  if (friction.shape_exponent) law.shape_exponent = *friction.shape_exponent;
  const testing::History displacement = Cycling(Wave::kSine, reach * testing::kReach, 2.0, 240);
  Generator generator(seed);
  return Timed(WithForceNoise(MakeRecord(displacement, Respond(friction, law, displacement)),
                              noise * law.slip_force, generator),
               0.01);
}

FitOptions OptionsOf(const std::string& model, std::string_view group) {
  FitOptions options{.model = &Model(model),
                     .initial_state = InitialState::kVirgin,
                     .preparation = {.force_sense = 1}};
  if (group.empty()) return options;
  const std::vector<std::string_view>& terms = FindTermGroup(group)->terms;
  options.terms.assign(terms.begin(), terms.end());
  return options;
}

/// The terms that a fit may be asked for; "" for the law alone.
std::vector<std::string_view> TermsToAskFor() {
  std::vector<std::string_view> names = {""};
  for (const TermGroup& group : TermGroups()) names.push_back(group.name);
  return names;
}

class OfEveryLaw : public ::testing::TestWithParam<const char*> {};

TEST_P(OfEveryLaw, GradientsAgreeWithDifferences) {
  const std::string model = GetParam();
  const Record record = TimedLoop(model, 0.7, 3);
  const RecordView view(record);
  for (const std::string_view term : TermsToAskFor()) {
    SCOPED_TRACE(term);
    const FitOptions options = OptionsOf(model, term);
    Fitter fitter(options);
    const FitResult& fit = fitter.Fit(view, Depth::kEstimate);
    ASSERT_TRUE(fit.converged);
    CeresProblem problem({&view, 1}, options, fit, kLaw.slip_force);
    // Off the minimum, and off the neutral value of the term.
    for (CeresParameter& parameter : problem.parameters()) {
      if (!parameter.fixed) parameter.theta += 0.003;
      // The lower bound of α is 0: a central difference needs a point below α.
      if (parameter.name == "alpha") parameter.theta = std::max(parameter.theta, 0.05);
    }
    ceres::Problem of_contact;
    problem.AddTo(of_contact);
    std::vector<ceres::ResidualBlockId> residuals;
    of_contact.GetResidualBlocks(&residuals);
    std::vector<double*> blocks;
    of_contact.GetParameterBlocksForResidualBlock(residuals.front(), &blocks);
    const std::vector<const ceres::Manifold*> manifolds(blocks.size(), nullptr);
    ceres::NumericDiffOptions differences;
    differences.ridders_relative_initial_step_size = 1e-5;
    const ceres::GradientChecker checker(
        of_contact.GetCostFunctionForResidualBlock(residuals.front()), &manifolds, differences);
    ceres::GradientChecker::ProbeResults results;
    checker.Probe(blocks.data(), 1.0, &results);
    // Ridders' differences have nine digits where the response is smooth. Samples that a step
    // carries over a corner have none: those where slip begins, and under a lag, which moves
    // samples along straight lines between readings, all that pass a reading.
    const double tolerance = term == "lag" || model == "jenkins" ? 2e-2 : 1e-3;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      const double norm = results.jacobians[b].norm();
      EXPECT_LE((results.jacobians[b] - results.numeric_jacobians[b]).norm(),
                tolerance * std::max(norm, 1e-3))
          << "block " << b << ", norm " << norm;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(CeresProblem, OfEveryLaw,
                         ::testing::Values("mindlin-dahl", "mindlin", "jenkins", "dahl"),
                         [](const auto& instance) {
                           std::string name(instance.param);
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

/// Solves the unprojected problem and returns Σ r². Where a parameter ends at a bound, ceres::Solve
/// creeps along it: it is held there and the others are solved again.
double SolveUnprojected(CeresProblem& contact) {
  double cost = 0.0;
  for (const bool holds_bounds : {false, true}) {
    ceres::Problem problem;
    contact.AddTo(problem);
    for (CeresParameter& parameter : contact.parameters()) {
      const double gap =
          std::min(parameter.theta - parameter.lower, parameter.upper - parameter.theta);
      if (holds_bounds && !parameter.fixed && gap < 1e-6) {
        problem.SetParameterBlockConstant(&parameter.theta);
      }
    }
    ceres::Solver::Options search;
    search.linear_solver_type = ceres::DENSE_QR;
    search.max_num_iterations = 2000;
    search.function_tolerance = 1e-16;
    search.parameter_tolerance = 1e-16;
    search.gradient_tolerance = 1e-300;
    search.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(search, &problem, &summary);
    EXPECT_TRUE(summary.IsSolutionUsable()) << summary.message;
    cost = 2 * summary.final_cost;
  }
  return cost;
}

/// The least of the minima that are found from the fit's end and from beside it.
double JudgeCost(std::span<const RecordView> views, const FitOptions& options,
                 const FitResult& fit) {
  double least = std::numeric_limits<double>::infinity();
  for (const double step : {0.0, 0.02}) {
    CeresProblem contact(views, options, fit);
    for (CeresParameter& parameter : contact.parameters()) {
      if (parameter.fixed) continue;
      parameter.theta = std::clamp(parameter.theta + step, parameter.lower, parameter.upper);
    }
    least = std::min(least, SolveUnprojected(contact));
  }
  return least;
}

TEST(CeresProblem, MinimumIsThatOfTheFit) {
  // Both stop where a step gains less than 1e-10 of the cost.
  constexpr double kSameMinimum = 1e-8;
  struct Kind {
    const char* model;
    const char* term;
    double reach;
    bool bounded = false;
    bool joint = false;
  };
  const std::vector<Kind> kinds = {
      {"mindlin-dahl", "", 1.0},
      {"mindlin-dahl", "", 0.75},
      {"mindlin", "", 1.0},
      {"dahl", "", 1.0},
      {"mindlin-dahl", "viscous", 1.0},
      {"mindlin-dahl", "plateau_slope", 1.5},
      {"mindlin-dahl", "force_drift", 1.0},
      {"mindlin", "rig_stiffness", 1.0},
      {"mindlin-dahl", "", 1.0, true},
      {"mindlin-dahl", "", 1.0, false, true},
  };
  for (const Kind& kind : kinds) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      SCOPED_TRACE(std::string(kind.model) + " " + kind.term + " seed " + std::to_string(seed));
      std::vector<Record> records = {TimedLoop(kind.model, kind.reach, seed)};
      if (kind.joint) records.push_back(TimedLoop(kind.model, 0.6, seed + 100));
      FitOptions options = OptionsOf(kind.model, kind.term);
      if (kind.bounded) options.bounds["alpha"] = {0.0, 0.3};  // the true value is beyond it
      const std::vector<RecordView> views(records.begin(), records.end());
      Fitter fitter(options);
      const FitResult& fit = fitter.Fit(views, Depth::kEstimate);
      ASSERT_TRUE(fit.converged) << fit.solver.message;
      if (kind.bounded) {
        EXPECT_EQ(fit.solver.solver, "solve");
      }
      const double judge = JudgeCost(views, options, fit);
      EXPECT_NEAR(2 * fit.solver.final_cost / judge, 1.0, kSameMinimum);
    }
  }
}

// Ceres writes a page to the standard error of a residual or derivative that is no number.
TEST(CeresProblem, SaysWhereItHasNoValueInsteadOfReturningIt) {
  const Record record = TimedLoop("mindlin-dahl", 1.0, 1);
  const RecordView view(record);
  int refused = 0;
  for (const loop::Channel response : {loop::Channel::kForce, loop::Channel::kDisplacement}) {
    FitOptions options = OptionsOf("mindlin-dahl", "");
    options.preparation.excitation =
        response == loop::Channel::kForce ? loop::Channel::kDisplacement : loop::Channel::kForce;
    Fitter fitter(options);
    CeresProblem contact({&view, 1}, options, fitter.Fit(view, Depth::kEstimate));
    ceres::Problem problem;
    contact.AddTo(problem);
    for (CeresParameter& parameter : contact.parameters()) {
      const double start = parameter.theta;
      for (const double theta : {-750.0, -709.0, -400.0, 400.0, 709.0, 750.0}) {
        SCOPED_TRACE(fmt::format("{} = {}", parameter.name, theta));
        parameter.theta = theta;
        double cost = 0.0;
        std::vector<double> residuals;
        std::vector<double> gradient;
        ceres::CRSMatrix jacobian;
        ::testing::internal::CaptureStderr();
        const bool has_value = problem.Evaluate({}, &cost, &residuals, &gradient, &jacobian);
        EXPECT_THAT(::testing::internal::GetCapturedStderr(), IsEmpty());
        refused += has_value ? 0 : 1;
        EXPECT_TRUE(!has_value || std::ranges::all_of(jacobian.values, [](double value) {
          return std::isfinite(value);
        }));
      }
      parameter.theta = start;
    }
  }
  EXPECT_GT(refused, 0);
}

TEST(CeresProblem, RefusesANameThatItDoesNotHave) {
  const Record record = TimedLoop("mindlin-dahl", 1.0, 1);
  const FitOptions options = OptionsOf("mindlin-dahl", "");
  const RecordView view(record);
  Fitter fitter(options);
  CeresProblem problem({&view, 1}, options, fitter.Fit(view, Depth::kEstimate));
  EXPECT_THROW(static_cast<void>(problem.Find("stiffness")), InvalidArgument);
  EXPECT_THROW(CeresProblem({&view, 1}, options, fitter.Fit(view, Depth::kEstimate), 0.0),
               InvalidArgument);
}

TEST(CeresProblem, BeginsAtTheFitAndHoldsWhatTheOptionsHold) {
  const Record record = TimedLoop("mindlin-dahl", 1.0, 1);
  const RecordView view(record);
  Fitter fitter(OptionsOf("mindlin-dahl", ""));
  const FitResult& fit = fitter.Fit(view, Depth::kEstimate);
  FitOptions held = OptionsOf("mindlin-dahl", "");
  held.fixed["alpha"] = 0.125;
  held.bounds["slip_force"] = {0.1 * kLaw.slip_force, 0.5 * kLaw.slip_force};
  CeresProblem problem({&view, 1}, held, fit);
  EXPECT_NEAR(problem.Find("sigma").Value() / fit.Find("sigma")->value, 1.0, 1e-12);
  EXPECT_TRUE(problem.Find("alpha").fixed);
  EXPECT_NEAR(problem.Find("alpha").Value(), 0.125, 1e-12);
  EXPECT_NE(fit.Find("alpha")->value, 0.125);
  // An estimate beyond a bound begins at the bound.
  EXPECT_NEAR(problem.Find("slip_force").Value() / (0.5 * kLaw.slip_force), 1.0, 1e-12);
}

}  // namespace
}  // namespace mindahl::identification::ceres_problem_test
