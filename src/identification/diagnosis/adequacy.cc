#include "identification/diagnosis/adequacy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "identification/diagnosis/diagnosis.h"
#include "identification/diagnosis/grade.h"

namespace mindahl::identification {
namespace {

/// That noise alone makes what all departures explain, or what the best of them does.
double ChanceOfNoise(const AdequacyTest& test) {
  double best = 1.0;
  for (const DepartureFit& fit : test.fits) best = std::min(best, fit.p_value);
  if (test.fits.empty()) return std::min(1.0, 2 * test.p_value);
  return std::min({1.0, 2 * test.p_value, 2 * static_cast<double>(test.fits.size()) * best});
}

/// Would a fit be given an asymmetry? Not by Dahl's own law or under a load that varies, nor beside
/// offsets of a contact that had slipped before, which take it up.
bool TellsAsymmetry(const Problem& problem) {
  if (problem.model->memory == models::Memory::kNone || problem.data->load_varies) return false;
  return problem.state == models::InitialState::kVirgin || problem.parameters.any_zero_is_known();
}

/// What to type: a covariate's has its name, quoted where it has blanks.
std::string OptionOf(const Problem& problem, const DepartureFit& fit) {
  const Departure& departure = Departures()[fit.departure];
  if (problem.data->is_forced()) {
    // What is beside a force has no place in a fit of the displacement.
    return departure.term == "displacement_drift" ? std::string(departure.option) : "";
  }
  if (departure.term == "asymmetry" && !TellsAsymmetry(problem)) return "";
  if (!fit.covariate) return std::string(departure.option);
  const std::string_view name = problem.data->covariates[*fit.covariate].name;
  const char* const quote = name.find(' ') == std::string_view::npos ? "" : "'";
  return fmt::format("--covariate {}{}{}", quote, name, quote);
}

double SizeOf(const DepartureFit& fit) {
  if (!Departures()[fit.departure].is_square) return fit.size;
  return std::copysign(std::sqrt(std::abs(fit.size)), fit.size);
}

}  // namespace

bool IsDoubtful(const AdequacyTest& test, const Thresholds& thresholds) {
  return ChanceOfNoise(test) < thresholds.doubt;
}

std::vector<DepartureFit> CausesOf(const AdequacyTest& test, const Thresholds& thresholds) {
  std::vector<DepartureFit> causes;
  for (const DepartureFit& fit : test.fits) {
    if (fit.p_value < thresholds.cause && fit.delta_aicc < 0) causes.push_back(fit);
  }
  std::ranges::stable_sort(causes, {}, &DepartureFit::delta_aicc);
  const double best = causes.empty() ? 0.0 : causes.front().explains;
  std::erase_if(causes, [&](const DepartureFit& fit) {
    return fit.explains < thresholds.rival_cause * best;
  });
  return causes;
}

bool SaysItsSize(const DepartureFit& cause, const Thresholds& thresholds) {
  return cause.size_p_value < thresholds.cause;
}

Adequacy JudgeAdequacy(const Problem& problem, const Solution& solution, const AdequacyTest& test,
                       std::span<const DepartureFit> causes, const Thresholds& thresholds,
                       std::span<const ParameterEstimate> estimates) {
  Adequacy adequacy;
  adequacy.misfit_over_noise = test.misfit_over_noise;
  adequacy.misfit = test.misfit_over_noise * test.noise * problem.data->response_unit();
  adequacy.p_value = ChanceOfNoise(test);
  adequacy.tried = test.fits.size();
  const auto& reported = problem.parameters.reported();
  for (const DepartureFit& fit : causes) {
    const Departure& departure = Departures()[fit.departure];
    Cause& cause = adequacy.causes.emplace_back(
        Cause{.code = departure.code,
              .delta_aicc = fit.delta_aicc,
              .explains = fit.explains,
              .size = SizeOf(fit),
              .unit = SaysItsSize(fit, thresholds) ? fit.unit : std::string_view(),
              .option = OptionOf(problem, fit)});
    for (std::size_t k = 0; k < reported.size(); ++k) {
      if (reported[k] > kSlipForce) continue;
      cause.moves =
          std::max(cause.moves, MoveOf(problem, solution, fit, reported[k], estimates[k]));
    }
  }
  if (IsDoubtful(test, thresholds)) adequacy.verdict = AdequacyVerdict::kDoubtful;
  return adequacy;
}

void AddIrregularities(const Problem& problem, std::span<const IrregularityFit> found,
                       const Thresholds& thresholds, Adequacy& adequacy) {
  for (const IrregularityFit& fit : found) {
    if (fit.p_value >= thresholds.cause || fit.delta_aicc >= 0) continue;
    const auto tried = static_cast<double>(Irregularities().size());
    adequacy.p_value = std::min(adequacy.p_value, std::min(1.0, 2 * tried * fit.p_value));
    const Irregularity& irregularity = Irregularities()[fit.irregularity];
    adequacy.causes.push_back(
        {.code = irregularity.code,
         .delta_aicc = fit.delta_aicc,
         .explains = fit.explains,
         .size = irregularity.unit == "N" ? fit.size * problem.data->force : fit.size,
         .unit = irregularity.unit,
         .option = std::string(irregularity.option)});
    adequacy.verdict = AdequacyVerdict::kDoubtful;
  }
  std::ranges::stable_sort(adequacy.causes, {}, &Cause::delta_aicc);
  const double best = adequacy.causes.empty() ? 0.0 : adequacy.causes.front().explains;
  std::erase_if(adequacy.causes,
                [&](const Cause& cause) { return cause.explains < thresholds.rival_cause * best; });
}

bool PastIsUndecided(double delta_aicc, const Thresholds& thresholds) {
  return std::abs(delta_aicc) < thresholds.rival_past;
}

std::optional<Finding> FindSlowResiduals(const FitResult& result, const Thresholds& thresholds) {
  if (!(MisfitOf(result, thresholds) > thresholds.poor_misfit)) return std::nullopt;
  const double correlation = 1 - result.residuals.durbin_watson / 2;
  if (!(correlation > 0)) return std::nullopt;
  const RecordFit& widest = result.WidestRecord();
  const double samples_a_stroke = static_cast<double>(widest.residual.size()) /
                                  static_cast<double>(widest.reversals.size() + 1);
  const double strokes = -1 / std::log(correlation) / samples_a_stroke;
  if (!(strokes > thresholds.noise_memory)) return std::nullopt;
  return Finding{.code = "slow_residuals", .numbers = {{"strokes", strokes}}};
}

bool IsInadequate(const FitResult& result, const Thresholds& thresholds) {
  if (result.FindFinding("no_model_fits") != nullptr) return true;
  if (result.FindFinding("loop_not_seen") != nullptr) return true;
  return result.adequacy.verdict == AdequacyVerdict::kDoubtful &&
         MissedForce(result) > thresholds.failing_misfit * ScaleOfMisfit(result, thresholds);
}

}  // namespace mindahl::identification
