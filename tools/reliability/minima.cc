#include "minima.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "core/draws.h"
#include "mindahl/core/error.h"
#include "mindahl/identification/ceres_problem.h"
#include "mindahl/identification/fit.h"
#include "mindahl/loop/reversals.h"
#include "mindahl/models/response.h"
#include "simulation.h"

namespace mindahl::reliability {
namespace {

using identification::CeresParameter;
using identification::CeresProblem;
using identification::FitOptions;
using identification::FitResult;
using loop::Record;

constexpr int kRandomStarts = 10;
constexpr double kSameCost = 1e-6;

struct MinimumProblem {
  std::vector<Record> records;
  FitOptions options;
  models::BranchLaw law;
  double noise = 0.0;                    // [N] of the loudest record
  std::map<std::string, double> others;  // true values besides the law's; 0 where not named
};

/// α as hard problems have it: near both corners as often as between.
double HardShape(Draws& draws) {
  switch (draws.Index(4)) {
    case 0:
      return draws.Uniform(0.0, 0.06);
    case 1:
      return 1.0 / 3;
    case 2:
      return draws.Uniform(1.0, 1.5);
    default:
      return draws.Uniform(0.1, 1.0);
  }
}

models::BranchLaw HardLaw(Draws& draws) {
  return {draws.LogUniform(1e4, 1e9), HardShape(draws), draws.LogUniform(1e-2, 1e4)};
}

/// Adds a record: cycles of an amplitude [m], with white noise of the force [N].
Record& AddRecord(const models::FrictionModel& model, const models::BranchLaw& law,
                  double amplitude, double noise, bool virgin, Draws& draws,
                  MinimumProblem& problem) {
  constexpr std::size_t kSamples = 160;  // a cycle
  const std::size_t unseen = virgin ? 0 : kSamples + draws.Index(kSamples);
  const double cycles = static_cast<double>(unseen + 2 * kSamples) / kSamples;
  models::ExcitationOptions sine;
  sine.amplitude = amplitude;
  sine.cycles = cycles;
  sine.samples_per_cycle = kSamples;
  const models::Excitation excitation = models::MakeExcitation(sine);
  Record whole;
  whole.displacement = excitation.displacement;
  whole.force.resize(whole.displacement.size());
  const models::LoadingPath path = models::MakeLoadingPath(
      whole.displacement, loop::FindReversals(whole.displacement, 0.0), model.memory, {});
  models::EvaluateForce(model, law, path, whole.displacement, whole.force);
  for (double& force : whole.force) force += noise * draws.Normal();
  problem.noise = std::max(problem.noise, noise);
  return problem.records.emplace_back(Part(whole, unseen, whole.size()));
}

/// One record of a law, with options of its model.
MinimumProblem OneRecord(const char* model, const models::BranchLaw& law, double reach,
                         double noise_over_peak, bool virgin, Draws& draws) {
  MinimumProblem problem;
  problem.law = law;
  problem.options.model = models::FindFrictionModel(model);
  const double amplitude = reach * SlipDisplacement(law);
  const double noise = noise_over_peak * law.slip_force * std::min(1.0, reach);
  AddRecord(*problem.options.model, law, amplitude, noise, virgin, draws, problem);
  problem.options.initial_state =
      virgin ? models::InitialState::kVirgin : models::InitialState::kSteady;
  return problem;
}

MinimumProblem Plain(Draws& draws) {
  return OneRecord("mindlin-dahl", HardLaw(draws), draws.LogUniform(0.8, 4.0),
                   draws.LogUniform(1e-3, 0.05), false, draws);
}

MinimumProblem PartialSlip(Draws& draws) {
  return OneRecord("mindlin-dahl", HardLaw(draws), draws.LogUniform(0.05, 0.7),
                   draws.LogUniform(1e-3, 0.05), false, draws);
}

MinimumProblem VirginWithFreeOrigin(Draws& draws) {
  return OneRecord("mindlin-dahl", HardLaw(draws), draws.LogUniform(0.2, 3.0),
                   draws.LogUniform(1e-3, 0.05), true, draws);
}

MinimumProblem SeveralAmplitudes(Draws& draws) {
  MinimumProblem problem = OneRecord("mindlin-dahl", HardLaw(draws), 1.0, 0.0, true, draws);
  Record& record = problem.records.front();
  models::ExcitationOptions growing;
  growing.waveform = models::Waveform::kGrowingSine;
  growing.amplitude = draws.LogUniform(0.3, 3.0) * SlipDisplacement(problem.law);
  growing.cycles = 4;
  growing.samples_per_cycle = 160;
  record.displacement = models::MakeExcitation(growing).displacement;
  record.force.resize(record.displacement.size());
  Masing(problem.law)(record.displacement, record.force);
  problem.noise = draws.LogUniform(1e-3, 0.05) * problem.law.slip_force;
  for (double& force : record.force) force += problem.noise * draws.Normal();
  return problem;
}

MinimumProblem Dahl(Draws& draws) {
  models::BranchLaw law = HardLaw(draws);
  if (draws.Index(2) == 0) law.shape_exponent = draws.Uniform(0.0, 0.05);
  return OneRecord("dahl", law, draws.LogUniform(0.2, 3.0), draws.LogUniform(1e-3, 0.05), true,
                   draws);
}

MinimumProblem Bounds(Draws& draws) {
  MinimumProblem problem = draws.Index(2) == 0 ? Plain(draws) : PartialSlip(draws);
  const models::BranchLaw& law = problem.law;
  switch (draws.Index(3)) {
    case 0:
      problem.options.bounds["alpha"] = {0.0, std::max(0.8 * law.shape_exponent, 0.05)};
      break;
    case 1:
      problem.options.bounds["slip_force"] = {0.1 * law.slip_force, 0.97 * law.slip_force};
      break;
    default:
      problem.options.bounds["sigma"] = {1.02 * law.tangential_stiffness,
                                         10 * law.tangential_stiffness};
  }
  return problem;
}

MinimumProblem Joint(Draws& draws) {
  MinimumProblem problem = VirginWithFreeOrigin(draws);
  for (std::size_t more = 1 + draws.Index(2); more > 0; --more) {
    AddRecord(*problem.options.model, problem.law,
              draws.LogUniform(0.2, 3.0) * SlipDisplacement(problem.law), problem.noise, true,
              draws, problem);
  }
  return problem;
}

MinimumProblem LoadSeries(Draws& draws) {
  constexpr double kMeanLoad = 100.0;  // [N]
  MinimumProblem problem;
  problem.law = HardLaw(draws);
  problem.law.shape_exponent = std::min(problem.law.shape_exponent, 0.9);
  const double exponent = draws.Uniform(0.0, 1.0);
  problem.others["load_exponent"] = exponent;
  problem.options.initial_state = models::InitialState::kVirgin;
  const double noise = draws.LogUniform(1e-3, 0.03) * problem.law.slip_force;
  for (const double ratio : {0.5, 1.0, 1.5}) {
    models::BranchLaw law = problem.law;
    law.slip_force *= ratio;
    law.tangential_stiffness *= std::pow(ratio, exponent);
    AddRecord(*problem.options.model, law, draws.LogUniform(0.3, 2.0) * SlipDisplacement(law),
              noise, true, draws, problem);
    problem.options.normal_loads.push_back(kMeanLoad * ratio);
  }
  return problem;
}

MinimumProblem Rig(Draws& draws) {
  MinimumProblem problem =
      OneRecord("mindlin-dahl", HardLaw(draws), draws.LogUniform(0.4, 3.0), 0.0, true, draws);
  Record& record = problem.records.front();
  const double stiffness = draws.LogUniform(0.3, 10.0) * problem.law.tangential_stiffness;
  problem.noise = draws.LogUniform(1e-3, 0.05) * problem.law.slip_force;
  for (std::size_t i = 0; i < record.size(); ++i) {
    record.displacement[i] += record.force[i] / stiffness;
    record.force[i] += problem.noise * draws.Normal();
  }
  problem.options.terms = {"rig_stiffness"};
  problem.others["rig_stiffness"] = stiffness;
  return problem;
}

struct MinimumKind {
  std::string_view name;
  MinimumProblem (*make)(Draws&);
};

constexpr std::array kMinimumKinds = {
    MinimumKind{"plain", Plain},
    MinimumKind{"partial slip", PartialSlip},
    MinimumKind{"virgin with free origin", VirginWithFreeOrigin},
    MinimumKind{"several amplitudes", SeveralAmplitudes},
    MinimumKind{"Dahl's law", Dahl},
    MinimumKind{"bounds", Bounds},
    MinimumKind{"joint", Joint},
    MinimumKind{"load exponent", LoadSeries},
    MinimumKind{"rig", Rig},
};

double TrueValue(const MinimumProblem& problem, const CeresParameter& parameter) {
  if (parameter.name == "sigma") return problem.law.tangential_stiffness;
  if (parameter.name == "alpha") return problem.law.shape_exponent;
  if (parameter.name == "slip_force") return problem.law.slip_force;
  const auto other = problem.others.find(parameter.name);
  return other != problem.others.end() ? other->second : 0.0;
}

void MoveTo(double theta, CeresParameter& parameter) {
  if (!parameter.fixed) parameter.theta = std::clamp(theta, parameter.lower, parameter.upper);
}

void StartAtTruth(const MinimumProblem& truth, CeresProblem& contact) {
  for (CeresParameter& parameter : contact.parameters()) {
    const double value = TrueValue(truth, parameter);
    if (!parameter.positive || value > 0) MoveTo(parameter.ThetaAt(value), parameter);
  }
}

void StartAnywhere(Draws& draws, CeresProblem& contact) {
  for (CeresParameter& parameter : contact.parameters()) {
    if (parameter.name == "alpha") {
      MoveTo(parameter.ThetaAt(draws.Uniform(0.02, 1.5)), parameter);
    } else {
      const double way = parameter.positive ? 1.5 : 0.3;
      MoveTo(parameter.theta + draws.Uniform(-way, way), parameter);
    }
  }
}

/// Σ r² where parameters are now.
double CostOf(CeresProblem& contact) {
  ceres::Problem problem;
  contact.AddTo(problem);
  double cost = 0.0;
  problem.Evaluate({}, &cost, nullptr, nullptr, nullptr);
  return 2 * cost;
}

/// The least Σ r² that ceres::Solve finds from where parameters are now. Where one ends at a bound,
/// along which ceres::Solve creeps, it is held there and the others are solved again.
double SolveFromHere(CeresProblem& contact) {
  double cost = std::numeric_limits<double>::infinity();
  for (const bool holds_bounds : {false, true}) {
    ceres::Problem problem;
    contact.AddTo(problem);
    bool any_held = false;
    for (CeresParameter& parameter : contact.parameters()) {
      const double gap =
          std::min(parameter.theta - parameter.lower, parameter.upper - parameter.theta);
      if (!holds_bounds || parameter.fixed || gap >= 1e-6) continue;
      problem.SetParameterBlockConstant(&parameter.theta);
      any_held = true;
    }
    if (holds_bounds && !any_held) break;
    ceres::Solver::Options search;
    search.linear_solver_type = ceres::DENSE_QR;
    search.max_num_iterations = 200;
    search.function_tolerance = 1e-13;
    search.parameter_tolerance = 1e-14;
    search.gradient_tolerance = std::numeric_limits<double>::min();
    search.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(search, &problem, &summary);
    if (summary.IsSolutionUsable()) cost = std::min(cost, 2 * summary.final_cost);
  }
  return cost;
}

bool IsCalledIdentifiable(const FitResult& fit) {
  return std::ranges::all_of(std::array{"sigma", "alpha", "slip_force"}, [&](const char* name) {
    const identification::ParameterEstimate* estimate = fit.Find(name);
    return estimate->status != identification::ParameterStatus::kFree ||
           estimate->identifiability == identification::Identifiability::kIdentifiable;
  });
}

void JudgeOne(const MinimumProblem& problem, Draws& draws, MinimaTally& tally) {
  FitOptions options = problem.options;
  options.preparation.force_sense = 1;
  const std::vector<loop::RecordView> views(problem.records.begin(), problem.records.end());
  const FitResult fit = identification::Fit(problem.records, options);
  ++tally.problems;
  if (!fit.converged) ++tally.not_converged;
  CeresProblem contact(views, options, fit, problem.noise);
  const double own = CostOf(contact);
  StartAtTruth(problem, contact);
  double judge = SolveFromHere(contact);
  for (int start = 0; start < kRandomStarts; ++start) {
    CeresProblem again(views, options, fit, problem.noise);
    StartAnywhere(draws, again);
    judge = std::min(judge, SolveFromHere(again));
  }
  if (judge > own * (1 + kSameCost)) ++tally.judge_worse;
  if (!(own > judge * (1 + kSameCost))) return;
  ++tally.worse;
  const double difference = own - judge;  // residuals are in units of the noise: 2 ln Λ
  tally.largest = std::max(tally.largest, difference);
  if (difference <= 1) return;
  ++tally.told;
  if (IsCalledIdentifiable(fit)) ++tally.told_and_identifiable;
}

}  // namespace

std::vector<std::string_view> KindsOfMinima() {
  std::vector<std::string_view> names;
  for (const MinimumKind& kind : kMinimumKinds) names.push_back(kind.name);
  return names;
}

MinimaTally MeasureMinima(std::string_view name, std::size_t problems, std::uint64_t seed) {
  const auto kind = std::ranges::find(kMinimumKinds, name, &MinimumKind::name);
  if (kind == kMinimumKinds.end())
    throw InvalidArgument("no kind of problem is " + std::string(name));
  MinimaTally tally{.kind = kind->name};
  for (std::size_t k = 0; k < problems; ++k) {
    Draws draws(seed + k);
    const MinimumProblem problem = kind->make(draws);
    JudgeOne(problem, draws, tally);
  }
  return tally;
}

}  // namespace mindahl::reliability
