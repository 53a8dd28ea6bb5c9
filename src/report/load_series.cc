#include "mindahl/report/load_series.h"

#include <cmath>
#include <limits>

#include "core/probability.h"
#include "mindahl/report/contact.h"
#include "mindahl/report/mapping_tests.h"
#include "report/load_laws.h"

namespace mindahl::report {

using contact::UncertainValue;
using identification::FitResult;
using identification::ParameterEstimate;
using identification::ParameterStatus;

namespace {

/// Error of a + factor·b, from their errors and correlation; infinite where one of them is open.
double ErrorOfSum(double a, double factor, double b, double correlation) {
  const double scaled = factor * b;
  if (scaled == 0) return a;
  if (std::isinf(a) || std::isinf(scaled)) return std::numeric_limits<double>::infinity();
  return std::sqrt(std::max(a * a + scaled * scaled + 2 * correlation * a * scaled, 0.0));
}

/// @param error_of_other  of the hypothesis' exponent, where it is fitted too
LoadHypothesis Test(std::string_view name, double exponent, const FitResult& fit,
                    double error_of_other = 0.0) {
  LoadHypothesis test{.name = name, .exponent = exponent};
  const ParameterEstimate& fitted = *fit.Find("load_exponent");
  if (fitted.status == ParameterStatus::kFixed) return test;
  test.difference = fitted.value - exponent;
  const bool is_known = fitted.is_known();
  const double error =
      ErrorOfSum(fit.ErrorTowards(fitted, exponent), -1.0, error_of_other,
                 error_of_other > 0 ? Correlation(fit, "load_exponent", "alpha") : 0.0);
  if (!is_known || !(error > 0) || !std::isfinite(error)) return test;
  test.z = *test.difference / error;
  test.p_value = PValueOfT(*test.z, fit.ErrorDegreesOfFreedom());
  return test;
}

ContactUnderLoad ContactUnder(const FitResult& fit, const identification::RecordFit& record,
                              const contact::KnownContact& known) {
  const ParameterEstimate& sigma = *fit.Find("sigma");
  const ParameterEstimate& slip_force = *fit.Find("slip_force");
  const models::BranchLaw law = fit.LawOf(record);
  const double relative = ErrorOfSum(fit.ErrorOf(sigma) / sigma.value, std::log(record.load_ratio),
                                     fit.ErrorOf(*fit.Find("load_exponent")),
                                     Correlation(fit, "sigma", "load_exponent"));
  ContactUnderLoad contact{
      .normal_load = *record.normal_load,
      .stiffness = {law.tangential_stiffness, law.tangential_stiffness * relative},
      .slip_force = {law.slip_force, record.load_ratio * fit.ErrorOf(slip_force)},
      .alone = record.alone};
  contact::KnownContact under_load = known;
  under_load.normal_load = UncertainValue{contact.normal_load};
  const contact::IdentifiedContact identified =
      contact::IdentifyContact(contact.stiffness, contact.slip_force, under_load);
  if (identified.contact_radius) contact.contact_radius = *identified.contact_radius;
  if (identified.hertz) contact.hertz_radius = identified.hertz->contact_radius.value;
  return contact;
}

}  // namespace

bool DeniesHertz(const FitResult& fit) {
  if (!fit.is_load_series()) return false;
  const ParameterEstimate& exponent = *fit.Find("load_exponent");
  if (exponent.status == ParameterStatus::kFixed) {
    return !IsHeldAt(exponent.value, contact::kMindlinShapeExponent);
  }
  const LoadHypothesis sphere = Test("sphere", contact::kMindlinShapeExponent, fit);
  return sphere.p_value && *sphere.p_value < kSignificance;
}

std::optional<LoadSeries> DescribeLoadSeries(const FitResult& fit,
                                             const contact::KnownContact& known) {
  if (!fit.is_load_series()) return std::nullopt;
  LoadSeries series;
  for (const identification::RecordFit& record : fit.records) {
    series.contacts.push_back(ContactUnder(fit, record, known));
  }
  const ParameterEstimate& alpha = *fit.Find("alpha");
  series.hypotheses = {
      Test("sphere", contact::kMindlinShapeExponent, fit),
      Test("elements", alpha.value, fit, fit.ErrorTowards(alpha, fit.load_exponent)),
      Test("cone", 0.5, fit), Test("flat_punch", 0.0, fit), Test("rough", 1.0, fit)};
  series.laws = TenableLaws(fit, series.hypotheses, known);
  return series;
}

}  // namespace mindahl::report
