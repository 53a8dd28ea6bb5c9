#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "mindahl/report/units.h"
#include "report/statements.h"

namespace mindahl::report {

using identification::Finding;
using identification::FitResult;

namespace {

/// Returns a number of the finding, NaN without it.
double NumberOf(const Finding& finding, std::string_view name) {
  return finding.Number(name).value_or(std::numeric_limits<double>::quiet_NaN());
}

/// True if the record itself shows a loop that slides: then no larger amplitude is asked for.
bool SeesSlip(const FitResult& fit) {
  return !fit.records.empty() && loop::Slides(fit.WidestRecord().facts);
}

std::string TooWide(const Finding& finding, const FitResult& fit, std::string_view unit) {
  return fmt::format("{:.0f} % interval {} … {} is too wide; more samples or less noise",
                     100 * fit.confidence, Quantity(NumberOf(finding, "lower"), unit, 3),
                     Quantity(NumberOf(finding, "upper"), unit, 3));
}

constexpr const char* kRaiseTheAmplitude =
    "raise the amplitude until the force levels off (mindahl plan says how far)";

std::string ReversalsUncertain(const Finding& finding, const FitResult&, const Units& units) {
  return fmt::format(
      "{:.0f} reversals or {:.0f}, if excursions up to {} are noise: look at the "
      "plot, and give --reversal-gate",
      NumberOf(finding, "count"), NumberOf(finding, "other_count"),
      Quantity(NumberOf(finding, "other_gate"), units.excitation, 3));
}

std::string SlipForceBoundedBelow(const Finding&, const FitResult& fit, const Units&) {
  return SeesSlip(fit) ? "the force keeps changing while the contact slides"
                       : fmt::format("the loop does not come near slip: {}", kRaiseTheAmplitude);
}

std::string SlipForceExtrapolated(const Finding& finding, const FitResult& fit, const Units&) {
  return fmt::format("an asymptote, of which the force reaches {:.0f} %{}",
                     100 * NumberOf(finding, "share"),
                     SeesSlip(fit) ? "" : fmt::format(": {}", kRaiseTheAmplitude));
}

std::string AlphaNotIdentifiable(const Finding& finding, const FitResult& fit, const Units&) {
  if (finding.kind == "wide") return TooWide(finding, fit, "-");
  return "only its ratio to the slip force is determined; fix one of them";
}

std::string SlipForceNotIdentifiable(const Finding& finding, const FitResult& fit,
                                     const Units& units) {
  return TooWide(finding, fit, units.force);
}

std::string SigmaNotIdentifiable(const Finding& finding, const FitResult& fit, const Units& units) {
  return TooWide(finding, fit, units.stiffness);
}

std::string UndeterminedCombination(const Finding& finding, const FitResult& fit, const Units&) {
  return fmt::format(
      "only a combination of {} is determined; fix one, or {}", fmt::join(finding.parameters, ", "),
      SeesSlip(fit) ? "sample more densely after the reversals" : "record a larger amplitude");
}

std::string ShapeOrRig(const Finding& finding, const FitResult&, const Units& units) {
  return fmt::format(
      "a rig of {} with Mindlin's 1/3 fits as well as a rigid one: measure the rig, "
      "and give --rig-stiffness",
      Quantity(NumberOf(finding, "rig_stiffness"), units.stiffness, 3));
}

std::string SearchLimit(const Finding& finding, const FitResult&, const Units&) {
  return fmt::format("the search stopped at its limit; give --bound {}=LO:HI",
                     finding.parameters.empty() ? "NAME" : finding.parameters.front());
}

std::string FewPlaces(const Finding& finding, const FitResult&, const Units&) {
  return fmt::format(
      "all samples lie in {:.0f} places of the loop: sample out of step with the "
      "motion, or more often",
      NumberOf(finding, "places"));
}

std::string LoopNotSeen(const Finding& finding, const FitResult&, const Units&) {
  return fmt::format(
      "no loop is seen: the fit explains {:.2g} % of the force's variance; are these "
      "the right columns?",
      std::max(0.0, 100 * NumberOf(finding, "r_squared")));
}

std::string UnknownPast(const Finding&, const FitResult&, const Units&) {
  return "no cycle is closed, and the earlier loading is not known: record a whole cycle, or give "
         "--initial-state virgin";
}

std::string InitialStateUndecided(const Finding&, const FitResult& fit, const Units&) {
  return fmt::format(
      "{} assumed; the intervals cover a {} one too",
      fit.initial_state == models::InitialState::kVirgin ? "unloaded contact" : "cycled contact",
      fit.initial_state == models::InitialState::kVirgin ? "cycled" : "virgin");
}

std::string OtherLawFitsBetter(const Finding& finding, const FitResult&, const Units&) {
  return fmt::format("{} fits better: --model {}",
                     finding.kind == "dahl" ? "Dahl's own law" : "Masing's law", finding.kind);
}

std::string EnergyContradiction(const Finding& finding, const FitResult&, const Units&) {
  return fmt::format("the cycles dissipate {} each, the fitted law {}: look at the plot",
                     Quantity(NumberOf(finding, "measured"), "J", 3),
                     Quantity(NumberOf(finding, "model"), "J", 3));
}

std::string LoadNotFollowed(const Finding& finding, const FitResult&, const Units&) {
  return fmt::format(
      "the normal load varies by ±{:.2g} %, which this fit takes as constant: choose "
      "samples of one load",
      100 * NumberOf(finding, "variation"));
}

std::string LoadFollowed(const Finding& finding, const FitResult&, const Units&) {
  return fmt::format("the normal load varies by ±{:.2g} %, which the law follows",
                     100 * NumberOf(finding, "variation"));
}

std::string PriorContradicted(const Finding& finding, const FitResult&, const Units&) {
  return fmt::format("the prior lies {:.2g} standard deviations from what the record says",
                     NumberOf(finding, "distance"));
}

std::string FitFailed(const Finding&, const FitResult& fit, const Units&) {
  return fit.solver.message;
}

struct SentenceRow {
  std::string_view code;
  const char* text;  ///< null where it has numbers
  std::string (*sentence)(const Finding&, const FitResult&, const Units&) = nullptr;
};

constexpr auto kSentences = std::to_array<SentenceRow>({
    // about the record
    {"reversals_uncertain", nullptr, ReversalsUncertain},
    {"glitches_left_out", "measurement faults are left out"},
    {"path_too_long",
     "the path is far longer than the strokes: noise is taken for motion; give --reversal-gate"},
    {"no_closed_cycle", "no cycle is closed: record one and a half cycles or more"},
    {"load_followed", nullptr, LoadFollowed},
    {"load_not_followed", nullptr, LoadNotFollowed},
    {"noise_in_displacement",
     "the displacement is the noisier channel: if the machine imposes the force, --noise-in "
     "displacement"},
    // about the parameters
    {"undetermined_parameter", "the record does not depend on it"},
    {"undetermined_combination", nullptr, UndeterminedCombination},
    {"sigma_not_identifiable", nullptr, SigmaNotIdentifiable},
    {"alpha_not_identifiable", nullptr, AlphaNotIdentifiable},
    {"slip_force_not_identifiable", nullptr, SlipForceNotIdentifiable},
    {"asymmetry_not_identifiable", "the loop stays below slip"},
    {"sigma_bounded_below", "a rigid contact fits as well: sample more densely after reversals"},
    {"slip_force_bounded_below", nullptr, SlipForceBoundedBelow},
    {"slip_force_extrapolated", nullptr, SlipForceExtrapolated},
    {"alpha_limited_by_load", "at the limit of the law for a load that varies"},
    {"search_limit", nullptr, SearchLimit},
    {"few_places", nullptr, FewPlaces},
    {"unknown_past", nullptr, UnknownPast},
    {"initial_state_undecided", nullptr, InitialStateUndecided},
    {"several_minima", "two solutions fit: the intervals cover both"},
    {"shape_or_rig", nullptr, ShapeOrRig},
    {"rig_not_tried", "a compliant rig, which cannot be fitted here, would look the same"},
    {"prior_contradicted", nullptr, PriorContradicted},
    // about the law and what it misses
    {"law_undecided", "the other law fits as well"},
    {"other_law_fits_better", nullptr, OtherLawFitsBetter},
    {"systematic_residual", "the misfit is alike in every stroke"},
    {"slow_residuals", "the misfit drifts slowly: fit parts of it, --select cycles=LO:HI"},
    {"energy_contradiction", nullptr, EnergyContradiction},
    {"loop_not_seen", nullptr, LoopNotSeen},
    {"no_model_fits", "the law does not have the shape of the record"},
    {"model_inadequate", "the law does not describe the record"},
    // about the search
    {"weights_not_settled", "the weights of the samples did not settle; try another --loss"},
    {"fit_failed", nullptr, FitFailed},
});

}  // namespace

bool HasSentence(std::string_view code) {
  return std::ranges::find(kSentences, code, &SentenceRow::code) != kSentences.end();
}

std::string Sentence(const Finding& finding, const FitResult& fit, const Units& units) {
  const std::string_view code = finding.code;
  const auto row = std::ranges::find(kSentences, code, &SentenceRow::code);
  std::string sentence;
  if (row == kSentences.end()) {
    sentence = code;
    std::ranges::replace(sentence, '_', ' ');
  } else {
    sentence = row->text != nullptr ? row->text : row->sentence(finding, fit, units);
  }
  const std::optional<double> record = finding.Number("record");
  return record ? fmt::format("record {:.0f}: {}", *record, sentence) : sentence;
}

}  // namespace mindahl::report
