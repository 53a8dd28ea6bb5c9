#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mindahl/report/report.h"

// Makes the statements that text and page share, in words and without an end of line.
namespace mindahl::report {

struct ContactField;

/// Names several files by the name of the first, without its directory: "loop.csv and 2 more".
std::string NameOf(std::span<const std::string> files);

/// Returns the files and the verdict: "loop.csv: adequate".
std::string TitleOf(const Report& report);

/// Returns "adequate", "doubtful", "inadequate", "not judged", "not converged" or "failed".
std::string_view VerdictWord(const Report& report);

/// How good what is said is, for its colour.
enum class Judgement { kGood, kPoor, kBad };
/// @param verdict  as VerdictWord()
Judgement JudgementOf(std::string_view verdict);
Judgement JudgementOf(const identification::ParameterEstimate& estimate);

/// Says how much of a parameter is shown: no number that the record does not determine.
enum class Shown {
  kValue,       ///< the estimate, with its error and interval
  kHeld,        ///< the value that it was given
  kLowerLimit,  ///< the lower end of the interval alone
  kNothing,
};
Shown WhatIsShown(const identification::ParameterEstimate& estimate);

/// Returns the name with blanks, for people.
std::string Words(identification::Identifiability identifiability);

/// Returns the name of a parameter or of a key of the JSON for people: "slip force Tc", "half gap".
std::string PlainName(std::string_view key);

/// Returns the confidence of a fit's intervals for people: "95 %".
std::string ConfidenceWords(const identification::FitResult& fit);

/// Returns "identifiable, at bound", "fixed" …
std::string VerdictWords(const identification::ParameterEstimate& estimate);

/// Returns "p = 0.012" of two digits; no p-value is 0.
std::string ChanceText(double p_value, int digits = 3);

/// True if a quantity of the contact follows from what the loop determines: of what it leaves open
/// nothing follows, whatever the error is.
bool IsIdentified(const Report& report, const ContactField& field,
                  const contact::PropagatedValue& value);

/// Names what to measure better, by fractions of a variance. Empty where the inputs are exact and
/// the fit alone is uncertain.
std::string VarianceStatement(const contact::PropagatedValue& value);

/// Says whether the contact slips as a whole, and from where on.
std::string SlipStatement(const LoopDescription& loop, const Units& units);

/// Returns which priors the fit has, and by how many standard errors they moved each parameter;
/// empty without any.
std::string PriorStatement(const identification::FitResult& fit);

/// Says why intervals are far wider than standard errors make them; "" where none is.
std::string WideIntervalStatement(const identification::FitResult& fit, const Units& units);

/// Returns the slip forces in either direction of the motion; "" where they are one, or not known.
std::string SlipForcesStatement(const Report& report);

/// Describes the significant trends over the cycles.
std::vector<std::string> TrendStatements(const loop::LoopFacts& facts);

/// States which of the two laws σ and Tc are of, and what the other would make of the contact.
/// Empty where they are not compared.
std::string LawStatement(const Report& report);

/// Tests whether the exponent is Mindlin's, α = 1/3. Empty where α was held.
std::vector<std::string> ExponentStatements(const Report& report);

/// Tests whether the stiffness is 8a/G*: the ratio, then its test where there is one.
std::vector<std::string> StiffnessStatements(const StiffnessTest& test);

/// Names the quantities of the contact that no law of a load series gives, and why. Empty where the
/// report has no series.
std::vector<std::string> LoadLawStatements(const Report& report);

/// Returns the laws of a series that say something of the contact: elements in parallel only where
/// Hertz's law, of which they are the general case, is not among them.
std::vector<LoadLaw> LawsToShow(const LoadSeries& series);

/// Returns a law of the load and the stiffness with it: "smooth sphere, Hertz (1/3), held over all
/// loads: σ = 52.11 ± 0.06 N/µm at the mean load".
std::string LawHeading(const LoadLaw& law);

/// Returns the 95 % interval of a quantity in its own unit, "49.8 … 50.4 mm"; "open".
std::string IntervalWords(const QuantityUnderLaw& quantity);

std::string WordsOfHypothesis(std::string_view name);

/// @throws InvalidArgument for a fit that failed: it has no curve to draw and no residual to list
void RequireFitted(const Report& report, std::string_view what);

}  // namespace mindahl::report
