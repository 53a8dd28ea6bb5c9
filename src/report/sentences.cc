#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "mindahl/report/report.h"
#include "mindahl/report/units.h"
#include "report/names.h"
#include "report/statements.h"

namespace mindahl::report {

using identification::Finding;
using identification::FindingCode;
using identification::FitResult;

namespace {

double Needed(const Finding& finding, std::string_view name) {
  if (const std::optional<double> number = finding.Number(name)) return *number;
  throw std::logic_error(
      fmt::format("the finding '{}' has no number '{}'", std::string_view(finding.code), name));
}

[[noreturn]] void ThrowKind(const Finding& finding) {
  throw std::logic_error(fmt::format("the finding '{}' has no kind '{}'",
                                     std::string_view(finding.code), finding.kind));
}

// --- what is wrong with the record

/// Returns "record 2: " of several.
std::string WhichRecord(const Finding& finding) {
  const std::optional<double> record = finding.Number("record");
  return record ? fmt::format("record {:.0f}: ", *record) : std::string();
}

std::string ReversalsUncertain(const Finding& finding, const FitResult&, const Units& units) {
  return fmt::format(
      "{}the number of reversals is not certain: {:.0f} if excursions up to {} are noise (as "
      "assumed here), {:.0f} if those up to {} are; look at the plot and give --reversal-gate",
      WhichRecord(finding), Needed(finding, "count"),
      Quantity(Needed(finding, "gate"), units.excitation, 3), Needed(finding, "other_count"),
      Quantity(Needed(finding, "other_gate"), units.excitation, 3));
}

std::string GlitchesLeftOut(const Finding& finding, const FitResult&, const Units&) {
  std::vector<std::string> kinds;
  for (const auto& [name, words] :
       {std::pair("spikes", "spikes"), std::pair("dropouts", "dropouts"),
        std::pair("held", "held values")}) {
    const double count = Needed(finding, name);
    if (count > 0) kinds.push_back(fmt::format("{:.0f} {}", count, words));
  }
  std::vector<std::string> rows;
  double total = Needed(finding, "spikes") + Needed(finding, "dropouts") + Needed(finding, "held");
  for (const auto& [name, number] : finding.numbers) {
    if (name == "row") rows.push_back(fmt::format("{:.0f}", number));
  }
  return fmt::format("{}measurement faults left out: {}, {} data row{} {}", WhichRecord(finding),
                     fmt::join(kinds, ", "),
                     static_cast<double>(rows.size()) < total ? "first in" : "in",
                     rows.size() == 1 ? "" : "s", fmt::join(rows, ", "));
}

std::string PathTooLong(const Finding& finding, const FitResult&, const Units&) {
  return fmt::format(
      "{}the path through the samples is {:.3g} times as long as the strokes: either reversals "
      "were taken for noise, or noise was taken for motion; record the displacement with less "
      "noise, or give --reversal-gate or --displacement-noise",
      WhichRecord(finding), Needed(finding, "path_ratio"));
}

std::string NoClosedCycle(const Finding& finding, const FitResult&, const Units&) {
  return fmt::format(
      "{}no cycle is closed, so nothing was measured without a model; record at least one and a "
      "half cycles",
      WhichRecord(finding));
}

// --- what the record does not determine

std::string ShapeOrRig(const Finding& finding, const FitResult&, const Units& units) {
  return fmt::format(
      "alpha: Mindlin's alpha = 1/3 with a rig of {} in series fits as well as alpha = {:.3g} with "
      "a rigid rig: the record does not distinguish them, and sigma is the stiffness of contact "
      "and rig together; measure the rig's stiffness and give --rig-stiffness",
      Quantity(Needed(finding, "rig_stiffness"), units.stiffness, 4), Needed(finding, "alpha"));
}

/// True if the record itself shows a loop that slides: then no larger amplitude is asked for.
bool Slides(const FitResult& fit) {
  return !fit.records.empty() && loop::Slides(fit.WidestRecord().facts);
}

std::string SlipForceBoundedBelow(const Finding& finding, const FitResult& fit,
                                  const Units& units) {
  if (Slides(fit)) {
    return fmt::format(
        "slip_force: the contact slides, but its force keeps changing meanwhile (T* = {}), as if "
        "slip were not reached: any larger slip force fits as well; the measured half gap remains "
        "valid",
        Quantity(Needed(finding, "peak_force"), units.force, 4));
  }
  return fmt::format(
      "slip_force: the loop (T* = {} at X = {}) does not approach gross slip and fits any larger "
      "slip force as well; raise the amplitude until the force levels off (mindahl plan --record "
      "says how far)",
      Quantity(Needed(finding, "peak_force"), units.force, 4),
      Quantity(Needed(finding, "amplitude"), units.displacement, 4));
}

/// True if slip is seen: then a larger amplitude shows less of the branches still.
bool SeesSlip(const FitResult& fit) {
  const identification::ParameterEstimate* slip_force = fit.Find("slip_force");
  return Slides(fit) || (slip_force != nullptr && slip_force->is_known());
}

std::string TooWide(const char* parameter, const Finding& finding, const FitResult& fit,
                    std::string_view unit) {
  using identification::IntervalSource;
  const identification::ParameterEstimate* estimate = fit.Find(parameter);
  const bool is_of_model =
      estimate != nullptr && (estimate->IsSetBy(IntervalSource::kDiscrepancy) ||
                              estimate->IsSetBy(IntervalSource::kOmittedTerms));
  const char* const remedy =
      is_of_model ? ": it includes what the model misses, which more samples do not change"
      : SeesSlip(fit)
          ? "; record more samples, or less noise (mindahl plan --record says which)"
          : "; record more samples, less noise or a larger amplitude (mindahl plan --record says "
            "which)";
  return fmt::format("{}: the {} interval {} … {} is too wide for a usable value{}", parameter,
                     ConfidenceWords(fit), Quantity(Needed(finding, "lower"), unit, 3),
                     Quantity(Needed(finding, "upper"), unit, 3), remedy);
}

std::string AlphaNotIdentifiable(const Finding& finding, const FitResult& fit, const Units&) {
  if (finding.kind == "wide") return TooWide("alpha", finding, fit, "-");
  if (finding.kind != "with_slip_force") ThrowKind(finding);
  if (Slides(fit)) {
    return "alpha: the record determines only its combination with slip_force, since the force "
           "keeps changing while the contact slides; fix one of them";
  }
  return "alpha: the record determines only the ratio alpha/slip_force; raise the amplitude until "
         "the force levels off (mindahl plan --record says how far), or fix one of them";
}

std::string SigmaNotIdentifiable(const Finding& finding, const FitResult& fit, const Units& units) {
  if (finding.kind != "wide") ThrowKind(finding);
  return TooWide("sigma", finding, fit, units.stiffness);
}

std::string SlipForceNotIdentifiable(const Finding& finding, const FitResult& fit,
                                     const Units& units) {
  if (finding.kind != "wide") ThrowKind(finding);
  return TooWide("slip_force", finding, fit, units.force);
}

std::string SigmaBoundedBelow(const Finding&, const FitResult&, const Units&) {
  return "sigma: a rigid contact (sigma without limit) fits as well; sample more densely after the "
         "reversals, or lower the amplitude";
}

std::string UndeterminedParameter(const Finding& finding, const FitResult&, const Units&) {
  const bool one = finding.parameters.size() == 1;
  return fmt::format("{}: the record does not depend on {}; fix {}, or record another amplitude",
                     fmt::join(finding.parameters, ", "), one ? "it" : "any of them",
                     one ? "it" : "them");
}

std::string UndeterminedCombination(const Finding& finding, const FitResult& fit, const Units&) {
  return fmt::format(
      "the record determines only a combination of {}: fix one of them, or {}",
      fmt::join(finding.parameters, ", "),
      SeesSlip(fit) ? "sample more densely after the reversals" : "record a larger amplitude");
}

std::string AsymmetryNotIdentifiable(const Finding& finding, const FitResult&, const Units&) {
  return fmt::format(
      "{}: the loop stays {:.2g} % of slip_force below slip, and a part of the contact that never "
      "slips may bear any constant force; raise the amplitude until the whole contact slips, or "
      "begin the record with an unloaded contact",
      fmt::join(finding.parameters, ", "), 100 * Needed(finding, "never_slips"));
}

std::string SearchLimit(const Finding& finding, const FitResult& fit, const Units&) {
  const std::string& name = finding.parameters.front();
  const identification::ParameterEstimate* estimate = fit.Find(name);
  return fmt::format(
      "{}: the search stopped at its limit, {}: the best value lies beyond it, and these "
      "do not describe the contact; give --bound {}=LO:HI, or remove its effect from the record",
      fmt::join(finding.parameters, ", "),
      Quantity(Needed(finding, "bound"), estimate == nullptr ? "-" : estimate->unit, 4), name);
}

std::string FewPlaces(const Finding& finding, const FitResult&, const Units&) {
  return fmt::format(
      "sigma, alpha: all {:.0f} samples lie in {:.0f} places of the loop, the same in every cycle, "
      "so the loop between them, with its turning points, is not seen. Sample out of step with the "
      "motion, or more often",
      Needed(finding, "samples"), Needed(finding, "places"));
}

std::string LoopNotSeen(const Finding& finding, const FitResult&, const Units&) {
  const double r_squared = Needed(finding, "r_squared");
  const std::string share = r_squared > 0
                                ? fmt::format("{:.2g} % of the force's variance", 100 * r_squared)
                                : std::string("nothing of the force");
  return fmt::format(
      "sigma, alpha, slip_force: the fitted loop explains {}: the record shows something else. "
      "Look at the plot: are displacement and force the right columns, and not swapped? A shorter "
      "part of the record, or less noise, may show a loop",
      share);
}

std::string ModelInadequate(const Finding& finding, const FitResult& fit, const Units&) {
  const bool is_all = std::ranges::none_of(
      fit.parameters, &identification::ParameterEstimate::includes_discrepancy);
  return fmt::format(
      "{} does not describe this record: {} not to be used; what was measured without a model "
      "remains valid",
      fit.model->name,
      is_all ? std::string("its parameters are")
             : fmt::format("{} {}", fmt::join(finding.parameters, ", "),
                           finding.parameters.size() > 1 ? "are" : "is"));
}

std::string SlipForceExtrapolated(const Finding& finding, const FitResult& fit, const Units&) {
  if (Slides(fit)) {
    return fmt::format(
        "slip_force: it is the asymptote of a law with alpha = {:.3g}, and the measured force "
        "reaches only {:.0f} % of it although the contact slides; the measured half gap remains "
        "valid",
        Needed(finding, "alpha"), 100 * Needed(finding, "share"));
  }
  return fmt::format(
      "slip_force: it is the asymptote of a law with alpha = {:.3g}, and the measured force "
      "reaches only {:.0f} % of it; raise the amplitude until the force levels off",
      Needed(finding, "alpha"), 100 * Needed(finding, "share"));
}

std::string UnknownPast(const Finding& finding, const FitResult&, const Units&) {
  if (finding.kind == "one_stroke") {
    return "sigma, alpha, slip_force: the record is one stroke, which fits equally well wherever "
           "the contact was unloaded (drawn here: at the first sample). Give --initial-state "
           "virgin if the contact was unloaded there, or record a whole cycle";
  }
  if (finding.kind != "cut") ThrowKind(finding);
  return "alpha, slip_force: the record closes no cycle and does not start from an unloaded "
         "contact: its earlier loading is not known; record a whole cycle, or give --initial-state "
         "virgin if the contact was unloaded at the start";
}

std::string InitialStateUndecided(const Finding& finding, const FitResult& fit, const Units&) {
  const bool virgin = fit.initial_state == models::InitialState::kVirgin;
  return fmt::format(
      "{}: the record does not determine whether it starts from an unloaded contact or within a "
      "steady loop: the values assume {}, the intervals cover both; give --initial-state, or "
      "record more cycles",
      fmt::join(finding.parameters, ", "), virgin ? "an unloaded contact" : "a steady loop");
}

std::string SeveralMinima(const Finding& finding, const FitResult&, const Units&) {
  return fmt::format(
      "{}: the sum of squares has a second minimum, with other values, that the noise does not "
      "exclude: the intervals cover both; record more samples near the onset of slip, or a larger "
      "amplitude",
      fmt::join(finding.parameters, ", "));
}

std::string NameOfLaw(std::string_view model) {
  return model == "dahl" ? "Dahl's own law" : "Masing's law";
}

/// Returns "sigma = 46 N/µm and slip_force = 15 N" of those of the finding's parameters that the
/// fit knows; may be empty.
std::string KnownOf(const Finding& finding, const FitResult& fit, const Units& units) {
  const auto is_known = [&](std::string_view name) {
    if (std::ranges::find(finding.parameters, name) == finding.parameters.end()) return false;
    const identification::ParameterEstimate* estimate = fit.Find(name);
    return estimate == nullptr || estimate->is_known();
  };
  std::vector<std::string> known;
  if (is_known("sigma")) {
    known.push_back("sigma = " + Quantity(Needed(finding, "sigma"), units.stiffness, 5));
  }
  if (is_known("slip_force")) {
    known.push_back("slip_force = " + Quantity(Needed(finding, "slip_force"), units.force, 5));
  }
  return fmt::format("{}", fmt::join(known, " and "));
}

std::string LawUndecided(const Finding& finding, const FitResult& fit, const Units& units) {
  const std::optional<double> delta_aicc = finding.Number("delta_aicc");
  const std::string known = KnownOf(finding, fit, units);
  return fmt::format(
      "{}: the record does not distinguish {} from {} ({}){}; start from an unloaded contact, or "
      "record a second amplitude",
      fmt::join(finding.parameters, ", "), NameOfLaw(fit.model->name), NameOfLaw(finding.kind),
      delta_aicc ? fmt::format("ΔAICc = {:.3g}", *delta_aicc)
                 : std::string("they give the same steady loop at any one amplitude"),
      known.empty() ? "" : fmt::format("; the latter gives {}", known));
}

std::string OtherLawFitsBetter(const Finding& finding, const FitResult& fit, const Units& units) {
  return fmt::format(
      "{}: {} fits this record better than {} (ΔAICc = {:.3g}), with sigma = {}, alpha = {:.4g} "
      "and "
      "slip_force = {}; try --model {}",
      fmt::join(finding.parameters, ", "), NameOfLaw(finding.kind), NameOfLaw(fit.model->name),
      Needed(finding, "delta_aicc"), Quantity(Needed(finding, "sigma"), units.stiffness, 5),
      Needed(finding, "alpha"), Quantity(Needed(finding, "slip_force"), units.force, 5),
      finding.kind);
}

// --- what the model misses

struct MisfitKind {
  std::string_view kind;
  const char* words;
  std::string_view of_displacement = {};  // where that is fitted; empty: the same
};

constexpr std::array<MisfitKind, 5> kMisfitKinds = {{
    {"same_on_return", "the same on the return stroke: a force that depends on the position",
     "the same on the return stroke: a nonlinear spring in series"},
    {"mirrored_early",
     "just after each reversal, with opposite sign on the return stroke: backlash, or a stiffness "
     "that is not the contact's"},
    {"one_sided_early",
     "just after the reversal, different on the return stroke: backlash on one side, or an "
     "asymmetric drive"},
    {"mirrored", "with opposite sign on the return stroke: the loop has another shape"},
    {"asymmetric", "different on the return stroke: asymmetric friction"},
}};

std::string WhereItRepeats(const Finding& finding, const FitResult& fit, const Units& units) {
  const bool is_of_force = fit.response == loop::Channel::kForce;
  for (const MisfitKind& kind : kMisfitKinds) {
    if (kind.kind != finding.kind) continue;
    return fmt::format(
        "{:.0f} % of the residuals' variance repeats in every stroke, up to {} at {:.0f} % of the "
        "{} stroke, {}",
        100 * Needed(finding, "repeatable_share"),
        Quantity(std::abs(Needed(finding, "largest")), units.response, 3),
        100 * Needed(finding, "position"), Needed(finding, "direction") > 0 ? "up" : "down",
        is_of_force || kind.of_displacement.empty() ? kind.words : kind.of_displacement);
  }
  ThrowKind(finding);
}

std::string NoModelFits(const Finding& finding, const FitResult& fit, const Units& units) {
  return fmt::format("{} cannot follow this record (rms {:.3g} % of the {}): {}", fit.model->name,
                     100 * Needed(finding, "misfit"), Name(fit.response),
                     WhereItRepeats(finding, fit, units));
}

std::string SystematicResidual(const Finding& finding, const FitResult& fit, const Units& units) {
  return fmt::format(
      "{} leaves a repeatable residual (rms {:.3g} % of the {}): {}. The intervals include it{}",
      fit.model->name, 100 * Needed(finding, "misfit"), Name(fit.response),
      WhereItRepeats(finding, fit, units),
      fit.response == loop::Channel::kForce ? "; compare with --model auto" : "");
}

std::string SlowResiduals(const Finding& finding, const FitResult&, const Units&) {
  return fmt::format(
      "the residual drifts slowly, over {:.2g} strokes, as noise would not: the model lacks a "
      "change with time or from cycle to cycle; plot the residual against time, or fit parts of "
      "the record with --cycles",
      Needed(finding, "strokes"));
}

std::string EnergyContradiction(const Finding& finding, const FitResult& fit, const Units& units) {
  return fmt::format(
      "the steady cycles dissipate {} each, but {} as fitted dissipates {} at their amplitude of "
      "{}: the fit does not describe them; look at the plot for missed reversals, glitches or a "
      "force that the model lacks",
      Quantity(Needed(finding, "measured"), "J", 4), fit.model->name,
      Quantity(Needed(finding, "model"), "J", 4),
      Quantity(Needed(finding, "amplitude"), units.displacement, 4));
}

// --- the normal load

std::string LoadFollowed(const Finding& finding, const FitResult& fit, const Units&) {
  const bool is_joint = fit.model->memory == models::Memory::kNone;
  return fmt::format("{}the normal load varies by ±{:.3g} %: the law follows it, with {}",
                     WhichRecord(finding), 100 * Needed(finding, "variation"),
                     is_joint
                         ? "the force in proportion to it; σ and Tc are given at its mean magnitude"
                         : "Tc = μN and σ ∝ N^α within the record; σ and Tc are given at its mean");
}

std::string LoadNotFollowed(const Finding& finding, const FitResult& fit, const Units&) {
  const bool is_rigid = std::isinf(fit.rig.stiffness);
  return fmt::format(
      "{}the normal load varies by ±{:.3g} %, which {} does not model: the fit takes the load as "
      "constant; keep to one load with --load-window, or use --model mindlin-dahl without {}",
      WhichRecord(finding), 100 * Needed(finding, "variation"),
      is_rigid ? std::string(fit.model->name) : fmt::format("{} behind a rig", fit.model->name),
      fit.Find("asymmetry") == nullptr ? "a rig" : "a rig or an asymmetry");
}

std::string RigNotTried(const Finding& finding, const FitResult&, const Units&) {
  const bool is_forced = finding.kind == "imposed_force";
  return fmt::format(
      "alpha = {:.3g} may be Mindlin's 1/3 changed by a compliant rig, which cannot be tested {}: "
      "sigma and alpha describe contact and rig together; {}",
      Needed(finding, "alpha"),
      is_forced ? "in a fit of the displacement" : "under a load that varies",
      is_forced ? "measure the rig's stiffness and subtract its deflection from the displacement"
                : "keep to one load with --load-window, or measure the rig's stiffness");
}

std::string PriorContradicted(const Finding& finding, const FitResult&, const Units&) {
  return fmt::format(
      "the prior of {} lies {:.2g} standard deviations from the estimate without it: the fit lies "
      "between the two and agrees with neither; check the prior and its unit, and the model",
      fmt::join(finding.parameters, ", "), Needed(finding, "distance"));
}

std::string NoiseInDisplacement(const Finding& finding, const FitResult&, const Units&) {
  return fmt::format(
      "the displacement is the noisier channel, {:.2g} % of X against {:.2g} % of T*, and the "
      "contact stays below slip: if the machine imposes the force, fit the displacement instead, "
      "with --noise-in displacement",
      100 * Needed(finding, "of_displacement"), 100 * Needed(finding, "of_force"));
}

std::string AlphaLimitedByLoad(const Finding& finding, const FitResult&, const Units&) {
  return fmt::format(
      "alpha would be {:.3g} or more, beyond the limit of the law for a varying load, whose slip "
      "is complete at a finite displacement; keep to one load with --load-window",
      Needed(finding, "bound"));
}

// --- what the solver did not reach

std::string WeightsNotSettled(const Finding&, const FitResult&, const Units&) {
  return "the weights of the samples did not settle: the fit did not converge; try another --loss";
}

std::string FitFailed(const Finding&, const FitResult& fit, const Units&) {
  return fmt::format(
      "the fit failed, so no parameter, residual, loop, contact or mapping value was computed: {}",
      fit.solver.message);
}

struct SentenceRow {
  FindingCode code;
  std::string (*sentence)(const Finding&, const FitResult&, const Units&);
};

constexpr auto kSentences = std::to_array<SentenceRow>({
    {"reversals_uncertain", ReversalsUncertain},
    {"glitches_left_out", GlitchesLeftOut},
    {"path_too_long", PathTooLong},
    {"no_closed_cycle", NoClosedCycle},
    {"load_followed", LoadFollowed},
    {"load_not_followed", LoadNotFollowed},
    {"noise_in_displacement", NoiseInDisplacement},
    {"undetermined_parameter", UndeterminedParameter},
    {"undetermined_combination", UndeterminedCombination},
    {"sigma_not_identifiable", SigmaNotIdentifiable},
    {"alpha_not_identifiable", AlphaNotIdentifiable},
    {"slip_force_not_identifiable", SlipForceNotIdentifiable},
    {"asymmetry_not_identifiable", AsymmetryNotIdentifiable},
    {"sigma_bounded_below", SigmaBoundedBelow},
    {"slip_force_bounded_below", SlipForceBoundedBelow},
    {"slip_force_extrapolated", SlipForceExtrapolated},
    {"alpha_limited_by_load", AlphaLimitedByLoad},
    {"search_limit", SearchLimit},
    {"few_places", FewPlaces},
    {"unknown_past", UnknownPast},
    {"initial_state_undecided", InitialStateUndecided},
    {"several_minima", SeveralMinima},
    {"shape_or_rig", ShapeOrRig},
    {"rig_not_tried", RigNotTried},
    {"prior_contradicted", PriorContradicted},
    {"law_undecided", LawUndecided},
    {"other_law_fits_better", OtherLawFitsBetter},
    {"systematic_residual", SystematicResidual},
    {"slow_residuals", SlowResiduals},
    {"energy_contradiction", EnergyContradiction},
    {"loop_not_seen", LoopNotSeen},
    {"no_model_fits", NoModelFits},
    {"model_inadequate", ModelInadequate},
    {"weights_not_settled", WeightsNotSettled},
    {"fit_failed", FitFailed},
});

constexpr bool EveryFindingHasASentence() {
  if (kSentences.size() != identification::kFindings.size()) return false;
  for (std::size_t i = 0; i < kSentences.size(); ++i) {
    if (std::string_view(kSentences[i].code) != identification::kFindings[i].code) return false;
  }
  return true;
}
static_assert(EveryFindingHasASentence(), "one row a finding, in the order of kFindings");

}  // namespace

std::string Sentence(const Finding& finding, const FitResult& fit, const Units& units) {
  const auto place = &finding.code.row() - identification::kFindings.data();
  return kSentences[static_cast<std::size_t>(place)].sentence(finding, fit, units);
}

}  // namespace mindahl::report
