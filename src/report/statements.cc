#include "report/statements.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "mindahl/core/error.h"

namespace mindahl::report {

namespace {

/// Returns "5.6 %" of 0.056; no share is said to less than a hundredth of a per cent.
std::string PercentText(double share) {
  constexpr double kLeast = 1e-4;
  if (share > 0 && share < kLeast) return "< 0.01 %";
  return fmt::format("{} %", Quantity(100 * share, "-", 2));
}

/// Sentences by the code of a finding; a row "code.kind" goes before that of its code. Numbers of
/// the finding stand in braces: {count}, {share%}, in a unit {gate:excitation}.
constexpr auto kSentences = std::to_array<std::pair<std::string_view, std::string_view>>({
    // about the record
    {"reversals_uncertain",
     "{count} reversals, under a gate of {gate:excitation} that is not certain: --reversal-gate"},
    {"no_closed_cycle",
     "no cycle ends where it began: record one and a half or more of one amplitude"},
    {"rows_missing",
     "no rows for {gap:s} from {from:s} on, and what turned there is not seen: --select "
     "time=LO:HI"},
    {"load_varies.followed", "the normal load varies by ±{variation%}, which the law follows"},
    {"load_varies",
     "the normal load varies by ±{variation%}, which this fit takes as constant: choose samples of "
     "one load"},
    {"load_varies.not_proportional",
     "the half gap over the load goes from {least:-} to {most:-}: Tc is not in proportion to these "
     "loads; mindahl batch fits the files apart"},
    // about the parameters
    {"not_identifiable", "the record does not depend on it"},
    {"not_identifiable.combination",
     "only a combination of {parameters} is determined; fix one, or record another amplitude"},
    {"not_identifiable.wide",
     "{confidence} interval {lower:parameter} … {upper:parameter} is too wide{remedy}"},
    {"not_identifiable.with_slip_force",
     "only its ratio to the slip force is determined; fix one of them"},
    {"not_identifiable.with_spring",
     "a parallel spring stands for it: raise the amplitude until the loop slides, or fix "
     "plateau_slope"},
    {"not_identifiable.below_slip", "the loop stays below slip"},
    {"bounded_below",
     "the force does not level off: raise the amplitude until it does (mindahl plan says how far)"},
    {"bounded_below.slides", "the force keeps changing while the contact slides"},
    {"search_limit", "the search stopped at its limit; give --bound {parameter}=LO:HI"},
    {"force_at_limit",
     "the force reads {limit:force} in {share%} of the samples, to the last digit: the sensor is "
     "at its limit, and Tc is no less"},
    {"not_identifiable.few_places",
     "all samples lie in {places} places of the loop: sample out of step with the motion, or more "
     "often"},
    {"unknown_past.elsewhere",
     "the loop began at a turn that is not recorded: start from the unloaded contact, or from the "
     "end of a stroke as wide as any before it"},
    {"unknown_past",
     "the record does not end as it began, and the earlier loading is not known: record more "
     "cycles, or give --initial-state virgin"},
    {"shape_or_rig",
     "a rig of {rig_stiffness:stiffness} with Mindlin's 1/3 fits as well as a rigid one: measure "
     "the rig, and give --rig-stiffness"},
    {"prior_contradicted.held",
     "the value that is held lies {distance} standard deviations from what the record says: fit "
     "it"},
    {"prior_contradicted",
     "the prior lies {distance} standard deviations from what the record says"},
    // about the law and what it misses
    {"other_law", "the other law fits as well"},
    {"other_law.better", "the other law fits better"},
    {"model_inadequate.no_loop",
     "no loop is seen: the fit explains {r_squared%} of the force's variance; are these the right "
     "columns?"},
    {"model_inadequate", "the law does not describe the record"},
    // about the search
    {"not_converged.weights", "the weights of the samples did not settle; try another --loss"},
    {"not_converged", "{message}"},
});

/// Returns the unit of a placeholder: one of the report's, or itself.
std::string_view UnitOf(std::string_view name, const Finding& finding, const Units& units) {
  if (name == "parameter") {
    const std::string& of = finding.parameters.front();
    name = of == "sigma" ? "stiffness" : of == "slip_force" ? "force" : "-";
  }
  if (name == "force") return units.force;
  if (name == "stiffness") return units.stiffness;
  return name == "excitation" ? units.excitation : name;
}

std::string ValueOf(std::string_view place, const Finding& finding, const FitResult& fit,
                    const Units& units) {
  if (place == "parameters") return fmt::format("{}", fmt::join(finding.parameters, ", "));
  if (place == "parameter") return finding.parameters.empty() ? "NAME" : finding.parameters.front();
  if (place == "confidence") return fmt::format("{:.4g} %", 100 * fit.confidence);
  if (place == "message") return fit.solver.message;
  if (place == "remedy") {  // none of what the model misses
    const bool is_noise = fit.adequacy.verdict == AdequacyVerdict::kAdequate;
    return is_noise ? "; more samples or less noise" : "";
  }
  const std::size_t colon = place.find(':');
  const bool is_percent = place.ends_with('%');
  const std::string_view name = place.substr(0, is_percent ? place.size() - 1 : colon);
  const double number = finding.Number(name).value_or(std::numeric_limits<double>::quiet_NaN());
  if (colon != std::string_view::npos) {
    return Quantity(number, UnitOf(place.substr(colon + 1), finding, units), 3);
  }
  if (is_percent) return PercentText(std::max(number, 0.0));
  return number == std::round(number) ? fmt::format("{:.0f}", number)
                                      : fmt::format("{:.2g}", number);
}

}  // namespace

std::string NameOf(std::span<const std::string> files) {
  std::string name = std::filesystem::path(files.front()).filename().string();
  if (files.size() > 1) name += fmt::format(" and {} more", files.size() - 1);
  return name;
}

bool IsJudged(const Report& report) { return !report.failed() && report.fit.adequacy.tried > 0; }

std::string_view VerdictWord(const Report& report) {
  if (report.failed()) return "failed";
  if (!report.fit.converged) return "not converged";
  return IsJudged(report) ? Name(report.fit.adequacy.verdict) : "not judged";
}

std::string_view JudgementOf(std::string_view verdict) {
  if (verdict == "adequate") return kGood;
  return verdict == "doubtful" || verdict == "not judged" ? kPoor : kBad;
}

std::string_view JudgementOf(const ParameterEstimate& estimate) {
  const Shown shown = WhatIsShown(estimate);
  if (!shown.how_given.empty()) return kPlain;
  if (!shown.value && !shown.lower && !shown.upper) return kBad;
  return estimate.identifiability == Identifiability::kIdentifiable ? kGood : kPoor;
}

Shown WhatIsShown(const ParameterEstimate& estimate) {
  const std::optional<double>& lower = estimate.lower95;
  const std::optional<double>& upper = estimate.upper95;
  if (estimate.status == ParameterStatus::kFixed) return {estimate.value, {}, {}, "held"};
  if (estimate.identifiability == Identifiability::kBoundedBelow) return {{}, lower, {}};
  if (!estimate.is_known()) return {};
  if (estimate.is_at_given_bound()) {
    return {estimate.value, lower, upper, "at the bound that was given"};
  }
  if (estimate.status == ParameterStatus::kAtLowerBound) return {{}, {}, upper};
  if (estimate.status == ParameterStatus::kAtUpperBound && !upper) return {{}, lower, {}};
  return {estimate.value, lower, upper};
}

std::string ValueText(const ParameterEstimate& estimate) {
  const auto [value, lower, upper, how_given] = WhatIsShown(estimate);
  if (!how_given.empty()) {
    return fmt::format("{} ({})", QuantityWithInterval(value, {}, {}, estimate.unit), how_given);
  }
  const std::string text = QuantityWithInterval(value, lower, upper, estimate.unit);
  return text.empty() ? "not determined" : text;
}

std::string MisfitShare(double over_half_gap) {
  return fmt::format("{} the half gap",
                     over_half_gap >= 1 ? "more than" : PercentText(over_half_gap) + " of");
}

std::string NextStatement(const NextStep& next) {
  const std::string before = PercentText(next.misfit_before);
  const std::string change = next.is_over_amplitude
                                 ? fmt::format("{} of the half gap → {} of the amplitude", before,
                                               PercentText(next.misfit_after))
                                 : fmt::format("{} → {}", before, MisfitShare(next.misfit_after));
  return fmt::format("{}{}misfit {} (tried)", next.text, next.text.empty() ? "" : ", ", change);
}

void RequireFitted(const Report& report, std::string_view what) {
  if (!report.failed()) return;
  throw InvalidArgument(fmt::format("a fit that failed has no curve and no residual for {}: {}",
                                    what, report.fit.solver.message));
}

std::string Sentence(const Finding& finding, const FitResult& fit, const Units& units) {
  const std::string_view code = finding.code;
  std::string_view text = code;
  for (const std::string& key : {std::string(code), fmt::format("{}.{}", code, finding.kind)}) {
    const auto row = std::ranges::find(kSentences, key, [](const auto& of) { return of.first; });
    if (row != kSentences.end()) text = row->second;
  }
  std::string sentence;
  if (const std::optional<double> record = finding.Number("record")) {
    sentence = fmt::format("record {:.0f}: ", *record);
  }
  for (std::size_t open = text.find('{'); open != std::string_view::npos; open = text.find('{')) {
    const std::size_t close = text.find('}', open);
    sentence += text.substr(0, open);
    sentence += ValueOf(text.substr(open + 1, close - open - 1), finding, fit, units);
    text.remove_prefix(close + 1);
  }
  return sentence.append(text);
}

std::string WarningText(const Finding& finding, const Report& report) {
  return fmt::format("{}{}{}", fmt::join(finding.parameters, ", "),
                     finding.parameters.empty() ? "" : ": ",
                     Sentence(finding, report.fit, report.units));
}

}  // namespace mindahl::report
