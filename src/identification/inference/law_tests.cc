#include "identification/inference/law_tests.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory_resource>
#include <span>
#include <utility>
#include <vector>

#include "core/probability.h"
#include "identification/dense.h"
#include "identification/inference/local.h"
#include "identification/inference/noise.h"
#include "mindahl/identification/fit_result.h"
#include "mindahl/models/steady_loop.h"

namespace mindahl::identification {

namespace {

/// Compares fits that differ in α.
Evidence EvidenceOfShape(const Noise& noise, const Estimates& estimates) {
  return {noise.samples, static_cast<double>(noise.samples) * estimates.WhiteShare(kShape)};
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

bool ContradictsInterval(const MindlinTest& test, const ParameterEstimate& alpha,
                         double confidence) {
  if (!alpha.lower95 || !alpha.upper95) return false;
  const bool is_excluded = kMindlinExponent < *alpha.lower95 || kMindlinExponent > *alpha.upper95;
  return is_excluded && test.p_value > 1 - confidence;
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

using models::FrictionModel;
using models::InitialState;
using models::Memory;

namespace {

/// Returns the law of the other kind; α stays as it is held.
const FrictionModel& OtherModel(const FrictionModel& model) {
  return *models::FindFrictionModel(model.memory == Memory::kReturnPoint ? "dahl" : "mindlin-dahl");
}

/// True if the two laws can have a σ and a Tc of their own: not before the motion turns; σ and Tc
/// that the user holds are of one law only.
bool AreComparable(const Problem& problem) {
  // Dahl's own law does not model a load that varies.
  if (problem.data->load_varies) return false;
  // Nor of slip forces that differ: its directions would differ in stiffness too.
  if (problem.parameters.has_asymmetry()) return false;
  if (std::ranges::all_of(problem.data->records,
                          [](const ScaledRecord& record) { return record.reversals.empty(); })) {
    return false;
  }
  for (const std::size_t p : {kStiffness, kSlipForce}) {
    if (problem.parameters[p].fixed || problem.parameters[p].bounded_by_user) return false;
  }
  return true;
}

/// Returns the law whose steady loop at the record's amplitude is the fitted one.
models::BranchLaw EquivalentOf(const FitResult& result) {
  const double amplitude =
      ContactAmplitude(result, result.law, result.WidestRecord().measures.amplitude);
  return result.model->memory == Memory::kReturnPoint
             ? models::DahlEquivalent(result.law, amplitude)
             : models::MasingEquivalent(result.law, amplitude);
}

/// A cost to 1e-4 determines 2 ln Λ to 1e-4 of the samples: enough where the other law is far off.
SolverOptions RoughlyAs(const FitOptions& options) {
  constexpr double kCost = 1e-4;
  constexpr double kStep = 1e-6;
  SolverOptions rough = SolverOptionsOf(options);
  rough.function_tolerance = std::max(rough.function_tolerance, kCost);
  rough.parameter_tolerance = std::max(rough.parameter_tolerance, kStep);
  return rough;
}

/// Fits the other law roughly, from that of the same steady loop and from the fitted one.
OtherFit FitOther(const Problem& problem, const Solution& best, const FitResult& result,
                  const models::BranchLaw& equivalent, const RecordStates& state,
                  const FitOptions& options, SearchBuffers& buffers) {
  FitOptions others = options;
  others.model = &OtherModel(*problem.model);
  others.start.clear();
  if (problem.parameters[kShape].fixed) others.fixed["alpha"] = result.law.shape_exponent;
  OtherFit other{
      Problem{problem.data, others.model, state,
              Parameters(*problem.data, others, state, std::pmr::get_default_resource())},
      {}};
  const Parameters& parameters = other.problem.parameters;
  other.solution.sum_of_squares = std::numeric_limits<double>::infinity();
  buffers.solver.Bind(other.problem, buffers.response);
  for (const models::BranchLaw& law : {equivalent, result.law}) {
    std::vector<double> theta;
    theta.reserve(parameters.size());
    for (std::size_t p = 0; p < parameters.size(); ++p) {
      // The same terms, but for the origins of a virgin contact.
      theta.push_back(state == problem.state ? best.theta[p] : parameters[p].theta);
    }
    theta[kStiffness] = parameters[kStiffness].ToTheta(law.tangential_stiffness);
    theta[kShape] = parameters[kShape].ToTheta(law.shape_exponent);
    theta[kSlipForce] = parameters[kSlipForce].ToTheta(law.slip_force);
    theta[kRig] = best.theta[kRig];
    buffers.solver.Solve(theta, RoughlyAs(options), buffers.scratch);
    if (buffers.scratch.sum_of_squares < other.solution.sum_of_squares) {
      std::swap(other.solution, buffers.scratch);
    }
  }
  return other;
}

void Polish(const FitOptions& options, SearchBuffers& buffers, OtherFit& other) {
  buffers.solver.Bind(other.problem, buffers.response);
  buffers.solver.Solve(other.solution.theta, SolverOptionsOf(options), buffers.scratch);
  if (buffers.scratch.sum_of_squares <= other.solution.sum_of_squares) {
    std::swap(other.solution, buffers.scratch);
  }
}

double CriterionOf(const Evidence& evidence, const Problem& problem, const Solution& solution) {
  return evidence.Aicc(solution.sum_of_squares, problem.parameters.free().size());
}

/// True if a record starts inside the range of its strokes: then it may be virgin.
bool StartsInside(const ScaledRecord& record) {
  const auto [low, high] = std::ranges::minmax(record.excitation());
  const double start = record.excitation().front();
  constexpr double kInside = 0.1;  // of the range: what is nearer has turned there
  return std::min(start - low, high - start) > kInside * (high - low);
}

}  // namespace

bool HasOneAmplitude(const Problem& problem, const Thresholds& thresholds) {
  double widest = 0.0;
  double narrowest = std::numeric_limits<double>::infinity();
  double longest_end = 0.0;
  for (const ScaledRecord& record : problem.data->records) {
    const auto at = [&](std::size_t reversal) {
      return record.excitation()[record.reversals[reversal]];
    };
    if (record.reversals.empty()) return false;
    for (std::size_t j = 1; j < record.reversals.size(); ++j) {
      const double swing = std::abs(at(j) - at(j - 1));
      widest = std::max(widest, swing);
      narrowest = std::min(narrowest, swing);
    }
    longest_end =
        std::max({longest_end, std::abs(at(0) - record.excitation().front()),
                  std::abs(record.excitation().back() - at(record.reversals.size() - 1))});
  }
  const double wider = (1 + thresholds.one_amplitude) * narrowest;
  return widest <= wider && longest_end <= wider;
}

bool LawIsUndecided(double delta_aicc, const Thresholds& thresholds) {
  return std::abs(delta_aicc) < thresholds.rival_law;
}

std::optional<LawChoice> CompareLaws(const Problem& problem, const Solution& best,
                                     const FitResult& result, const FitOptions& options,
                                     SearchBuffers& buffers) {
  if (!AreComparable(problem) || result.law.shape_exponent <= options.thresholds.jenkins_shape) {
    return std::nullopt;
  }
  const FrictionModel& alternative = OtherModel(*problem.model);
  const models::BranchLaw equivalent = EquivalentOf(result);
  LawChoice choice;
  choice.alternative = &alternative;
  choice.law = equivalent;
  // On a steady loop the other law is the same curve; a record that may be virgin is tried as such.
  const bool same_curve =
      problem.state.AreAll(InitialState::kSteady) && HasOneAmplitude(problem, options.thresholds);
  const bool is_open = !options.initial_state && options.initial_states.empty();
  const bool maybe_virgin = problem.state.AreAll(InitialState::kSteady) && is_open &&
                            std::ranges::any_of(problem.data->records, StartsInside);
  std::vector<RecordStates> states;
  if (!same_curve) states.push_back(problem.state);
  if (maybe_virgin) states.emplace_back(InitialState::kVirgin);
  // A record that starts at an extreme passes for virgin as well, without a virgin branch.
  const bool is_origin_given = std::ranges::any_of(options.fixed, [&](const auto& fixed) {
    return fixed.first.starts_with(OriginTerm(problem.data->excitation));
  });
  if (problem.state.AreAll(InitialState::kVirgin) && is_open && !is_origin_given) {
    states.emplace_back(InitialState::kSteady);
  }
  const double samples_of_best =
      states.empty() ? 0.0 : EffectiveSamples(problem, best.theta, buffers.response);
  for (const RecordStates& state : states) {
    OtherFit other = FitOther(problem, best, result, equivalent, state, options, buffers);
    const auto evidence_of = [&] {
      const bool is_better = other.solution.sum_of_squares < best.sum_of_squares;
      return Evidence(problem.data->counted,
                      is_better
                          ? EffectiveSamples(other.problem, other.solution.theta, buffers.response)
                          : samples_of_best);
    };
    const auto delta_by = [&](const Evidence& evidence) {
      return CriterionOf(evidence, other.problem, other.solution) -
             CriterionOf(evidence, problem, best);
    };
    Evidence evidence = evidence_of();
    double delta = delta_by(evidence);
    if (delta < 0 || LawIsUndecided(delta / 2, options.thresholds)) {
      Polish(options, buffers, other);
      evidence = evidence_of();
      delta = delta_by(evidence);
    }
    if (!other.solution.converged) continue;
    // If the laws are one curve, a virgin start counts only if it is better.
    if (!(state == problem.state) && same_curve &&
        (delta > 0 || LawIsUndecided(delta, options.thresholds))) {
      continue;
    }
    if (choice.delta_aicc && delta >= *choice.delta_aicc) continue;
    choice.delta_aicc = delta;
    choice.likelihood_ratio =
        evidence.LikelihoodRatio(other.solution.sum_of_squares, best.sum_of_squares);
    choice.law = other.problem.parameters.LawAt(other.solution.theta);
  }
  buffers.response.Bind(problem);
  if (!choice.delta_aicc) {
    // Either one curve, or the other law has no fit at all.
    choice.decided = !same_curve;
    if (choice.decided) choice.preferred = problem.model;
    return choice;
  }
  choice.decided = !LawIsUndecided(*choice.delta_aicc, options.thresholds);
  if (choice.decided) choice.preferred = *choice.delta_aicc > 0 ? problem.model : &alternative;
  return choice;
}

}  // namespace mindahl::identification
