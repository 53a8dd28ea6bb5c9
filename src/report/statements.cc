#include "report/statements.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string_view>
#include <utility>

#include "core/probability.h"
#include "mindahl/core/error.h"
#include "mindahl/identification/thresholds.h"
#include "mindahl/report/units.h"
#include "report/adequacy.h"
#include "report/fields.h"
#include "report/names.h"

namespace mindahl::report {

using contact::PropagatedValue;
using identification::FitResult;
using identification::Identifiability;
using identification::IntervalSource;
using identification::ParameterEstimate;
using identification::ParameterStatus;

namespace {

/// Returns a trend over the cycles in words, where it is worth any.
std::string TrendText(const char* what, const std::optional<loop::Trend>& trend,
                      const std::optional<double>& mean) {
  if (!trend || !mean || !identification::IsWorthSaying(*trend, *mean)) return "";
  return fmt::format("{} changes by {:+.2g} ± {:.1g} % a cycle (p = {:.1g})", what,
                     100 * trend->slope / std::abs(*mean),
                     100 * trend->standard_error / std::abs(*mean), trend->p_value);
}

std::string_view TestVerdict(double p_value) {
  return p_value < kSignificance ? "rejected" : "tenable";
}

}  // namespace

std::string NameOf(std::span<const std::string> files) {
  const std::string first = std::filesystem::path(files.front()).filename().string();
  return files.size() > 1 ? fmt::format("{} and {} more", first, files.size() - 1) : first;
}

std::string TitleOf(const Report& report) {
  return fmt::format("{}: {}", NameOf(report.files), VerdictWord(report));
}

std::string_view VerdictWord(const Report& report) {
  if (report.failed()) return "failed";
  if (!report.fit.converged) return "not converged";
  return IsJudged(report) ? Name(report.fit.adequacy.verdict) : "not judged";
}

Judgement JudgementOf(std::string_view verdict) {
  if (verdict == "adequate") return Judgement::kGood;
  return verdict == "doubtful" || verdict == "not judged" ? Judgement::kPoor : Judgement::kBad;
}

Judgement JudgementOf(const ParameterEstimate& estimate) {
  if (estimate.is_known()) return Judgement::kGood;
  return WhatIsShown(estimate) == Shown::kNothing ? Judgement::kBad : Judgement::kPoor;
}

Shown WhatIsShown(const ParameterEstimate& estimate) {
  if (estimate.status == ParameterStatus::kFixed) return Shown::kHeld;
  if (estimate.identifiability == Identifiability::kNotIdentifiable) return Shown::kNothing;
  if (estimate.identifiability == Identifiability::kBoundedBelow) return Shown::kLowerLimit;
  return Shown::kValue;
}

std::string Words(Identifiability identifiability) {
  std::string words(Name(identifiability));
  std::ranges::replace(words, '_', ' ');
  return words;
}

std::string PlainName(std::string_view key) {
  if (key == "sigma") return "stiffness σ";
  if (key == "alpha") return "shape exponent α";
  if (key == "slip_force") return "slip force Tc";
  if (key.ends_with(".value")) key.remove_suffix(std::string_view(".value").size());
  std::string name;
  for (const char character : key) {
    if (character == '.') name += ',';
    name += character == '_' || character == '.' ? ' ' : character;
  }
  return name;
}

std::string ConfidenceWords(const FitResult& fit) {
  return fmt::format("{:g} %", 100 * fit.confidence);
}

std::string VerdictWords(const ParameterEstimate& estimate) {
  if (estimate.status == ParameterStatus::kFixed) return "fixed";
  const bool is_free = estimate.status == ParameterStatus::kFree;
  return Words(estimate.identifiability) + (is_free ? "" : ", at bound");
}

std::string ChanceText(double p_value, int digits) {
  constexpr double kLeast = 1e-12;
  return p_value < kLeast ? "p < 1e-12" : fmt::format("p = {:.{}g}", p_value, digits);
}

bool IsIdentified(const Report& report, const ContactField& field, const PropagatedValue& value) {
  if (!std::isfinite(value.standard_error)) return false;
  const bool knows_stiffness = report.fit.Find("sigma")->is_known();
  const bool knows_slip_force = report.fit.Find("slip_force")->is_known();
  const bool is_of_radius_alone =
      field.key == "maximum_pressure" && report.known.contact_radius.has_value();
  if (!knows_stiffness && field.key != "friction_coefficient" && !is_of_radius_alone) return false;
  if (field.key != "mindlin_gross_slip_displacement") return true;
  return knows_slip_force && report.fit.Find("alpha")->is_known();
}

std::string VarianceStatement(const PropagatedValue& value) {
  if (value.largest_input.empty()) return "";
  return fmt::format("variance: fit {:.0f} %, inputs {:.0f} %, mostly the {}",
                     100 * value.FitShare(), 100 * value.InputShare(), value.largest_input);
}

std::string SlipStatement(const LoopDescription& loop, const Units& units) {
  if (loop.sliding_fraction) {
    return fmt::format("gross, it slides over {:.0f} % of the stroke",
                       100 * *loop.sliding_fraction);
  }
  if (!loop.regime) return "slip regime not determined: slip_force is not identifiable";
  if (loop.gross_slip_displacement) {
    return fmt::format("{}, the whole contact slips above an amplitude of {}", Name(*loop.regime),
                       Quantity(*loop.gross_slip_displacement, units.displacement, 5));
  }
  if (!loop.knows_slip) {
    return fmt::format("{} (gross-slip displacement not identified)", Name(*loop.regime));
  }
  return fmt::format("{:.3g} % of Tc reached: with α >= 1 the force only approaches it",
                     100 * loop.slip_force_share);
}

std::string PriorStatement(const FitResult& fit) {
  std::vector<std::string> priors;
  std::vector<std::string> moved;
  for (const ParameterEstimate& estimate : fit.parameters) {
    if (estimate.prior) {
      priors.push_back(
          fmt::format("{} = {}", estimate.name,
                      QuantityWithError(estimate.prior->value, estimate.prior->standard_uncertainty,
                                        estimate.unit)));
    }
    if (const std::optional<double> by = estimate.MovedByPriors()) {
      moved.push_back(fmt::format("{} by {:+.2g}", estimate.name, *by));
    } else if (estimate.without_priors && estimate.status != ParameterStatus::kFixed) {
      moved.push_back(fmt::format("{}, which the record alone does not determine", estimate.name));
    }
  }
  if (priors.empty()) return "";
  return fmt::format("prior: {}; it moves {} (in standard errors of the fit without it)",
                     fmt::join(priors, ", "), fmt::join(moved, ", "));
}

std::string WideIntervalStatement(const FitResult& fit, const Units& units) {
  if (fit.adequacy.verdict != identification::AdequacyVerdict::kDoubtful) return "";
  const double quantile = NormalQuantile(fit.confidence);
  constexpr double kFar = 3.0;  // as wide as of an error that is taken three times too small
  std::vector<const ParameterEstimate*> wide;
  for (const ParameterEstimate& estimate : fit.parameters) {
    const double error = estimate.standard_error.value_or(0.0);
    const bool has_both = estimate.lower95 && estimate.upper95;
    if (WhatIsShown(estimate) != Shown::kValue || !has_both || !(error > 0)) continue;
    const double ratio = (*estimate.upper95 - *estimate.lower95) / (2 * quantile * error);
    if (!(ratio > kFar)) continue;
    wide.push_back(&estimate);
  }
  const auto any_set_by = [&](IntervalSource source) {
    return std::ranges::any_of(
        wide, [&](const ParameterEstimate* estimate) { return estimate->IsSetBy(source); });
  };
  std::vector<std::string> covered;
  if (any_set_by(IntervalSource::kOmittedTerms)) {
    covered.emplace_back("the effect of omitted terms");
  }
  if (any_set_by(IntervalSource::kPlateau)) {
    const identification::RecordFit& record = fit.WidestRecord();
    covered.push_back(fmt::format(
        "the measured half gap, {}",
        Quantity(record.facts.half_gap.value_or(0.0) / record.load_ratio, units.force, 4)));
  }
  if (covered.empty()) return "";
  std::vector<std::string> names;
  names.reserve(wide.size());
  for (const ParameterEstimate* estimate : wide) names.push_back(estimate->name);
  return fmt::format("the intervals of {} are extended to include {}", fmt::join(names, ", "),
                     fmt::join(covered, " and "));
}

std::string SlipForcesStatement(const Report& report) {
  if (!report.slip_forces) return "";
  const std::string_view unit = report.units.force;
  const auto words = [&](const SlipForce& force) {
    const double error = force.standard_error.value_or(0.0);
    std::string text = QuantityWithError(force.value, error, unit);
    if (force.lower95 && force.upper95) {
      const ScaledUnit scaled = UnitFor(unit, std::max(std::abs(force.value), error));
      text += fmt::format(" ({} … {})",
                          RoundedTo(error / scaled.factor, *force.lower95 / scaled.factor),
                          RoundedTo(error / scaled.factor, *force.upper95 / scaled.factor));
    }
    return text;
  };
  return fmt::format("slip forces: {} where the displacement grows, {} where it falls",
                     words(report.slip_forces->positive), words(report.slip_forces->negative));
}

std::vector<std::string> TrendStatements(const loop::LoopFacts& facts) {
  std::vector<std::string> statements;
  for (const std::string& trend :
       {TrendText("half gap", facts.half_gap_trend, facts.half_gap),
        TrendText("energy", facts.energy_trend, facts.energy_per_cycle)}) {
    if (!trend.empty()) statements.push_back(trend);
  }
  return statements;
}

std::string LawStatement(const Report& report) {
  if (!report.fit.law_choice) return "";
  const identification::LawChoice& choice = *report.fit.law_choice;
  const auto name = [](const models::FrictionModel& model) {
    return model.memory == models::Memory::kReturnPoint ? "Masing's law" : "Dahl's own law";
  };
  if (choice.preferred == report.fit.model) {
    return choice.delta_aicc ? fmt::format("{}, not {} (ΔAICc = {:.3g})", name(*report.fit.model),
                                           name(*choice.alternative), *choice.delta_aicc)
                             : std::string(name(*report.fit.model));
  }
  const Units& units = report.units;
  if (!report.fit.Find("sigma")->is_known()) {
    return fmt::format("{}{}", name(*choice.alternative),
                       choice.decided
                           ? fmt::format(" fits better (ΔAICc = {:.3g}, --model {})",
                                         choice.delta_aicc.value_or(0.0), choice.alternative->name)
                           : fmt::format(" or {}, which the record does not distinguish",
                                         name(*report.fit.model)));
  }
  const identification::Finding* finding = choice.decided
                                               ? report.fit.FindFinding("other_law_fits_better")
                                               : report.fit.FindFinding("law_undecided");
  const bool depends = finding == nullptr || std::ranges::find(finding->parameters, "slip_force") !=
                                                 finding->parameters.end();
  const bool knows_slip_force = depends && report.fit.Find("slip_force")->is_known();
  std::string text = fmt::format(
      "sigma{} for {}; for {}, which {}, {} {}", knows_slip_force ? " and slip_force are" : " is",
      name(*report.fit.model), name(*choice.alternative),
      choice.decided ? fmt::format("fits better (ΔAICc = {:.3g}, --model {})",
                                   choice.delta_aicc.value_or(0.0), choice.alternative->name)
                     : std::string("the record does not distinguish from it"),
      knows_slip_force ? "they are" : "it is",
      Quantity(choice.law.tangential_stiffness, units.stiffness, 5));
  if (knows_slip_force) text += " and " + Quantity(choice.law.slip_force, units.force, 5);
  const auto add = [&](const char* what, const std::optional<PropagatedValue>& quantity) {
    if (quantity) text += fmt::format(", {} {}", what, Quantity(quantity->value, "m", 5));
  };
  add("contact radius", report.contact_by_other_law.contact_radius);
  add("equivalent radius", report.contact_by_other_law.equivalent_radius);
  return text;
}

std::vector<std::string> ExponentStatements(const Report& report) {
  std::vector<std::string> statements;
  const AlphaTest& test = report.alpha;
  const char* const verdict = test.is_rejected.value_or(false) ? "rejected" : "tenable";
  if (test.z) {
    statements.push_back(
        fmt::format("α − 1/3 = {:.3g}, {:.2f} standard errors, {}{}", *test.minus_third, *test.z,
                    ChanceText(*test.p_value),
                    test.likelihood ? "" : fmt::format(": Mindlin's exponent is {}", verdict)));
  }
  const auto& mindlin = report.fit.mindlin_test;
  const std::string rig =
      mindlin && mindlin->rig_stiffness ? Quantity(*mindlin->rig_stiffness, "N/m", 4) : "";
  if (test.likelihood) {
    statements.push_back(fmt::format(
        "likelihood ratio of α = 1/3: {:.3g}, {}: Mindlin's exponent is {}{}",
        test.likelihood->likelihood_ratio, ChanceText(test.likelihood->p_value), verdict,
        rig.empty() ? ""
                    : fmt::format(" for a rigid rig, but tenable with a rig of {} "
                                  "in series: the record does not determine which",
                                  rig)));
  } else if (!rig.empty()) {
    statements.push_back(fmt::format(
        "α = 1/3 with a rig of {} in series fits as well: the record does not determine which",
        rig));
  }
  return statements;
}

std::vector<std::string> StiffnessStatements(const StiffnessTest& test) {
  std::vector<std::string> statements = {
      fmt::format("σ/(8a/G*) = {}: 1 where Hertz and Mindlin hold",
                  QuantityWithError(test.ratio.value, test.ratio.standard_error, "-"))};
  if (test.z) {
    statements.push_back(
        fmt::format("with {} a: {:g} % {:.5g} … {:.5g}, {:.2f} standard errors from 1, {}: {}",
                    test.radius == "hertz" ? "Hertz's" : "the given", 100 * test.confidence,
                    test.interval95->lower, test.interval95->upper, *test.z,
                    ChanceText(*test.p_value), TestVerdict(*test.p_value)));
  }
  return statements;
}

std::vector<std::string> LoadLawStatements(const Report& report) {
  if (!report.load_series) return {};
  const FitResult& fit = report.fit;
  std::vector<std::string> statements;
  if (!fit.Find("sigma")->is_known() || !fit.Find("load_exponent")->is_known()) {
    return {"no load law is assumed for the series: sigma or load_exponent is not identifiable"};
  }
  const std::vector<LoadLaw>& laws = report.load_series->laws;
  if (DeniesHertz(fit)) {
    statements.emplace_back(
        "Hertz's law is rejected: no radius, compliance or modulus of a sphere follows");
  }
  const bool is_tested = std::ranges::any_of(
      report.load_series->hypotheses,
      [](const LoadHypothesis& hypothesis) { return hypothesis.p_value.has_value(); });
  if (laws.empty()) {
    const ParameterEstimate& exponent = *fit.Find("load_exponent");
    statements.push_back(
        exponent.status == ParameterStatus::kFixed
            ? fmt::format("load_exponent is fixed at {:.4g}, which no theory predicts",
                          exponent.value)
        : is_tested ? std::string("none of these theories is tenable")
                    : std::string("load_exponent has no standard error to test a theory with: no "
                                  "load law is assumed"));
  }
  for (const LoadLaw& law : LawsToShow(*report.load_series)) {
    if (!law.unidentified.empty()) {
      statements.push_back(law.unidentified);
    }
  }
  return statements;
}

std::vector<LoadLaw> LawsToShow(const LoadSeries& series) {
  std::vector<LoadLaw> laws = series.laws;
  if (std::ranges::find(laws, "sphere", &LoadLaw::name) != laws.end()) {
    std::erase_if(laws, [](const LoadLaw& law) { return law.name == "elements"; });
  }
  return laws;
}

std::string LawHeading(const LoadLaw& law) {
  return fmt::format("{} assumed at all loads: σ = {} at the mean load",
                     law.name == "elements" ? fmt::format("p = α = {:.4g}", law.exponent)
                                            : WordsOfHypothesis(law.name),
                     QuantityWithError(law.stiffness.value, law.stiffness.standard_error, "N/m"));
}

std::string IntervalWords(const QuantityUnderLaw& quantity) {
  if (!quantity.interval95) return quantity.value.standard_error > 0 ? "open" : "held";
  const ScaledUnit unit = UnitFor(quantity.unit, std::abs(quantity.value.value));
  const identification::Interval& ends = *quantity.interval95;
  const std::string interval =
      IntervalText(ends.lower, std::isfinite(ends.upper) ? std::optional(ends.upper) : std::nullopt,
                   unit.factor);
  return unit.name.empty() ? interval : interval + " " + unit.name;
}

std::string WordsOfHypothesis(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 5> kWords = {{
      {"sphere", "smooth sphere, Hertz (1/3)"},
      {"elements", "elements in parallel (α)"},
      {"cone", "cone (1/2)"},
      {"flat_punch", "flat punch (0)"},
      {"rough", "rough contact (1)"},
  }};
  const auto row =
      std::ranges::find(kWords, name, &std::pair<std::string_view, std::string_view>::first);
  return std::string(row == kWords.end() ? name : row->second);
}

void RequireFitted(const Report& report, std::string_view what) {
  if (!report.failed()) return;
  throw InvalidArgument(
      fmt::format("{} cannot be made: the fit failed: {}", what, report.fit.solver.message));
}

}  // namespace mindahl::report
