#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mindahl/report/report.h"

// Makes the words that text and page share, without an end of line.
namespace mindahl::report {

using identification::AdequacyVerdict;
using identification::Finding;
using identification::FitResult;
using identification::Identifiability;
using identification::ParameterEstimate;
using identification::ParameterStatus;
using identification::RecordFit;

// Each returns the name of an enumerator in reports.
constexpr std::string_view Name(ParameterStatus status) {
  return std::array{"free", "fixed", "at_lower_bound", "at_upper_bound"}.at(
      static_cast<std::size_t>(status));
}
constexpr std::string_view Name(Identifiability verdict) {
  return std::array{"identifiable", "effective", "bounded_below", "not_identifiable"}.at(
      static_cast<std::size_t>(verdict));
}
constexpr std::string_view Name(models::InitialState state) {
  return std::array{"virgin", "steady"}.at(static_cast<std::size_t>(state));
}
constexpr std::string_view Name(AdequacyVerdict verdict) {
  return std::array{"adequate", "doubtful", "inadequate"}.at(static_cast<std::size_t>(verdict));
}
constexpr std::string_view Name(identification::Use use) {
  return std::array{"quantitative", "indicative", "none"}.at(static_cast<std::size_t>(use));
}

/// Names several files by the name of the first, without its directory: "loop.csv and 2 more".
/// @param files  at least one
std::string NameOf(std::span<const std::string> files);

/// True if the adequacy was judged: the fit did not fail, and omitted terms were tried.
bool IsJudged(const Report& report);

/// Returns "adequate", "doubtful", "inadequate", "not judged", "not converged" or "failed".
std::string_view VerdictWord(const Report& report);

// How good what is said is: a class of the page's style, which has its colour.
inline constexpr std::string_view kPlain = "plain";
inline constexpr std::string_view kGood = "good";
inline constexpr std::string_view kPoor = "poor";
inline constexpr std::string_view kBad = "bad";
/// @param verdict  as VerdictWord()
std::string_view JudgementOf(std::string_view verdict);
/// Returns kGood only of what may be quoted as it stands.
std::string_view JudgementOf(const ParameterEstimate& estimate);

/// Holds what is shown of a parameter: no number that the record does not determine, nor where the
/// search stopped at a limit. It is the estimate with its interval, one end of it alone, the value
/// or the bound that was given, or nothing.
struct Shown {
  std::optional<double> value, lower, upper;
  std::string_view how_given = {};  ///< "held" or "at the bound that was given"; "" of an estimate

  /// True for an estimate with its interval.
  [[nodiscard]] bool is_estimate() const { return value && how_given.empty(); }
};
Shown WhatIsShown(const ParameterEstimate& estimate);

/// Returns "48.14 N/µm (48.07 … 48.22)", "0.333 (held)", "> 12 N" or "not determined".
std::string ValueText(const ParameterEstimate& estimate);

/// Returns "5.6 % of the half gap" of Adequacy::misfit_over_half_gap, or "more than the half gap".
std::string MisfitShare(double over_half_gap);

/// Says what the next step would do: "a lag, misfit 5.6 % → 2.1 % of the half gap (tried)".
std::string NextStatement(const NextStep& next);

/// Describes a finding in at most some twenty words, without an end of line, naming no parameter:
/// what was found and, where something can be done, what to do; the code alone where it is unknown.
std::string Sentence(const Finding& finding, const FitResult& fit, const Units& units = {});

/// Returns the same behind the names of its parameters.
std::string WarningText(const Finding& finding, const Report& report);

/// A line of the answer, which the text prints and the page shows.
struct Line {
  std::string label;  ///< "friction"
  std::string text;
  std::string_view judgement = kPlain;  ///< kGood of what may be quoted
};

/// Returns the lines in their order: what to check, columns, assumptions of the reader, friction,
/// stiffness, shape, load, terms, law, misfit, measured, left out, next, and what else a person
/// should act on. A number stands in one line only, with its interval and no other uncertainty; a
/// parameter that is not determined has a reason in place of a number; of an inadequate model only
/// what is still known has a line.
/// @param report  of a fit that did not fail
std::vector<Line> AnswerLines(const Report& report);

/// Returns what the answer leaves out.
std::vector<Line> DetailLines(const Report& report);

/// Says how far the model is from the record and what that means, as the line "misfit" does.
std::string MisfitStatement(const Report& report);

/// @throws InvalidArgument for a fit that failed: it has no curve to draw and no residual to list
void RequireFitted(const Report& report, std::string_view what);

}  // namespace mindahl::report
