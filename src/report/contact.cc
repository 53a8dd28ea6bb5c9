#include "mindahl/report/contact.h"

#include <algorithm>
#include <cmath>

#include "core/probability.h"
#include "report/statements.h"

namespace mindahl::report {

using Kind = contact::ContactQuantity;
using contact::KnownContact;
using contact::UncertainValue;

namespace {

/// Says how a quantity follows a parameter of the fit.
struct Dependence {
  const ParameterEstimate* parameter;
  double exponent = 0.0;  // of the parameter or, with a factor, of 1 + factor·parameter
  double factor = 0.0;

  /// Returns the logarithm of the quantity as far as it depends on a value of the parameter.
  [[nodiscard]] double LogAt(double value) const {
    return exponent * std::log(factor == 0 ? value : 1 + factor * value);
  }
  /// True if the quantity would be the user's own, from a bound that was given.
  [[nodiscard]] bool is_given() const { return exponent != 0 && parameter->is_at_given_bound(); }
  /// False where the parameter has no value, but a limit or nothing.
  [[nodiscard]] bool has_value() const {
    return exponent == 0 || WhatIsShown(*parameter).value.has_value();
  }
  /// Returns how far the interval of the parameter takes the logarithm up, or down, negative where
  /// the parameter falls; empty where that end is open.
  [[nodiscard]] std::optional<double> WayTo(bool up) const {
    const Shown shown = WhatIsShown(*parameter);
    if (parameter->status == ParameterStatus::kFixed || exponent == 0) return 0.0;
    const bool rises = up == (exponent * (factor == 0 ? 1 : factor) > 0);
    const std::optional<double>& end = rises ? shown.upper : shown.lower;
    if (!end) return std::nullopt;
    const double way = std::abs(LogAt(*end) - LogAt(parameter->value));
    return std::isfinite(way) ? std::optional(rises ? way : -way) : std::nullopt;
  }
};

double CorrelationOf(const FitResult& fit, const Dependence& one, const Dependence& other) {
  const std::size_t count = fit.parameters.size();
  if (fit.correlation.size() != count * count) return 0.0;
  const auto place = [&](const Dependence& of) {
    return static_cast<std::size_t>(of.parameter - fit.parameters.data());
  };
  const double known = fit.correlation[place(one) * count + place(other)];
  return std::isfinite(known) ? known : 0.0;
}

/// Sets value and ends of a quantity > 0: the ways of its parameters added in quadrature, with
/// their correlation and the uncertainty of its inputs. Of one that has a limit alone it has one.
void Fill(const FitResult& fit, const UncertainValue& found, const Dependence& one,
          const Dependence& other, ContactQuantity& quantity) {
  if (one.is_given() || other.is_given()) return;
  if (one.has_value() && other.has_value()) quantity.value = found.value;
  const double of_inputs = NormalQuantile(fit.confidence) * found.standard_error / found.value;
  for (const bool up : {false, true}) {
    const std::optional<double> first = one.WayTo(up);
    const std::optional<double> second = other.WayTo(up);
    if (!first || !second) continue;
    const double squares = of_inputs * of_inputs + *first * *first + *second * *second +
                           2 * *first * *second * CorrelationOf(fit, one, other);
    const double whole = std::sqrt(std::max(squares, 0.0));
    (up ? quantity.upper : quantity.lower) = found.value * std::exp(up ? whole : -whole);
  }
}

struct QuantityRow {
  ContactQuantity quantity;  // without a value
  double exponent;           // of its parameter, unless the contact radius is given
  Kind kind;
  bool is_of_sphere = true;  // follows only where Hertz's law of the load is not denied
};

constexpr std::array kQuantities = {
    QuantityRow{
        {"friction_coefficient", "μ", "-", "slip_force"}, 1, Kind::kFrictionCoefficient, false},
    QuantityRow{{"contact_radius", "a", "m", "sigma"}, 1, Kind::kContactRadius, false},
    QuantityRow{{"compliance", "G*", "1/Pa", "sigma"}, -1, Kind::kTangentialCompliance, false},
    QuantityRow{
        {"sigma_over_hertz_mindlin", "σ/(8a/G*)", "-", "sigma"}, 1, Kind::kStiffnessRatio, false},
    QuantityRow{{"equivalent_radius", "ρ", "m", "sigma"}, 3, Kind::kEquivalentRadius},
    QuantityRow{{"maximum_pressure", "p₀", "Pa", "sigma"}, -2, Kind::kMaximumPressure},
};

/// False where a loop that slides measures another force in that direction: the asymmetry and the
/// offset of the force are then confounded.
bool IsThatOfThePlateau(const FitResult& fit, double sense, double force) {
  const RecordFit& record = fit.WidestRecord();
  const loop::LoopFacts& facts = record.facts;
  if (!loop::Slides(facts) || facts.cycles.empty()) return true;
  double centre = 0.0;
  for (const loop::CycleFacts& cycle : facts.cycles) centre += cycle.centre_force.value_or(0.0);
  centre /= static_cast<double>(facts.cycles.size());
  const ParameterEstimate* zero = fit.FindOf(record, "force_offset");
  if (zero != nullptr) centre -= fit.force_sense * zero->value;
  const double plateau = *facts.half_gap + sense * centre;
  return std::abs(force - plateau) < identification::Thresholds().off_plateau * *facts.half_gap;
}

/// Returns a quantity with the force at which the contact slips in one direction, Tc(1 ± A).
/// @param sense  +1 towards positive displacement, −1 the other way
ContactQuantity SlipForce(const FitResult& fit, ContactQuantity quantity, double sense) {
  const ParameterEstimate& slip_force = *fit.Find("slip_force");
  const ParameterEstimate& asymmetry = *fit.Find("asymmetry");
  const double force = slip_force.value * (1 + sense * asymmetry.value);
  if (slip_force.is_known() && asymmetry.is_known() && force > 0 &&
      IsThatOfThePlateau(fit, sense, force)) {
    Fill(fit, force, {&slip_force, 1}, {&asymmetry, 1, sense}, quantity);
  }
  return quantity;
}

constexpr double kThird = contact::kMindlinShapeExponent;  // of α, and Hertz's of the load

bool ExcludesAThird(const ParameterEstimate& estimate) {
  return (estimate.lower95 && *estimate.lower95 > kThird) ||
         (estimate.upper95 && *estimate.upper95 < kThird);
}

}  // namespace

std::vector<ContactQuantity> DescribeContact(const FitResult& fit, const KnownContact& known) {
  const ParameterEstimate& sigma = *fit.Find("sigma");
  const ParameterEstimate& slip_force = *fit.Find("slip_force");
  std::vector<ContactQuantity> quantities;
  for (const QuantityRow& row : kQuantities) {
    ContactQuantity& quantity = quantities.emplace_back(row.quantity);
    const ParameterEstimate& parameter = *fit.Find(quantity.parameter);
    const double exponent = row.is_of_sphere && known.contact_radius ? 0.0 : row.exponent;
    std::optional<UncertainValue> found;
    if (sigma.value > 0 && slip_force.value > 0 && !(row.is_of_sphere && DeniesHertz(fit))) {
      found = contact::IdentifyContact(row.kind, sigma.value, slip_force.value, known);
    }
    if (found) Fill(fit, *found, {&parameter, exponent}, {&parameter}, quantity);
    if (quantity.name != "friction_coefficient" || fit.Find("asymmetry") == nullptr) continue;
    quantities.push_back(SlipForce(fit, {"slip_force_positive", "Tc up", "N", "slip_force"}, 1));
    quantities.push_back(SlipForce(fit, {"slip_force_negative", "down", "N", "slip_force"}, -1));
  }
  ContactQuantity& slip = quantities.emplace_back("gross_slip_displacement", "δc", "m", "alpha");
  const ParameterEstimate& shape = *fit.Find("alpha");
  const double alpha = shape.status == ParameterStatus::kFixed ? shape.value : kThird;
  // It is that of Mindlin's contact, and slip is never complete where α is 1 or more.
  if (sigma.is_known() && slip_force.is_known() && alpha < 1 &&
      !(shape.is_known() && ExcludesAThird(shape))) {
    Fill(fit, slip_force.value / (sigma.value * (1 - alpha)), {&slip_force, 1}, {&sigma, -1}, slip);
  }
  ContactQuantity& load = quantities.emplace_back("normal_load", "N", "N");
  if (!known.normal_load) return quantities;
  load.value = known.normal_load->value;
  const double half_width = NormalQuantile(fit.confidence) * known.normal_load->standard_error;
  if (half_width > 0) {
    load.lower = *load.value - half_width;
    load.upper = *load.value + half_width;
  }
  return quantities;
}

AlphaTest TestAlpha(const FitResult& fit) {
  AlphaTest test;
  const ParameterEstimate& alpha = *fit.Find("alpha");
  if (alpha.status == ParameterStatus::kFixed || !alpha.is_known()) return test;
  test.minus_third = alpha.value - kThird;
  if (alpha.bounds && (kThird < alpha.bounds->lower || kThird > alpha.bounds->upper)) return test;
  test.is_rejected = ExcludesAThird(alpha);
  const double error = fit.ErrorTowards(alpha, kThird);
  if (error > 0 && std::isfinite(error)) {
    test.p_value = PValueOfT(*test.minus_third / error, fit.degrees_of_freedom);
  }
  return test;
}

bool DeniesHertz(const FitResult& fit) {
  if (!fit.is_load_series()) return false;
  constexpr double kWritten = 1e-3;  // what it is held at is written with three digits
  const ParameterEstimate& fitted = *fit.Find("load_exponent");
  if (fitted.status == ParameterStatus::kFixed) return std::abs(fitted.value - kThird) >= kWritten;
  return fitted.is_known() && ExcludesAThird(fitted);
}

}  // namespace mindahl::report
