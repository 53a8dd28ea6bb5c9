#include "verdict.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "mindahl/core/error.h"
#include "mindahl/identification/term_selection.h"
#include "report/statements.h"

namespace mindahl::reliability {

using identification::Finding;
using identification::FitResult;
using identification::Identifiability;
using identification::ParameterEstimate;
using identification::ParameterStatus;
using identification::Severity;

namespace {

/// Findings that only say what a record leaves open, which a clean one may.
constexpr std::array<std::string_view, 3> kLeftOpen = {"bounded_below", "not_identifiable",
                                                       "unknown_past"};

double Distance(double value, const Range& truth) {
  return std::max({truth.lowest - value, value - truth.highest, 0.0});
}

/// An estimate beside the truth. An interval that is open, at a bound, ends at the estimate.
struct Comparison {
  Comparison(const ParameterEstimate& estimate, const Range& truth) {
    const double lower = estimate.lower95.value_or(estimate.value);
    const double upper = estimate.upper95.value_or(estimate.value);
    const double scale = estimate.name == "alpha" ? 1.0 : truth.highest;
    share_off = Distance(estimate.value, truth) / scale;
    half_widths_off = Distance(lower + (upper - lower) / 2, truth) / ((upper - lower) / 2);
    is_far_off = share_off > kShare && half_widths_off > kHalfWidths;
    covers = (!estimate.lower95 || *estimate.lower95 <= truth.highest) &&
             (!estimate.upper95 || truth.lowest <= *estimate.upper95);
  }

