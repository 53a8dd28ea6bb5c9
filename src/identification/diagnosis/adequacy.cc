#include "identification/diagnosis/adequacy.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "identification/diagnosis/diagnosis.h"
#include "identification/diagnosis/grade.h"
#include "identification/problem/moved_samples.h"
#include "mindahl/identification/terms.h"

namespace mindahl::identification {

bool FollowsContact(std::span<const double> column, std::span<const double> fitted_force) {
  constexpr double kFollows = 0.3;  // correlation
  return std::abs(ColumnCorrelation(column, fitted_force)) > kFollows;
}

namespace {

const Term* TermOfGroup(std::string_view group) {
  const auto terms = Terms();
  const auto term = std::ranges::find(terms, group, &Term::group);
  return term == terms.end() ? FindTerm(FindTermGroup(group)->terms.front()) : &*term;
}

bool HasTimes(const ScaledRecords& data) {
  return std::ranges::none_of(data.records,
                              [](const ScaledRecord& record) { return record.velocity.empty(); });
}

/// Masing's law does not model it under a load that varies, and Dahl's own not behind a rig.
bool MayBeAsymmetric(const Problem& problem) {
  return problem.model->memory == models::Memory::kReturnPoint ? !problem.data->load_varies
                                                               : !problem.parameters.has_rig();
}

/// An asymmetry is identifiable where the offset is known, or if the contact started unloaded; of
/// Dahl's own law, whose branches bend by it, always.
bool TellsAsymmetry(const Problem& problem) {
  return problem.model->memory == models::Memory::kNone ||
         problem.state.Any(models::InitialState::kVirgin) || problem.parameters.any_zero_is_known();
}

bool IsAccepted(const Problem& problem, const Term* term) {
  const ScaledRecords& data = *problem.data;
  if (term->needs_time && !HasTimes(data)) return false;
  if (term->motion != ContactMotion::kMeasured) {
    const std::size_t moved = problem.parameters.PositionOfMotion();
    const bool is_only =
        !problem.parameters.moves_contact() || problem.parameters[moved].term->id == term->id;
    const bool has_clocks = term->motion != ContactMotion::kLate || MayHaveClocks(data);
    return is_only && has_clocks && !data.load_varies;
  }
  if (term->id == TermId::kAsymmetry) return MayBeAsymmetric(problem) && TellsAsymmetry(problem);
  return true;
}

}  // namespace

std::string_view AcceptedGroup(const Problem& problem, const FitOptions& options,
                               std::string_view group) {
  // In a fit of the displacement the terms of the force do not exist.
  if (group.empty() || problem.data->is_forced()) {
    return group == "displacement_drift" ? group : std::string_view();
  }
  if (group == "covariate") return group;
  const Term* const term = TermOfGroup(group);
  const std::string name(term->name);
  const bool is_there =
      options.fixed.contains(name) || std::ranges::find(options.terms, name) != options.terms.end();
  return !is_there && IsAccepted(problem, term) ? group : std::string_view();
}

namespace {

/// True if a covariate follows the force of the fitted model on the samples that count.
bool CovariateFollowsContact(const Problem& problem, const Solution& solution,
                             std::size_t covariate) {
  std::vector<double> column;
  std::vector<double> fitted_force;
  std::size_t begin = 0;
  for (const ScaledRecord& record : problem.data->records) {
    for (std::size_t i = 0; i < record.size(); ++i) {
      // An outlier under a robust loss counts, and has no weight.
      if (!(record.root_weight[i] > 0)) continue;
      const double missed =
          solution.residual.empty() ? 0.0 : solution.residual[begin + i] / record.root_weight[i];
      column.push_back(record.covariates[covariate][i]);
      fitted_force.push_back(record.force[i] + missed);
    }
    begin += record.size();
  }
  return FollowsContact(column, fitted_force);
}

double SizeOf(const DepartureFit& fit) {
  if (!Departures()[fit.departure].is_square) return fit.size;
  return std::copysign(std::sqrt(std::abs(fit.size)), fit.size);
}

const DepartureFit* FindCause(std::span<const DepartureFit> causes, std::string_view code) {
  const auto found = std::ranges::find_if(
      causes, [&](const DepartureFit& fit) { return Departures()[fit.departure].code == code; });
  return found == causes.end() ? nullptr : &*found;
}

/// True if a simpler cause explains nearly as much as another that contains it, and leaves hardly
/// more.
bool IsEnough(const DepartureFit& simpler, const DepartureFit& fit, const Thresholds& thresholds) {
  constexpr double kLittle = 0.05;  // of the sum of squares
  constexpr double kMore = 1.5;     // times what the other leaves
  return simpler.explains >= thresholds.simpler_cause * fit.explains &&
         1 - simpler.explains <= std::max(kLittle, kMore * (1 - fit.explains));
}

/// Keeps, of a cause and a simpler one that it contains, the simpler where that explains nearly as
/// much, else the other.
void KeepOneOfNested(std::vector<DepartureFit>& causes, const Thresholds& thresholds) {
  std::vector<std::string_view> dropped;
  for (const DepartureFit& fit : causes) {
    const Departure& departure = Departures()[fit.departure];
    for (const std::string_view code : departure.simpler) {
      const DepartureFit* const simpler = FindCause(causes, code);
      if (simpler == nullptr) continue;
      const bool is_enough = IsEnough(*simpler, fit, thresholds);
      dropped.push_back(is_enough ? departure.code : code);
    }
  }
  std::erase_if(causes, [&](const DepartureFit& fit) {
    return std::ranges::find(dropped, Departures()[fit.departure].code) != dropped.end();
  });
}

/// A knee that is rounded by a force of the speed moves with the speed as a late channel does. A
/// lag is one time for all speeds: it is claimed where it explains more than the forces of speed.
void DenyLagOfSpeed(std::vector<DepartureFit>& causes) {
  const DepartureFit* const lag = FindCause(causes, "channel_lag");
  if (lag == nullptr) return;
  const bool is_of_speed =
      std::ranges::any_of(std::array{"viscous_force", "speed_power"}, [&](const char* code) {
        const DepartureFit* const speed = FindCause(causes, code);
        return speed != nullptr && speed->delta_aicc < lag->delta_aicc;
      });
  if (is_of_speed) causes.erase(causes.begin() + (lag - causes.data()));
}

/// True if a force that seems to saturate would gain, or lose more than all, of what is beyond.
bool IsNoSaturation(const DepartureFit& fit, const Thresholds& thresholds) {
  if (Departures()[fit.departure].code != "force_saturates") return false;
  return !(SaysItsSize(fit, thresholds) && fit.size > 0 && fit.size <= 1);
}

}  // namespace

bool IsDoubtful(const AdequacyTest& test, const Thresholds& thresholds) {
  return test.p_value < thresholds.doubt;
}

std::vector<DepartureFit> CausesOf(const AdequacyTest& test, const Thresholds& thresholds) {
  std::vector<DepartureFit> causes;
  for (const DepartureFit& fit : test.fits) {
    if (IsNoSaturation(fit, thresholds)) continue;
    const bool helps = fit.p_value < thresholds.cause && fit.delta_aicc < 0;
    if (helps || fit.is_measured) causes.push_back(fit);
  }
  DenyLagOfSpeed(causes);
  KeepOneOfNested(causes, thresholds);
  std::ranges::stable_sort(causes, {}, &DepartureFit::delta_aicc);
  const double best = causes.empty() ? 0.0 : causes.front().explains;
  std::erase_if(causes, [&](const DepartureFit& fit) {
    return fit.explains < thresholds.rival_cause * best && !fit.is_measured;
  });
  return causes;
}

bool SaysItsSize(const DepartureFit& cause, const Thresholds& thresholds) {
  return cause.size_p_value < thresholds.cause;
}

namespace {

/// Ranks the causes to name: first a measurement without the model; then another column of the
/// file, then what an option fits, few numbers before many; a lag, which many others resemble, and
/// what no option fits come last, a fault of the sensor after a force of the same position.
int RankOf(const Cause& cause) {
  if (cause.is_measured) return 0;
  if (cause.code == "covariate") return cause.has_known_factor ? 4 : 1;
  if (cause.code == "displacement_sensor") return 6;
  if (cause.term.empty()) return 5;
  if (cause.code == "channel_lag") return 4;
  return cause.code == "slip_position_quadratic" ? 3 : 2;
}

/// The best first; of those that explain nearly as much as the best by their rank.
void Order(std::vector<Cause>& causes, const Thresholds& thresholds) {
  std::ranges::stable_sort(causes, {}, &Cause::delta_aicc);
  if (causes.empty()) return;
  const double best = causes.front().explains;
  std::erase_if(causes, [&](const Cause& cause) {
    return cause.explains < thresholds.rival_cause * best && !cause.is_measured;
  });
  std::ranges::stable_sort(causes, {}, [&](const Cause& cause) {
    const bool is_near = cause.explains >= thresholds.simpler_cause * best;
    constexpr int kFar = 7;
    return is_near || cause.is_measured ? RankOf(cause) : kFar;
  });
}

/// Drops the causes that explain less than half of what is left beside terms that are fitted: of
/// what several things make together none is to be blamed.
void DropLesserCauses(std::vector<Cause>& causes) {
  constexpr double kMostOfIt = 0.5;
  std::erase_if(
      causes, [](const Cause& cause) { return cause.explains < kMostOfIt && !cause.is_measured; });
}

}  // namespace

Adequacy JudgeAdequacy(const Problem& problem, const Solution& solution,
                       const AdequacyEvidence& evidence, const FitOptions& options,
                       std::span<const ParameterEstimate> estimates) {
  const auto& [test, causes] = evidence;
  const Thresholds& thresholds = options.thresholds;
  Adequacy adequacy;
  adequacy.misfit_over_noise = test.misfit_over_noise;
  adequacy.misfit = test.misfit_over_noise * test.noise * problem.data->response_unit();
  adequacy.p_value = test.p_value;
  adequacy.tried = test.fits.size();
  const auto& reported = problem.parameters.reported();
  for (const DepartureFit& fit : causes) {
    const Departure& departure = Departures()[fit.departure];
    if (departure.is_positive && fit.size < 0 && !problem.parameters.has_rig()) continue;
    Cause& cause = adequacy.causes.emplace_back(
        Cause{.code = departure.code,
              .delta_aicc = fit.delta_aicc,
              .explains = fit.explains,
              .size = SizeOf(fit),
              .unit = SaysItsSize(fit, thresholds) ? fit.unit : std::string_view(),
              .term = std::string(AcceptedGroup(problem, options, departure.group)),
              .is_measured = fit.is_measured});
    if (fit.covariate && !cause.term.empty()) {
      cause.term = problem.data->covariates[*fit.covariate].name;
      cause.has_known_factor = CovariateFollowsContact(problem, solution, *fit.covariate);
    }
    for (std::size_t k = 0; k < reported.size(); ++k) {
      if (reported[k] > kSlipForce) continue;
      cause.moves =
          std::max(cause.moves, MoveOf(problem, solution, fit, reported[k], estimates[k]));
    }
  }
  Order(adequacy.causes, thresholds);
  if (!options.terms.empty() || !options.covariates.empty()) DropLesserCauses(adequacy.causes);
  return adequacy;
}

bool PastIsUndecided(double delta_aicc, const Thresholds& thresholds) {
  return std::abs(delta_aicc) < thresholds.rival_past;
}

std::optional<Finding> FindSlowResiduals(const FitResult& result, const Thresholds& thresholds) {
  if (!(MisfitOf(result) > thresholds.poor_misfit)) return std::nullopt;
  // The residuals correlate by 1 − DW/2 from one sample to the next, and so decay at this rate.
  const double forgotten = -std::log1p(-result.residuals.durbin_watson / 2);
  if (!std::isfinite(forgotten)) return std::nullopt;
  const RecordFit& widest = result.WidestRecord();
  const auto samples = static_cast<double>(widest.residual.size());
  const auto strokes_in_all = static_cast<double>(widest.reversals.size() + 1);
  const double strokes = strokes_in_all / std::max(1.0, forgotten * samples);
  if (!(strokes > thresholds.noise_memory)) return std::nullopt;
  return Finding{.code = "slow_residuals", .numbers = {{"strokes", strokes}}};
}

bool IsInadequate(const FitResult& result, const Thresholds& thresholds) {
  if (result.FindFinding("no_model_fits") != nullptr) return true;
  if (result.FindFinding("loop_not_seen") != nullptr) return true;
  return result.adequacy.verdict == AdequacyVerdict::kDoubtful &&
         MissedForce(result) > thresholds.failing_misfit * ScaleOfMisfit(result);
}

}  // namespace mindahl::identification
