#include "identification/solve/starts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "core/extremes.h"

namespace mindahl::identification {
namespace {

/// Holds the starting points of one α: σX/Tc, closer where loops of that shape differ. The first
/// two rows cost square roots and divisions only.
struct StartRow {
  double shape;
  std::size_t count;
  std::array<double, 11> reaches;  // σX/Tc
};
constexpr std::array kRows = {
    StartRow{1.0 / 3.0, 11, {0.1, 0.4, 0.8, 1.2, 1.7, 2.5, 4.5, 10., 40., 90., 150.}},
    StartRow{0.0, 8, {0.8, 1.1, 1.6, 2.5, 4.5, 10., 40., 150.}},
    StartRow{1.0, 6, {0.5, 1.5, 4.0, 12., 60., 120.}},
    StartRow{2.5, 5, {0.7, 3.0, 12., 60., 120.}}};
/// Starting points T*/Tc under an imposed force, which stays below slip.
constexpr std::array<StartRow, 4> kMobilisedRows = {
    StartRow{1.0 / 3.0, 7, {0.1, 0.4, 0.65, 0.82, 0.92, 0.97, 0.995}},
    StartRow{0.0, 2, {0.5, 0.99}}, StartRow{1.0, 6, {0.1, 0.4, 0.65, 0.82, 0.92, 0.97}},
    StartRow{2.5, 6, {0.1, 0.25, 0.4, 0.6, 0.8, 0.92}}};
constexpr double kNear = 4.0;
constexpr std::array kRigRatios = {0.1, 0.5, 2.0, 10.0};  // σ/k

/// Number of starts where α is held at 0 and there are several minima next to each other.
constexpr std::size_t kStartsAmongKinks = 4;

/// A term with which a loop looks like one of another shape: the best look of each shape is tried
/// with it.
struct TermOfLook {
  TermId id;
  std::size_t count;
  std::array<double, 10> trials;  // θ
  bool is_of_bound = false;       // times the bound on that side
  double stiffest = 1.0;          // what a gap takes of a stroke looked like compliance
};
constexpr std::array kTermsOfLook = {
    TermOfLook{.id = TermId::kLag,
               .count = 10,
               .trials = {-0.06, -0.15, -0.3, -0.6, -1.0, 0.06, 0.15, 0.3, 0.6, 1.0},
               .is_of_bound = true},
    TermOfLook{.id = TermId::kAsymmetry, .count = 4, .trials = {-0.6, -0.3, 0.3, 0.6}},
    TermOfLook{.id = TermId::kBacklash,
               .count = 5,
               .trials = {0.02, 0.05, 0.1, 0.2, 0.4},
               .stiffest = 8.0}};

/// A point of the plane and its cost.
struct Look {
  double cost = std::numeric_limits<double>::infinity();
  double reach = 0.0;  // σX/Tc; T*/Tc of an imposed force
  double shape = 0.0;
  double rig_ratio = 1.0;
  std::size_t guess = 0;                            // of where the contact was unloaded
  std::array<double, kTermsOfLook.size()> terms{};  // θ; of one that is not fitted it is ignored
};

class Plane {
 public:
  Plane(const Problem& problem, const FitOptions& options, Solver& solver)
      : problem_(problem), options_(options), solver_(solver) {
    for (const Parameter& parameter : problem.parameters) theta_.push_back(parameter.theta);
    FindGuesses();
  }

  /// Returns the parameter of kTermsOfLook.
  [[nodiscard]] const Parameter& TermOf(std::size_t term) const {
    return problem_.parameters[RowOf(kTermsOfLook[term].id)];
  }
  [[nodiscard]] std::size_t guesses() const { return guesses_.size(); }