  double share_off = 0.0;
  double half_widths_off = 0.0;
  bool is_far_off = false;
  bool covers = true;
};

/// One that is bounded below has nothing but its limit to be believed.
bool IsFalseLimit(const ParameterEstimate& estimate, const Range& truth) {
  return estimate.identifiability == Identifiability::kBoundedBelow && estimate.lower95 &&
         *estimate.lower95 > (1 + kShare) * truth.highest;
}

std::string TruthText(const std::optional<Range>& truth) {
  if (!truth) return "not asked";
  if (truth->lowest == truth->highest) return fmt::format("{:.5g}", truth->lowest);
  return fmt::format("{:.5g} to {:.5g}", truth->lowest, truth->highest);
}

std::string EndText(const std::optional<double>& end) {
  return end ? fmt::format("{:.5g}", *end) : "open";
}

std::string ParameterText(const ParameterEstimate& estimate, const std::optional<Range>& truth,
                          bool is_wrong) {
  std::string text =
      fmt::format("  {}{:<10} truth {:<20} fitted {:<12.5g} 95 % {} … {}, {}", is_wrong ? '!' : ' ',
                  estimate.name, TruthText(truth), estimate.value, EndText(estimate.lower95),
                  EndText(estimate.upper95), report::Name(estimate.identifiability));
  if (estimate.status != ParameterStatus::kFree) text += ", at bound";
  if (truth && IsFalseLimit(estimate, *truth)) text += ", FALSE LIMIT";
  if (truth) {
    const Comparison comparison(estimate, *truth);
    text += fmt::format("; off by {:.2g} %, {:.2g} half widths", 100 * comparison.share_off,
                        comparison.half_widths_off);
  }
  return text + '\n';
}

std::string FindingsText(const FitResult& fit) {
  std::string text = "   findings:";
  for (const Finding& finding : fit.findings) {
    text += fmt::format(" {}{}{}", finding.code, finding.kind.empty() ? "" : "/", finding.kind);
    if (!finding.parameters.empty())
      text += fmt::format(" [{}]", fmt::join(finding.parameters, ", "));
    if (finding.severity <= Severity::kAdvice) text += " (note)";
  }
  if (fit.findings.empty()) text += " none";
  text += fmt::format("\n   adequacy: {}, misfit {:.2g} of the noise, p = {:.2g};",
                      static_cast<int>(fit.adequacy.verdict), fit.adequacy.misfit_over_noise,
                      fit.adequacy.p_value);
  for (const identification::Cause& cause : fit.adequacy.causes) {
    text += fmt::format(" {} ({:.0f}, explains {:.0f} %)", cause.code, cause.delta_aicc,
                        100 * cause.explains);
  }
  return text + "\n";
}

std::string ResidualsText(const FitResult& fit) {
  if (fit.records.empty()) return "";
  const identification::RecordFit& record = fit.records.front();
  return fmt::format(
      "   {} samples, {} reversals (gate {:.2g} X), {}, {}; T* {:.3g} % of Tc, rms {:.3g}, "
      "largest {:.3g}, "
      "Durbin-Watson {:.2f}, {:.0f} effective; {:.0f} % repeatable\n",
      fit.residuals.samples, record.reversals.size(), record.gate.gate / record.facts.amplitude,
      fit.initial_state == models::InitialState::kVirgin ? "virgin" : "steady",
      fit.converged ? "converged" : "NOT CONVERGED: " + fit.solver.message,
      100 * record.facts.peak_force / fit.law.slip_force,
      100 * fit.residuals.rms / fit.law.slip_force,
      100 * fit.residuals.max_abs / fit.law.slip_force, fit.residuals.durbin_watson,
      fit.residuals.effective_samples, 100 * record.structure.repeatable_share);
}

}  // namespace

std::string_view Name(Outcome outcome) {
  switch (outcome) {
    case Outcome::kRight:
      return "right";
    case Outcome::kUndecided:
      return "undecided";
    case Outcome::kWarned:
      return "warned";
    case Outcome::kSilent:
      return "silent";
    case Outcome::kFailed:
      return "failed";
  }
  return "";
}

Caution CautionOf(const FitResult& fit) {
  Caution caution;
  caution.no_answer = fit.parameters.empty() || !fit.converged;
  for (const Finding& finding : fit.findings) {
    if (finding.severity <= Severity::kAdvice) continue;
    caution.warns = true;
    // An asymmetry is not asked of a clean one.
    const bool is_left_open = std::ranges::find(kLeftOpen, finding.code) != kLeftOpen.end();
    if (!is_left_open || finding.kind == "below_slip") caution.alarms = true;
  }
  if (fit.adequacy.verdict == identification::AdequacyVerdict::kDoubtful) {
    caution.warns = caution.alarms = true;
  }
  if (fit.adequacy.verdict == identification::AdequacyVerdict::kInadequate) {
    caution.no_answer = true;
  }
  caution.warns = caution.warns || caution.no_answer;
  caution.alarms = caution.alarms || caution.no_answer;
  return caution;
}

Judgement Judge(const FitResult& fit, const Expected& expected) {
  const Caution caution = CautionOf(fit);
  Judgement judgement;
  judgement.outcome = caution.no_answer ? Outcome::kUndecided : Outcome::kRight;
  judgement.alarms = caution.alarms;
  const auto compare = [&](std::string_view name, const std::optional<Range>& truth) {
    const ParameterEstimate* estimate = fit.Find(name);
    if (estimate == nullptr) return;
    bool is_wrong = false;
    const bool is_effective = estimate->identifiability == Identifiability::kEffective;
    if (truth && !estimate->is_known()) {
      judgement.outcome = std::max(judgement.outcome, Outcome::kUndecided);
      if (IsFalseLimit(*estimate, *truth)) judgement.false_limit = true;
    } else if (truth && (is_effective || !caution.no_answer)) {
      const Comparison comparison(*estimate, *truth);
      is_wrong = comparison.is_far_off;
      ++judgement.intervals;
      if (!comparison.covers) ++judgement.misses;
    }
    if (is_wrong) {
      judgement.outcome =
          std::max(judgement.outcome, caution.warns ? Outcome::kWarned : Outcome::kSilent);
    }
    judgement.account += ParameterText(*estimate, truth, is_wrong);
  };
  compare("sigma", expected.sigma);
  compare("alpha", expected.alpha);
  compare("slip_force", expected.slip_force);
  judgement.account += ResidualsText(fit) + FindingsText(fit);
  return judgement;
}

Judgement Try(const Kind& kind, std::size_t level, std::uint64_t seed, bool adds_terms) {
  const Loop loop = MakeLoop(kind, level, seed);
  try {
    const mindahl::loop::RecordView record(loop.record);
    FitResult fit = identification::Fit({&loop.record, 1});
    if (adds_terms) fit = identification::SelectTerms({&record, 1}, {}, std::move(fit)).fit;
    return Judge(fit, loop.expected);
  } catch (const InvalidArgument& refusal) {
    return {.outcome = Outcome::kUndecided,
            .alarms = true,
            .account = fmt::format("   refused: {}\n", refusal.what())};
  }
}

}  // namespace mindahl::reliability
