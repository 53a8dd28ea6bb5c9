#include "report/contact_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

#include "mindahl/report/contact.h"
#include "mindahl/report/quantity.h"
#include "report/fields.h"
#include "report/names.h"
#include "report/statements.h"
#include "report/wrapped.h"

namespace mindahl::report {

using contact::PropagatedValue;
using contact::UncertainValue;
using identification::FitResult;

namespace {

std::string ValueAndError(const UncertainValue& value, std::string_view unit) {
  return QuantityWithError(value.value, value.standard_error, unit);
}

std::string SharesText(const PropagatedValue& value) {
  const std::string statement = VarianceStatement(value);
  return statement.empty() ? "" : fmt::format("{:<23}{}\n", "", statement);
}

/// Names the inputs that more knowledge of the contact needs.
std::string MissingText(const Report& report) {
  const std::vector<std::string> inputs =
      contact::MissingInputs(report.known, contact::ContactQuantity::kEquivalentRadius);
  std::string text;
  if (const auto why = WhyFrictionIsWithheld(report.fit, report.known)) {
    text += Wrapped("not identified: friction coefficient " + *why, 16);
  }
  if (!report.fit.Find("sigma")->is_known()) {
    return text + Wrapped("not identified: all that follows from sigma", 16);
  }
  if (inputs.empty()) {
    if (report.contact.hertz) return text;
    return text + Wrapped("to be compared with Hertz it takes the radii of both bodies", 2);
  }
  std::vector<std::string> more;
  for (const ContactField& field : ContactFields()) {
    const bool is_friction = field.key == "friction_coefficient";
    if (is_friction && report.known.normal_load) continue;  // withheld, as said
    // Radius and compliance follow from each other.
    if (field.key == "compliance" && !report.known.contact_radius) continue;
    const bool is_of_sphere = field.key == "equivalent_radius" || field.key == "maximum_pressure";
    if (is_of_sphere && DeniesHertz(report.fit)) continue;
    if (!field.get(report)) more.emplace_back(field.label);
  }
  if (!report.contact.hertz) more.emplace_back("Hertz's prediction");
  return text + Wrapped(fmt::format("with {} given, more would be known: {}",
                                    fmt::join(inputs, ", "), fmt::join(more, ", ")),
                        2);
}

/// Lists the quantities of the contact under the laws that a load series does not reject.
std::string LoadLawText(const Report& report) {
  std::string text;
  for (const LoadLaw& law : LawsToShow(*report.load_series)) {
    text += Wrapped("  " + LawHeading(law), 4);
    for (const QuantityUnderLaw& quantity : law.quantities) {
      if (quantity.key == "contact_radius") continue;  // at every load above
      text += fmt::format("    {:<21} {:<25} {} {:<26} {}\n", quantity.label,
                          ValueAndError(quantity.value, quantity.unit), ConfidenceWords(report.fit),
                          IntervalWords(quantity), quantity.formula);
      if (quantity.predicted) {
        text += fmt::format("    {:<21} {}\n", "  of the two radii",
                            Quantity(*quantity.predicted, quantity.unit));
      }
      const std::string shares = VarianceStatement(quantity.value);
      if (!shares.empty()) text += fmt::format("    {:<21} {}\n", "", shares);
    }
  }
  for (const std::string& statement : LoadLawStatements(report)) {
    text += Wrapped("  " + statement, 4);
  }
  return text;
}

/// Returns no number of what is not known.
std::string IfKnown(const UncertainValue& value, std::string_view unit, const FitResult& fit,
                    std::string_view parameter) {
  return fit.Find(parameter)->is_known() ? ValueAndError(value, unit) : "-";
}

}  // namespace

std::string ContactText(const Report& report) {
  std::string text;
  bool has_compliance = false;
  for (const ContactField& field : ContactFields()) {
    const std::optional<PropagatedValue> value = field.get(report);
    if (!value || !IsIdentified(report, field, *value)) continue;
    text += fmt::format("{:<22} {:<27} {}\n", field.label, ValueAndError(*value, field.unit),
                        field.formula);
    text += SharesText(*value);
    has_compliance = has_compliance || field.formula.find("G*") != std::string_view::npos;
  }
  if (has_compliance) {
    text +=
        "G* = (2−ν₁)/G₁ + (2−ν₂)/G₂ [1/Pa], a compliance: many texts write G* for its inverse\n";
  }
  for (const std::string& sentence : report.contact.redundant) text += Wrapped(sentence, 2);
  return text + MissingText(report);
}

std::string HertzText(const Report& report) {
  if (!report.contact.hertz || !report.fit.Find("sigma")->is_known()) return "";
  const contact::HertzPrediction& hertz = *report.contact.hertz;
  std::string text = "Hertz and Mindlin predict from materials, radii and load:\n";
  const auto line = [&](const char* name, const PropagatedValue& value, const char* unit,
                        const PropagatedValue& ratio) {
    if (!std::isfinite(ratio.standard_error)) return;
    text += fmt::format("  {:<21} {:<22} measured/predicted {}\n", name, ValueAndError(value, unit),
                        ValueAndError(ratio, "-"));
  };
  line("contact radius", hertz.contact_radius, "m", hertz.sigma_over_hertz_mindlin);
  line("tangential stiffness", hertz.tangential_stiffness, "N/m", hertz.sigma_over_hertz_mindlin);
  line("gross slip (α = 1/3)", hertz.gross_slip_displacement, "m",
       hertz.gross_slip_displacement_ratio);
  return text;
}

std::string LoadSeriesText(const Report& report) {
  if (!report.load_series) return "";
  const LoadSeries& series = *report.load_series;
  const FitResult& fit = report.fit;
  std::string text = fmt::format(
      "under several loads (σ ∝ N^p, Tc = μN; the parameters above are at the mean, {}):\n",
      Quantity(*fit.normal_load, "N", 6));
  const bool has_radius = series.contacts.front().contact_radius.has_value();
  const bool has_hertz = series.contacts.front().hertz_radius.has_value();
  text += fmt::format("  {:<10} {:<23} {:<20}{}{}\n", "N", "σ", "Tc",
                      has_radius ? fmt::format(" {:<19}", "a = σG*/8") : "",
                      has_hertz ? " a of Hertz" : "");
  for (const ContactUnderLoad& contact : series.contacts) {
    text += fmt::format("  {:<10} {:<23} {:<20}", Quantity(contact.normal_load, "N", 5),
                        IfKnown(contact.stiffness, "N/m", fit, "sigma"),
                        IfKnown(contact.slip_force, "N", fit, "slip_force"));
    if (has_radius)
      text += fmt::format(" {:<19}", IfKnown(*contact.contact_radius, "m", fit, "sigma"));
    if (has_hertz) text += " " + Quantity(*contact.hertz_radius, "m", 5);
    text += "\n";
  }
  for (const LoadHypothesis& hypothesis : series.hypotheses) {
    if (!hypothesis.p_value) continue;
    const double p_value = *hypothesis.p_value;
    text += fmt::format("  {:<28} p − {:<6.4g} = {:>8.3g}, {:>6.2f} standard errors, {}{}\n",
                        WordsOfHypothesis(hypothesis.name), hypothesis.exponent,
                        *hypothesis.difference, *hypothesis.z, ChanceText(p_value),
                        p_value < kSignificance ? ": rejected" : "");
  }
  return text + LoadLawText(report);
}

std::string MappingText(const Report& report) {
  std::string text;
  for (const std::string& statement : ExponentStatements(report)) {
    text += Wrapped("  " + statement, 6);
  }
  for (const StiffnessTest& test : report.stiffness) {
    const std::vector<std::string> statements = StiffnessStatements(test);
    for (std::size_t k = 0; k < statements.size(); ++k) {
      text += Wrapped((k == 0 ? "  " : "      ") + statements[k], 6);
    }
    text += SharesText(test.ratio);
  }
  return text.empty() ? "  not tested: alpha is held, and no radius is known besides the fit\n"
                      : text;
}

}  // namespace mindahl::report