  /// Writes the look's cost, and what it found into theta().
  void At(Look& look) {
    const Parameters& parameters = problem_.parameters;
    const Parameter& slip_force = parameters[kSlipForce];
    const double log_reach = !is_forced()       ? std::log(look.reach)
                             : slip_force.fixed ? -slip_force.theta
                                                : std::log(look.reach / FarthestFrom(look.guess));
    LawPoint point{.log_rate = log_reach, .shape = look.shape, .theta = theta_};
    if (parameters.is_load_series()) {
      // Elements in parallel make it α.
      const Parameter& exponent = parameters[kLoadExponent];
      if (!exponent.fixed) {
        theta_[kLoadExponent] =
            std::clamp(std::min(look.shape, 1.0), exponent.lower, exponent.upper);
      }
      point.load_exponent = theta_[kLoadExponent];
    }
    for (std::size_t r = 0; r < problem_.data->records.size(); ++r) {
      theta_[parameters.PositionOfOrigin(r)] = guesses_[look.guess][r];
    }
    for (std::size_t k = 0; k < kTermsOfLook.size(); ++k) {
      const Parameter& term = TermOf(k);
      if (term.fixed) continue;
      theta_[RowOf(kTermsOfLook[k].id)] = std::clamp(look.terms[k], term.lower, term.upper);
    }
    if (parameters.has_rig()) {
      // The look's reach is that of contact and rig together: 1/σ_app = 1/σ + 1/k. Tc is about 1.
      const Parameter& rig = parameters[kRig];
      const double stiffness = rig.fixed || rig.has_prior()
                                   ? std::exp(rig.theta)
                                   : look.reach * (1 + look.rig_ratio) / look.rig_ratio;
      const double softer = 1 / look.reach - 1 / stiffness;
      const double contact = softer <= 0.1 / look.reach ? 10 * look.reach : 1 / softer;
      point.log_rate = std::log(contact);
      point.log_travel = -std::log(stiffness);
    }
    look.cost = solver_.CostAt(point, theta_);
    if (!std::isfinite(look.cost)) return;
    for (const std::size_t p : parameters.free()) {
      // Columns far beyond their bounds make a straight line of any loop.
      const bool is_column = parameters[p].term->is_linear;
      if (is_column && (theta_[p] < parameters[p].lower || theta_[p] > parameters[p].upper)) {
        look.cost = std::numeric_limits<double>::infinity();
        return;
      }
    }
    theta_[kShape] = look.shape;
    if (is_forced()) {
      ClampFree();
      return;
    }
    if (!parameters[kStiffness].fixed) theta_[kStiffness] = point.log_rate + theta_[kSlipForce];
    if (parameters.has_rig() && !parameters[kRig].fixed && !parameters[kRig].has_prior()) {
      theta_[kRig] = theta_[kSlipForce] - point.log_travel;
    }
    if (parameters[kStiffness].fixed && !parameters[kSlipForce].fixed) {
      theta_[kSlipForce] = theta_[kStiffness] - point.log_rate;
    }
    ClampFree();
  }

  [[nodiscard]] bool is_forced() const { return problem_.data->is_forced(); }

  /// θ of the last look, with what the options have to say of starts.
  [[nodiscard]] std::span<const double> theta() {
    for (const std::size_t p : problem_.parameters.free()) {
      problem_.parameters.FindStart(options_, p, theta_[p]);
    }
    return theta_;
  }

 private:
  using Guess = std::vector<double>;  // one a record

  /// Largest |excitation| from where a guess has the contact unloaded.
  [[nodiscard]] double FarthestFrom(std::size_t guess) const {
    double farthest = 0.0;
    for (std::size_t r = 0; r < problem_.data->records.size(); ++r) {
      const auto [low, high] = ExtremesOf(problem_.data->records[r].excitation());
      const double unloaded = guesses_[guess][r];
      farthest = std::max({farthest, high - unloaded, unloaded - low});
    }
    return farthest;
  }

  void ClampFree() {
    const Parameters& parameters = problem_.parameters;
    for (const std::size_t p : parameters.free()) {
      theta_[p] = std::clamp(theta_[p], parameters[p].lower, parameters[p].upper);
    }
  }

