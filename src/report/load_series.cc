#include "mindahl/report/load_series.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "core/probability.h"
#include "mindahl/contact/hertz.h"
#include "mindahl/contact/shape_under_load.h"
#include "mindahl/report/contact.h"

namespace mindahl::report {

using contact::ContactShape;
using contact::KnownContact;
using contact::PropagatedValue;
using contact::ShapeUnderLoad;
using contact::UncertainValue;
using identification::FitResult;
using identification::Interval;
using identification::ParameterEstimate;
using identification::ParameterStatus;

namespace {

/// A parameter as the projection takes it, ln σ in place of σ.
struct Component {
  double value = 0.0;
  double error = 0.0;
  /// Ratio of its interval to Student's of its error, on the wider side.
  double widened = 0.0;
};

/// ln σ, p, α and their correlations.
struct Estimate {
  static constexpr std::size_t kCount = 3;
  std::array<Component, kCount> components;
  /// 0 where an error is open, at a bound: what rests on it is not tested, and so no law.
  std::array<std::array<double, kCount>, kCount> covariance{};
  double quantile = 0.0;         ///< Student's t, two-sided
  double normal_quantile = 0.0;  ///< likewise
};

/// Returns how far an interval reaches beyond quantile·error on either side.
double Widened(double value, double error, double quantile, std::optional<double> lower,
               std::optional<double> upper) {
  double widened = 0.0;
  if (lower) widened = std::max(widened, value - *lower - quantile * error);
  if (upper) widened = std::max(widened, *upper - value - quantile * error);
  return widened;
}

/// Returns the error by the parabola: 0 for a parameter that was held, infinite without one.
double StandardErrorOf(const ParameterEstimate& estimate) {
  const bool is_held = estimate.status == ParameterStatus::kFixed;
  return estimate.standard_error.value_or(is_held ? 0.0 : std::numeric_limits<double>::infinity());
}

Estimate EstimateOf(const FitResult& fit) {
  Estimate estimate;
  estimate.quantile = StudentQuantile(fit.ErrorDegreesOfFreedom(), fit.confidence);
  estimate.normal_quantile = NormalQuantile(fit.confidence);
  constexpr std::array<std::string_view, Estimate::kCount> kNames = {"sigma", "load_exponent",
                                                                     "alpha"};
  for (std::size_t i = 0; i < Estimate::kCount; ++i) {
    const ParameterEstimate& parameter = *fit.Find(kNames[i]);
    Component& component = estimate.components[i];
    const bool is_stiffness = i == 0;
    const auto in_log = [&](std::optional<double> end) {
      return end && is_stiffness ? std::optional(std::log(*end)) : end;
    };
    component.value = is_stiffness ? std::log(parameter.value) : parameter.value;
    component.error =
        is_stiffness ? StandardErrorOf(parameter) / parameter.value : StandardErrorOf(parameter);
    if (parameter.status != ParameterStatus::kFixed) {
      component.widened = Widened(component.value, component.error, estimate.quantile,
                                  in_log(parameter.lower95), in_log(parameter.upper95));
    }
  }
  for (std::size_t i = 0; i < Estimate::kCount; ++i) {
    for (std::size_t j = 0; j < Estimate::kCount; ++j) {
      const double errors = estimate.components[i].error * estimate.components[j].error;
      const double correlation = i == j ? 1.0 : Correlation(fit, kNames[i], kNames[j]);
      estimate.covariance[i][j] = std::isfinite(errors) ? correlation * errors : 0.0;
    }
  }
  return estimate;
}

/// A theory, cᵀθ = d; without one nothing is held.
struct Constraint {
  std::array<double, Estimate::kCount> factor{};
  double value = 0.0;
};

/// A component with a theory held, half its 95 % interval, and the error that this stands for.
struct Held {
  double value = 0.0;
  double error = 0.0;
  double half_width = 0.0;
};

Held Hold(const Estimate& estimate, const Constraint& constraint, std::size_t which) {
  const Component& component = estimate.components.at(which);
  double departure = -constraint.value;
  double variance = 0.0;
  double covariance = 0.0;
  for (std::size_t i = 0; i < Estimate::kCount; ++i) {
    departure += constraint.factor[i] * estimate.components[i].value;
    covariance += constraint.factor[i] * estimate.covariance.at(which)[i];
    for (std::size_t j = 0; j < Estimate::kCount; ++j) {
      variance += constraint.factor[i] * constraint.factor[j] * estimate.covariance[i][j];
    }
  }
  const double gain = variance > 0 ? covariance / variance : 0.0;
  Held held;
  held.value = component.value - gain * departure;
  const double of_parabola =
      std::sqrt(std::max(component.error * component.error - gain * covariance, 0.0));
  held.half_width = estimate.quantile * of_parabola + component.widened;
  for (std::size_t i = 0; i < Estimate::kCount; ++i) {
    held.half_width += std::abs(gain * constraint.factor[i]) * estimate.components[i].widened;
  }
  held.error = held.half_width / estimate.quantile;
  return held;
}

/// Returns the interval of a power of σ and of inputs: in proportion, to either side.
std::optional<Interval> IntervalOf(const PropagatedValue& value, const Held& log_stiffness,
                                   double normal_quantile) {
  if (!std::isfinite(value.standard_error)) return std::nullopt;
  const double power =
      log_stiffness.error > 0 ? value.fit_error / value.value / log_stiffness.error : 0.0;
  const double of_inputs = normal_quantile * value.input_error / value.value;
  const double half_width = std::hypot(power * log_stiffness.half_width, of_inputs);
  if (!(half_width > 0)) return std::nullopt;  // all that it follows from is held
  return Interval{value.value * std::exp(-half_width), value.value * std::exp(half_width)};
}

/// E follows from σ in no proportion: the nearer to a rigid body, the more. What else is known of
/// the contact moves σ's ends as it would have to move σ.
std::optional<Interval> IntervalOfModulus(const PropagatedValue& value, const Held& log_stiffness,
                                          double stiffness, const KnownContact& known,
                                          double normal_quantile) {
  if (!(log_stiffness.error > 0) || !(value.fit_error > 0)) return std::nullopt;
  const double of_inputs =
      normal_quantile * value.input_error * log_stiffness.error / value.fit_error;
  const double half_width = std::hypot(log_stiffness.half_width, of_inputs);
  const auto modulus_at = [&](double log_change) {
    const ShapeUnderLoad shape = contact::IdentifyShape(
        ContactShape::kSphere, UncertainValue{stiffness * std::exp(log_change), 0.0}, known);
    return shape.youngs_modulus ? std::optional(shape.youngs_modulus->value) : std::nullopt;
  };
  const std::optional<double> lower = modulus_at(-half_width);
  if (!lower) return std::nullopt;
  return Interval{*lower, modulus_at(half_width).value_or(std::numeric_limits<double>::infinity())};
}

KnownContact AtMeanLoad(const FitResult& fit, const KnownContact& known) {
  KnownContact at_mean = known;
  const double error = known.normal_load ? known.normal_load->standard_error : 0.0;
  at_mean.normal_load = UncertainValue{*fit.normal_load, error};
  return at_mean;
}

std::vector<QuantityUnderLaw> QuantitiesOf(const ShapeUnderLoad& shape, const Held& log_stiffness,
                                           double stiffness, const KnownContact& known,
                                           double normal_quantile) {
  std::vector<QuantityUnderLaw> quantities;
  const auto add = [&](std::string_view key, std::string_view unit, std::string label,
                       std::string_view formula, const std::optional<PropagatedValue>& value) {
    if (!value) return;
    quantities.push_back({.key = key,
                          .unit = unit,
                          .label = std::move(label),
                          .formula = formula,
                          .value = *value,
                          .interval95 = IntervalOf(*value, log_stiffness, normal_quantile),
                          .predicted = {}});
  };
  add("contact_radius", "m", "contact radius", "a = σG*/8 at the mean load", shape.contact_radius);
  add("equivalent_radius", "m", "equivalent radius", "ρ = 4E*a³/(3N)", shape.equivalent_radius);
  if (shape.equivalent_radius && known.body_1.radius && known.body_2.radius) {
    quantities.back().predicted =
        contact::EquivalentRadius(known.body_1.radius->value, known.body_2.radius->value);
  }
  add("compliance", "1/Pa", "tangential compliance", "G* = 8a/σ, a = ∛(3Nρ/(4E*))",
      shape.tangential_compliance);
  add("effective_modulus", "Pa", "effective modulus", "E* = 3Nρ/(4a³)", shape.effective_modulus);
  add("youngs_modulus", "Pa", fmt::format("Young's modulus {}", shape.body),
      "of E*, ν and the other body", shape.youngs_modulus);
  if (shape.youngs_modulus) {
    quantities.back().interval95 =
        IntervalOfModulus(*shape.youngs_modulus, log_stiffness, stiffness, known, normal_quantile);
  }
  add("slope", "-", "slope of the cone", "tan θ = 2N/(πE*a²)", shape.slope);
  add("load_over_stiffness", "m", "load over stiffness", "N/σ", shape.load_over_stiffness);
  return quantities;
}

std::optional<ContactShape> ShapeOf(std::string_view hypothesis) {
  if (hypothesis == "sphere") return ContactShape::kSphere;
  if (hypothesis == "cone") return ContactShape::kCone;
  if (hypothesis == "flat_punch") return ContactShape::kFlatPunch;
  if (hypothesis == "rough") return ContactShape::kRough;
  return std::nullopt;  // of elements in parallel p = α says it
}

/// Returns n of the body z ∝ r^n whose p = α = 1/(n + 1); empty where p may be 0 or 1.
std::optional<QuantityUnderLaw> ProfileExponent(const Held& exponent) {
  if (!(exponent.value - exponent.half_width > 0) || !(exponent.value + exponent.half_width < 1)) {
    return std::nullopt;
  }
  const auto of = [](double p) { return (1 - p) / p; };
  PropagatedValue value;
  value.value = of(exponent.value);
  value.standard_error = exponent.error / (exponent.value * exponent.value);
  value.fit_error = value.standard_error;
  return QuantityUnderLaw{.key = "profile_exponent",
                          .unit = "-",
                          .label = "exponent of profile",
                          .formula = "n of z ∝ r^n, p = α = 1/(n + 1)",
                          .value = value,
                          .interval95 = Interval{of(exponent.value + exponent.half_width),
                                                 of(exponent.value - exponent.half_width)},
                          .predicted = {}};
}

constexpr std::size_t kLogStiffness = 0;
constexpr std::size_t kExponent = 1;

LoadLaw LawOf(const FitResult& fit, const LoadHypothesis& hypothesis, const Estimate& estimate,
              const KnownContact& known) {
  const std::optional<ContactShape> shape = ShapeOf(hypothesis.name);
  Constraint constraint;
  if (fit.Find("load_exponent")->status != ParameterStatus::kFixed) {
    constraint = shape ? Constraint{.factor = {0, 1, 0}, .value = hypothesis.exponent}
                       : Constraint{.factor = {0, 1, -1}, .value = 0.0};
  }
  const Held log_stiffness = Hold(estimate, constraint, kLogStiffness);
  LoadLaw law;
  law.name = hypothesis.name;
  law.exponent = hypothesis.exponent;
  const double stiffness = std::exp(log_stiffness.value);
  law.stiffness = {stiffness, stiffness * log_stiffness.error};
  if (log_stiffness.error > 0) {
    law.stiffness95 = Interval{stiffness * std::exp(-log_stiffness.half_width),
                               stiffness * std::exp(log_stiffness.half_width)};
  }
  if (shape) {
    const ShapeUnderLoad contact = contact::IdentifyShape(*shape, law.stiffness, known);
    law.quantities =
        QuantitiesOf(contact, log_stiffness, stiffness, known, estimate.normal_quantile);
    law.unidentified = contact.unidentified;
    return law;
  }
  const Held exponent = Hold(estimate, constraint, kExponent);
  law.exponent = std::max(exponent.value, 0.0);  // as α
  if (const auto profile = ProfileExponent(exponent)) law.quantities.push_back(*profile);
  return law;
}

/// True if a value that was given is an exponent, as written with three digits.
bool IsHeldAt(double given, double exponent) {
  constexpr double kHalfOfThirdDigit = 5e-4;
  return std::abs(given - exponent) <= kHalfOfThirdDigit;
}

/// Returns the laws of the load that a series does not reject, each held over all loads:
///
/// p is held by projection. Of θ = (ln σ, p, α) with covariance C, and a theory that is g = cᵀθ − d
/// = 0, the estimate with it is
///   θ − C·c·g/(cᵀCc),   with covariance C − C·c·cᵀC/(cᵀCc)
/// the least change by the errors of θ: generalised least squares under a constraint, of which a
/// fit with p held is the same to first order. It is uncorrelated with g, on which the theory is
/// tested: what is tenable is not biased by having been tested.
///
/// An interval is Student's of ln σ, wider by as much as causes, profiles or another past make that
/// of σ and, as far as it moves σ, that of p. What follows is a power of σ and of inputs, whose
/// uncertainties count as normal.
/// @param hypotheses  of the same fit
/// @param known       of the contact
std::vector<LoadLaw> TenableLaws(const FitResult& fit,
                                 const std::vector<LoadHypothesis>& hypotheses,
                                 const KnownContact& known) {
  const ParameterEstimate& exponent = *fit.Find("load_exponent");
  if (!exponent.is_known() || !fit.Find("sigma")->is_known()) return {};
  const bool is_held = exponent.status == ParameterStatus::kFixed;
  const Estimate estimate = EstimateOf(fit);
  const KnownContact at_mean = AtMeanLoad(fit, known);
  std::vector<LoadLaw> laws;
  for (const LoadHypothesis& hypothesis : hypotheses) {
    const bool is_tenable = is_held ? ShapeOf(hypothesis.name).has_value() &&
                                          IsHeldAt(exponent.value, hypothesis.exponent)
                                    : hypothesis.p_value && *hypothesis.p_value >= kSignificance;
    if (is_tenable) laws.push_back(LawOf(fit, hypothesis, estimate, at_mean));
  }
  return laws;
}

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
