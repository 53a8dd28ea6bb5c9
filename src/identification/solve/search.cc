#include "identification/solve/search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "core/extremes.h"

namespace mindahl::identification {

namespace {

constexpr double kNoCost = std::numeric_limits<double>::infinity();

/// Holds where loops of one α are looked at, closer where they differ. The first two rows cost
/// square roots and divisions only.
struct StartRow {
  double shape;
  std::vector<double> reaches;  // σX/Tc; of an imposed force, which stays below slip, T*/Tc
};

const std::vector<StartRow>& RowsOf(bool is_forced) {
  static const std::vector<StartRow> rows = {
      {1.0 / 3.0, {0.1, 0.4, 0.8, 1.2, 1.7, 2.5, 4.5, 10., 40., 90., 150.}},
      {0.0, {0.8, 1.1, 1.6, 2.5, 4.5, 10., 40., 150.}},
      {1.0, {0.5, 1.5, 4.0, 12., 60., 120.}},
      {2.5, {0.7, 3.0, 12., 60., 120.}}};
  static const std::vector<StartRow> mobilised = {
      {1.0 / 3.0, {0.1, 0.4, 0.65, 0.82, 0.92, 0.97, 0.995}},
      {0.0, {0.5, 0.99}},
      {1.0, {0.1, 0.4, 0.65, 0.82, 0.92, 0.97}},
      {2.5, {0.1, 0.25, 0.4, 0.6, 0.8, 0.92}}};
  return is_forced ? mobilised : rows;
}

/// A point of the plane, its cost and θ there.
struct Look {
  double cost = kNoCost;
  double reach = 0.0;
  double rig_ratio = 1.0;  // σ/k
  std::vector<double> theta = {};
};

/// Returns the largest |excitation| from where the contacts are unloaded.
double FarthestFrom(const Problem& problem, std::span<const double> theta) {
  double farthest = 0.0;
  for (std::size_t r = 0; r < problem.data->records.size(); ++r) {
    const auto [low, high] = ExtremesOf(problem.data->records[r].excitation());
    const double unloaded = theta[problem.parameters.PositionOfOrigin(r)];
    farthest = std::max({farthest, high - unloaded, unloaded - low});
  }
  return farthest;
}

/// Looks from θ of a look, whose α, origins and terms stay, and keeps what is found if it is
/// better.
void KeepBetter(ProjectedResidual& residual, Look& best, Look look) {
  // Without slip nothing depends on the reach: of equals the last, nearest to slip.
  constexpr double kEqual = 1 + 1e-9;
  const Problem& problem = residual.problem();
  const Parameters& parameters = problem.parameters;
  const Parameter& stiffness = parameters[kStiffness];
  const Parameter& slip_force = parameters[kSlipForce];
  const Parameter& rig = parameters[kRig];
  const Parameter& exponent = parameters[kLoadExponent];
  std::vector<double>& theta = look.theta;
  const bool is_forced = problem.data->is_forced();
  // Elements in parallel have the load exponent α.
  if (!exponent.fixed) theta[kLoadExponent] = exponent.Clamp(std::min(theta[kShape], 1.0));
  // The ratios are those of a contact of Tc = 1, or of the Tc that is held.
  const double log_slip_force = slip_force.fixed ? slip_force.theta : 0.0;
  theta[kSlipForce] = log_slip_force;
  double log_stiffness = std::log(look.reach);
  double log_rig = 0.0;
  if (is_forced && !slip_force.fixed) {
    theta[kSlipForce] = std::log(FarthestFrom(problem, theta) / look.reach);
  }
  if (parameters.has_rig()) {
    // The look's reach is that of contact and rig together: 1/σ_app = 1/σ + 1/k.
    const double compliance =
        rig.is_open() ? look.rig_ratio / (look.reach * (1 + look.rig_ratio)) : std::exp(-rig.theta);
    log_stiffness = -std::log(std::max(1 / look.reach - compliance, 0.1 / look.reach));
    log_rig = -std::log(compliance);
  }
  if (!is_forced) {
    theta[kStiffness] = log_stiffness + log_slip_force;
    theta[kRig] = log_rig + log_slip_force;
  }
  look.cost = residual.EvaluateFreely(theta);
  if (!std::isfinite(look.cost)) return;
  if (!is_forced) {
    // Parameters that are held keep their values; the others follow from the ratios of the look.
    if (stiffness.fixed && !slip_force.fixed) theta[kSlipForce] = stiffness.theta - log_stiffness;
    theta[kStiffness] = stiffness.fixed ? stiffness.theta : log_stiffness + theta[kSlipForce];
    theta[kRig] = rig.is_open() ? log_rig + theta[kSlipForce] : rig.theta;
  }
  for (const std::size_t p : parameters.free()) {
    const double inside = parameters[p].Clamp(theta[p]);
    // Columns far beyond their bounds make a straight line of any loop.
    if (parameters[p].term->is_linear && inside != theta[p]) return;
    theta[p] = inside;
  }
  if (look.cost <= kEqual * best.cost) best = std::move(look);
}

/// Returns θ with contacts that are unloaded at their first samples, where that is not held.
std::vector<double> UnloadedAtFirst(const Problem& problem, std::vector<double> theta) {
  for (std::size_t r = 0; r < problem.data->records.size(); ++r) {
    const std::size_t origin = problem.parameters.PositionOfOrigin(r);
    if (problem.parameters[origin].fixed) continue;
    theta[origin] = problem.data->records[r].excitation().front();
  }
  return theta;
}

/// Returns the best looks of those that compete: of one α, or where α is given of one third of the
/// reaches; those that lead anywhere.
std::vector<Look> BestLooks(ProjectedResidual& residual) {
  constexpr std::size_t kThirds = 3;
  constexpr double kNear = 4.0;
  const Problem& problem = residual.problem();
  const Parameter& shape = problem.parameters[kShape];
  std::vector<double> theta = problem.parameters.Theta();
  for (const std::size_t p : problem.parameters.free()) {
    theta[p] = problem.parameters[p].Clamp(theta[p]);
  }
  theta = UnloadedAtFirst(problem, std::move(theta));
  const std::vector<double> ratios =
      problem.parameters[kRig].is_open() ? std::vector{0.1, 0.5, 2.0, 10.0} : std::vector{1.0};
  const std::vector<StartRow>& rows = RowsOf(problem.data->is_forced());
  std::vector<Look> best(rows.size());
  const bool is_given = shape.fixed || shape.started_by_user;
  const std::size_t count = is_given ? 1 : rows.size();
  for (std::size_t k = 0; k < count; ++k) {
    const std::vector<double>& reaches = rows[k].reaches;
    theta[kShape] = is_given ? shape.theta : shape.Clamp(rows[k].shape);
    // A loop says how far it reaches better than of which shape it is: where Mindlin's row saw a
    // minimum, the others are looked at around it.
    const double seen = k == 0 ? 0.0 : best[0].reach;
    for (std::size_t i = 0; i < reaches.size(); ++i) {
      if (seen > 0 && !(reaches[i] > seen / kNear && reaches[i] < seen * kNear)) continue;
      Look& group = best[is_given ? i * kThirds / reaches.size() : k];
      for (const double ratio : ratios) {
        KeepBetter(residual, group, {.reach = reaches[i], .rig_ratio = ratio, .theta = theta});
      }
    }
  }
  std::erase_if(best, [](const Look& look) { return !std::isfinite(look.cost); });
  return best;
}

/// Tries a look with lags, with which a loop looks like one of another shape.
void LookForLag(ProjectedResidual& residual, Look& best) {
  constexpr std::size_t kLag = RowOf(TermId::kLag);
  const Parameter& lag = residual.problem().parameters[kLag];
  if (lag.fixed) return;
  Look look = best;
  for (const double share : {-1.0, -0.6, -0.3, -0.15, -0.06, 0.06, 0.15, 0.3, 0.6, 1.0}) {
    look.theta[kLag] = share * (share < 0 ? -lag.lower : lag.upper);
    KeepBetter(residual, best, look);
  }
}

/// Searches from θ, and keeps the solution where it is better.
void SearchOnce(std::span<const double> theta, const SolverOptions& options,
                ProjectedResidual& residual, Solution& best) {
  Solution solution = Solve(residual, theta, options);
  if (solution.sum_of_squares < best.sum_of_squares) best = std::move(solution);
}

/// Returns points next to a solution from which there may be a way to a lower minimum.
std::vector<std::vector<double>> Neighbours(const Problem& problem,
                                            const std::vector<double>& solution) {
  constexpr double kSharp = 0.1;       // α
  constexpr double kSharpest = 0.003;  // α
  constexpr double kAway = 0.1;
  constexpr double kUnreached = 0.05;  // of ln Tc above the largest force
  const Parameters& parameters = problem.parameters;
  std::vector<std::vector<double>> neighbours;
  // Other parts of the compliance in the rig: a sharp knee behind a soft rig resembles a round one.
  const double compliance = std::exp(-solution[kStiffness]) + std::exp(-solution[kRig]);
  for (const double share : {0.2, 0.5, 0.8, 0.99}) {
    for (const double shape : {0.02, 1.0}) {
      if (!parameters[kRig].is_open() || (parameters[kShape].fixed && shape == 1.0)) continue;
      std::vector<double>& theta = neighbours.emplace_back(solution);
      theta[kStiffness] = -std::log((1 - share) * compliance);
      theta[kRig] = -std::log(share * compliance);
      theta[kShape] = shape;
      // A law that bends from the start has a slip force far beyond the largest force, of about 1.
      theta[kSlipForce] = std::min(theta[kSlipForce], 0.0);
    }
  }
  // Virgin contacts unloaded at their first samples, from which noise may have led the search away.
  std::vector<double> at_first = UnloadedAtFirst(problem, solution);
  const bool has_moved = !std::ranges::equal(
      solution, at_first, [](double now, double first) { return std::abs(now - first) <= kAway; });
  if (has_moved) neighbours.push_back(at_first);
  // Slip that begins just before the ends, of a loop that does not slip.
  const bool may_be_sharp =
      !parameters[kShape].fixed && !parameters[kSlipForce].fixed && !problem.data->is_forced();
  if (may_be_sharp && solution[kSlipForce] > kUnreached) {
    std::vector<double>& sharp = neighbours.emplace_back(std::move(at_first));
    sharp[kShape] = kSharpest;
    sharp[kSlipForce] = 0.0;
  }
  // Slip that begins sooner or later, and a smoother law: where slip begins so sharply the sum of
  // squares has a minimum between any two samples.
  if (parameters[kShape].fixed || !(solution[kShape] < kSharp)) return neighbours;
  const auto step = [&](std::size_t p, double by) { neighbours.emplace_back(solution)[p] += by; };
  step(kShape, kSharp);
  for (const double by : {-0.2, -0.1, -0.03, 0.03, 0.1, 0.2}) step(kStiffness, by);
  return neighbours;
}

}  // namespace

double FindStartsOf(Candidate& candidate, const ScaledRecords& thinned, const FitOptions& options) {
  const Problem& problem = candidate.problem;
  const Parameters& parameters = problem.parameters;
  const std::vector<std::size_t>& free = parameters.free();
  candidate.starts.clear();
  // A start from the options that leaves nothing to be looked for.
  const bool is_given = std::ranges::all_of(free, [&](std::size_t p) {
    const Term& term = *parameters[p].term;
    return parameters[p].started_by_user || term.is_linear || term.start;
  });
  if (!options.start.empty() && is_given) {
    candidate.starts.push_back(parameters.Theta());
    return 0.0;
  }
  constexpr std::size_t kEnough = 4;  // samples a parameter
  constexpr std::size_t kStartsAmongKinks = 4;
  constexpr double kSmooth = 1.0;  // α
  constexpr double kClearly = 0.98;
  // The thinned record's minimum is a start only: no digits are asked of it.
  constexpr SolverOptions kRough{.function_tolerance = 1e-2,
                                 .parameter_tolerance = 1e-6,
                                 .max_iterations = 30,
                                 .is_rough = true};
  // With α held at 0 the cost has a kink, and many a minimum, wherever a sample begins to slip.
  const Parameter& shape = parameters[kShape];
  const bool has_kinks = shape.fixed && shape.theta == 0;
  // The thinned records have the history of the whole, but too few samples for many parameters, or
  // for a covariate, which could explain so few by itself.
  const bool has_covariate =
      std::ranges::any_of(free, [&](std::size_t p) { return parameters[p].term->of_column; });
  const bool is_enough = thinned.counted >= kEnough * free.size();
  Problem thin = problem;
  if (is_enough && !has_covariate && !has_kinks) thin.data = &thinned;
  ProjectedResidual residual(thin);
  std::vector<Look> looks = BestLooks(residual);
  for (Look& look : looks) LookForLag(residual, look);
  std::ranges::stable_sort(looks, {}, &Look::cost);
  // A column that follows the displacement, or a rig, bends the plane: all looks are followed.
  const bool bent = std::ranges::any_of(
      free, [&](std::size_t p) { return parameters[p].term->presence == Presence::kOnDemand; });
  const std::size_t most = has_kinks ? kStartsAmongKinks : 1;
  if (!bent && looks.size() > most) looks.resize(most);
  for (Look& start : looks) {
    for (const std::size_t p : free) {
      if (parameters[p].started_by_user) start.theta[p] = parameters[p].theta;
    }
    if (!options.start.empty()) continue;  // a start that is given is one
    const auto follow = [&](const std::vector<double>& theta, double share_of_cost) {
      Solution solution = Solve(residual, theta, kRough);
      if (!(solution.sum_of_squares < share_of_cost * start.cost)) return;
      start.theta = std::move(solution.theta);
      start.cost = solution.sum_of_squares;
    };
    follow(start.theta, 1.0);
    // The force of a sample that slips does not depend on σ and α, so that its gradient does not
    // lead from a sharp law to a smooth one. Far from slip both fit, and the valley is long.
    if (shape.fixed || !(start.theta[kShape] < kSmooth)) continue;
    std::vector<double> smooth = start.theta;
    smooth[kShape] = std::min(kSmooth, shape.upper);
    follow(smooth, kClearly);
  }
  std::ranges::stable_sort(looks, {}, &Look::cost);
  if (looks.size() > most) looks.resize(most);
  for (Look& start : looks) candidate.starts.push_back(std::move(start.theta));
  return looks.empty() ? kNoCost : looks.front().cost;
}

void AddStartsOfSmallerModels(Candidate& candidate, const ScaledRecords& thinned,
                              const FitOptions& options) {
  constexpr std::size_t kMostNested = 3;
  if (!options.start.empty()) return;
  const Parameters& parameters = candidate.problem.parameters;
  std::vector<std::size_t> terms;
  for (const std::size_t p : parameters.free()) {
    // Further coefficients of a group stay with the one that leads it, an exponent with its factor.
    const Term& term = *parameters[p].term;
    const bool leads = term.of_column || LeadsGroup(term);
    const bool is_on_demand = term.presence == Presence::kOnDemand && leads;
    if (is_on_demand && !parameters[p].has_prior()) terms.push_back(p);
  }
  for (const std::size_t p : terms) {
    const double neutral = p == kRig ? parameters[p].upper : parameters[p].ToTheta(0.0);
    if (neutral < parameters[p].lower || neutral > parameters[p].upper) continue;
    Candidate smaller = candidate;
    smaller.problem.parameters.Fix(p, neutral);
    FindStartsOf(smaller, thinned, options);
    if (terms.size() <= kMostNested) AddStartsOfSmallerModels(smaller, thinned, options);
    Descend(smaller, options);
    const Solution& solution = smaller.solution;
    if (std::isfinite(solution.sum_of_squares)) candidate.starts.push_back(solution.theta);
  }
}

void Descend(Candidate& candidate, const FitOptions& options) {
  Solution& best = candidate.solution;
  best = {.sum_of_squares = kNoCost};
  best.report.message = "no loop is seen: the force does not follow the displacement";
  if (candidate.starts.empty()) return;
  ProjectedResidual residual(candidate.problem);
  for (const std::vector<double>& start : candidate.starts) {
    SearchOnce(start, {.max_iterations = options.max_iterations}, residual, best);
  }
}

void SearchBesideMinimum(Candidate& candidate, const FitOptions& options) {
  Solution& best = candidate.solution;
  if (!options.start.empty() || !std::isfinite(best.sum_of_squares)) return;
  constexpr int kMostRounds = 4;
  constexpr double kLower = 1 - 1e-6;
  constexpr int kSteps = 100;  // in which a way down shows
  const SolverOptions search{.max_iterations = options.max_iterations};
  const SolverOptions look{.max_iterations = std::min(options.max_iterations, kSteps)};
  ProjectedResidual residual(candidate.problem);
  double last = kNoCost;
  for (int round = 0; round < kMostRounds && best.sum_of_squares < last; ++round) {
    last = kLower * best.sum_of_squares;
    Solution lower = best;
    for (const std::vector<double>& theta : Neighbours(candidate.problem, best.theta)) {
      SearchOnce(theta, look, residual, lower);
    }
    if (lower.sum_of_squares < best.sum_of_squares) {
      best = lower;
      SearchOnce(lower.theta, search, residual, best);
    }
  }
}

}  // namespace mindahl::identification