  /// At the first sample, at the centre of the record and at the file's zero, where these differ.
  void FindGuesses() {
    const auto guess_at = [this](auto&& place) {
      Guess guess;
      for (std::size_t r = 0; r < problem_.data->records.size(); ++r) {
        const Parameter& offset = problem_.parameters[problem_.parameters.PositionOfOrigin(r)];
        guess.push_back(offset.fixed ? offset.theta : place(problem_.data->records[r], offset));
      }
      return guess;
    };
    const auto add = [this](const Guess& guess) {
      if (std::ranges::find(guesses_, guess) == guesses_.end()) guesses_.push_back(guess);
    };
    add(guess_at([](const ScaledRecord& record, const Parameter& /*offset*/) {
      return record.excitation().front();
    }));
    add(guess_at([](const ScaledRecord& /*record*/, const Parameter& /*offset*/) { return 0.0; }));
    const Guess zero = guess_at([](const ScaledRecord& /*record*/, const Parameter& offset) {
      return offset.ToTheta(0.0);
    });
    if (std::ranges::all_of(zero, [](double x) { return std::abs(x) <= 1; })) add(zero);
  }

  const Problem& problem_;
  const FitOptions& options_;
  Solver& solver_;
  std::vector<double> theta_;
  std::vector<Guess> guesses_;
};

void KeepBetter(Look& best, Plane& plane, Look look) {
  // Without slip nothing depends on the reach: of equals the last, nearest to slip.
  constexpr double kEqual = 1 + 1e-9;
  plane.At(look);
  if (std::isfinite(look.cost) && look.cost <= kEqual * best.cost) best = look;
}

void LookForTerm(std::size_t term, Look& best, Plane& plane) {
  const TermOfLook& of = kTermsOfLook[term];
  const Parameter& parameter = plane.TermOf(term);
  const Look none = best;
  for (const double trial : std::span(of.trials).first(of.count)) {
    const double bound = trial < 0 ? -parameter.lower : parameter.upper;
    for (double stiffer = 1.0; stiffer <= of.stiffest; stiffer *= 2) {
      Look look = none;
      look.terms[term] = of.is_of_bound ? trial * bound : trial;
      look.reach = none.reach * stiffer;
      KeepBetter(best, plane, look);
    }
  }
}

using Looks = std::array<Look, kRows.size()>;

/// The best looks of those that compete, from one guess of where the contact was unloaded: of one
/// α, or where α is held of one third of the reaches.
/// @param hopeless  cost beyond which Mindlin's row says enough
void LookAround(Plane& plane, const Parameters& parameters, std::size_t guess, double hopeless,
                Looks& best) {
  const Parameter& shape = parameters[kShape];
  const bool rig_is_open =
      parameters.has_rig() && !parameters[kRig].fixed && !parameters[kRig].has_prior();
  const auto look_at = [&](std::size_t group, double reach, double alpha) {
    if (!rig_is_open) {
      KeepBetter(best[group], plane, {.reach = reach, .shape = alpha, .guess = guess});
      return;
    }
    for (const double ratio : kRigRatios) {
      KeepBetter(best[group], plane,
                 {.reach = reach, .shape = alpha, .rig_ratio = ratio, .guess = guess});
    }
  };
  const auto& rows = plane.is_forced() ? kMobilisedRows : kRows;
  if (shape.fixed) {
    constexpr std::size_t kThirds = 3;
    const StartRow& row = rows.front();
    for (std::size_t i = 0; i < row.count; ++i) {
      look_at(i * kThirds / row.count, row.reaches[i], shape.theta);
    }
    return;
  }
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const double alpha = std::clamp(rows[k].shape, shape.lower, shape.upper);
    // A loop says how far it reaches better than of which shape it is: where Mindlin's row saw a
    // minimum, the others are looked at around it.
    const double reach = best[0].reach;
    const auto is_near = [&](double other) {
      return k == 0 || reach == 0 || (other > reach / kNear && other < reach * kNear);
    };
    for (std::size_t i = 0; i < rows[k].count; ++i) {
      if (is_near(rows[k].reaches[i])) look_at(k, rows[k].reaches[i], alpha);
    }
    if (best[0].cost > hopeless) return;
  }
}

/// Looks around the first guess from which a look leads anywhere. Looks of several are not
/// compared: this far from the minimum the better one often leads to the worse minimum.
Looks LookAround(Plane& plane, const Parameters& parameters, double hopeless) {
  Looks best;
  const auto leads_anywhere = [](const Look& look) { return std::isfinite(look.cost); };
  for (std::size_t guess = 0; guess < plane.guesses() && std::ranges::none_of(best, leads_anywhere);
       ++guess) {
    LookAround(plane, parameters, guess, hopeless, best);
  }
  for (Look& look : best) {
    for (std::size_t k = 0; std::isfinite(look.cost) && k < kTermsOfLook.size(); ++k) {
      if (!plane.TermOf(k).fixed) LookForTerm(k, look, plane);
    }
  }
  std::ranges::sort(best, {}, &Look::cost);
  return best;
}

// The thinned record's minimum is a start only: no digits are asked of it.
constexpr SolverOptions kRough{.function_tolerance = 1e-2,
                               .parameter_tolerance = 1e-6,
                               .max_iterations = 30,
                               .is_rough = true};

}  // namespace

std::optional<StartingPoint> GivenStart(const Parameters& parameters, const FitOptions& options) {
  if (options.start.empty()) return std::nullopt;
  StartingPoint start;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    double& theta = start.theta.emplace_back(parameters[p].theta);
    const Term& term = *parameters[p].term;
    const bool is_searched = !term.is_linear && !term.has_start;
    if (parameters[p].fixed || parameters.FindStart(options, p, theta)) continue;
    if (is_searched) return std::nullopt;
  }
  return start;
}

bool HasKinks(const Parameters& parameters) {
  return parameters[kShape].fixed && parameters[kShape].theta == 0;
}

std::vector<StartingPoint> FindStarts(const Problem& thin, const FitOptions& options, double rival,
                                      Solver& solver) {
  // Looks are compared with looks: a grid this coarse is far from the minimum of a quiet record.
  constexpr double kBeyondRival = 10.0;
  std::vector<StartingPoint> starts;
  solver.Bind(thin);
  Solution scratch;
  Plane plane(thin, options, solver);
  const Looks looks = LookAround(plane, thin.parameters, kBeyondRival * rival);
  // A column that follows the displacement, or a rig, bends the plane: all looks are followed.
  const bool bent = std::ranges::any_of(thin.parameters.free(), [&](std::size_t p) {
    return thin.parameters[p].term->presence == Presence::kOnDemand;
  });
  const bool is_beaten = looks.front().cost > kBeyondRival * rival;
  const std::size_t most = HasKinks(thin.parameters) ? kStartsAmongKinks : 1;
  for (Look look : looks) {
    const bool is_wanted =
        bent || starts.size() < most ||
        (starts.size() < 2 && look.cost < options.thresholds.hopeless * looks.front().cost);
    if (!is_wanted || !std::isfinite(look.cost)) break;
    plane.At(look);
    const std::span<const double> theta = plane.theta();
    StartingPoint& start = starts.emplace_back(StartingPoint{
        .theta = {theta.begin(), theta.end()}, .cost = look.cost, .look = looks.front().cost});
    if (!options.start.empty()) continue;  // a start that is given is one
    solver.Solve(start.theta, kRough, scratch);
    if (!std::isfinite(scratch.sum_of_squares)) continue;
    start.theta = scratch.theta;
    start.cost = scratch.sum_of_squares;
    if (is_beaten) break;
  }
  std::ranges::stable_sort(starts, {}, &StartingPoint::cost);
  if (starts.size() > most) starts.resize(most);
  return starts;
}

}  // namespace mindahl::identification
