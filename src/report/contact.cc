#include "mindahl/report/contact.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <tuple>
#include <utility>

#include "core/probability.h"
#include "mindahl/contact/mindlin_dahl_mapping.h"
#include "mindahl/models/steady_loop.h"
#include "report/statements.h"

namespace mindahl::report {

using Kind = contact::ContactQuantity;
using contact::KnownContact;
using contact::UncertainValue;
using identification::FitResult;
using identification::ParameterEstimate;
using identification::ParameterStatus;

namespace {

/// Values of a fit's parameters by their names.
using Values = std::map<std::string_view, double>;

Values ValuesOf(const FitResult& fit) {
  Values values;
  for (const ParameterEstimate& estimate : fit.parameters) values[estimate.name] = estimate.value;
  return values;
}

/// Returns a quantity, > 0; empty where the parameters are none of a contact.
using Formula = std::function<std::optional<UncertainValue>(const Values&)>;

/// Returns how far the interval of each parameter takes the logarithm of a quantity to its larger,
/// or its smaller, end, negative where the parameter falls; empty where an end is open.
std::optional<std::vector<double>> WaysTo(bool up, const FitResult& fit, const Formula& formula) {
  const Values values = ValuesOf(fit);
  const double found = formula(values)->value;
  std::vector<double> ways(fit.parameters.size(), 0.0);
  for (std::size_t k = 0; k < ways.size(); ++k) {
    const ParameterEstimate& estimate = fit.parameters[k];
    if (estimate.status == ParameterStatus::kFixed) continue;
    const auto change = [&](double value) -> std::optional<double> {
      Values moved = values;
      moved[estimate.name] = value;
      const auto quantity = formula(moved);
      return quantity ? std::optional(std::log(quantity->value / found)) : std::nullopt;
    };
    // The step shows whether the quantity grows with the parameter. It is small because E may have
    // no value further away. Where the contact radius is given, p₀ does not depend on the fit.
    const double step = 1e-6 * (estimate.value == 0 ? 1.0 : std::abs(estimate.value));
    const double trend = change(estimate.value + step).value_or(0.0);
    if (trend == 0) continue;
    const bool rises = up == (trend > 0);
    const std::optional<double> end = rises ? estimate.upper95 : estimate.lower95;
    const std::optional<double> way = end ? change(*end) : std::nullopt;
    if (!way || !std::isfinite(*way)) return std::nullopt;
    ways[k] = rises ? std::abs(*way) : -std::abs(*way);
  }
  return ways;
}

/// Sets value and ends of a quantity: the ways of its parameters added in quadrature, with their
/// correlations and the uncertainty of its inputs.
void Fill(const FitResult& fit, const Formula& formula, ContactQuantity& quantity) {
  const UncertainValue found = *formula(ValuesOf(fit));
  quantity.value = found.value;
  quantity.why = "the interval of what it follows from is open";
  const double of_inputs =
      NormalQuantile(fit.confidence) * found.standard_error / std::abs(found.value);
  const std::size_t count = fit.parameters.size();
  const auto correlation = [&](std::size_t i, std::size_t j) {
    if (i == j) return 1.0;
    const double known =
        fit.correlation.size() == count * count ? fit.correlation[i * count + j] : 0.0;
    return std::isfinite(known) ? known : 0.0;
  };
  for (const bool up : {false, true}) {
    const std::optional<std::vector<double>> ways = WaysTo(up, fit, formula);
    if (!ways) continue;
    double squares = of_inputs * of_inputs;
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = 0; j < count; ++j) {
        squares += (*ways)[i] * (*ways)[j] * correlation(i, j);
      }
    }
    const double whole = std::sqrt(std::max(squares, 0.0));
    (up ? quantity.upper : quantity.lower) = found.value * std::exp(up ? whole : -whole);
  }
}

struct QuantityRow {
  std::string_view name;
  std::string_view symbol;
  std::string_view unit;
  std::string_view parameter;
  Kind kind;
  bool is_of_sphere = true;  ///< follows only where Hertz's law of the load is not denied
  const char* why = "";      ///< inputs that it needs; "" for those of contact::MissingInputs()
};

constexpr std::array kQuantities = {
    QuantityRow{"friction_coefficient", "μ", "-", "slip_force", Kind::kFrictionCoefficient, false},
    QuantityRow{"contact_radius", "a", "m", "sigma", Kind::kContactRadius, false},
    QuantityRow{"compliance", "G*", "1/Pa", "sigma", Kind::kTangentialCompliance, false},
    QuantityRow{"sigma_over_hertz_mindlin", "σ/(8a/G*)", "-", "sigma", Kind::kStiffnessRatio, false,
                "needs materials, radii and load, or contact radius and compliance"},
    QuantityRow{"equivalent_radius", "ρ", "m", "sigma", Kind::kEquivalentRadius},
    QuantityRow{"maximum_pressure", "p₀", "Pa", "sigma", Kind::kMaximumPressure},
};

/// Lists what several loads make known of the materials of a smooth sphere of known radii.
constexpr std::array kOfSeries = {
    QuantityRow{"compliance", "G*", "1/Pa", "sigma", Kind::kSphereCompliance},
    QuantityRow{"effective_modulus", "E*", "Pa", "sigma", Kind::kSphereEffectiveModulus},
    QuantityRow{"youngs_modulus", "E", "Pa", "sigma", Kind::kSphereYoungsModulus},
};

Formula FormulaOf(Kind kind, const KnownContact& known) {
  return [kind, &known](const Values& at) -> std::optional<UncertainValue> {
    const double sigma = at.at("sigma");
    const double slip_force = at.at("slip_force");
    if (!(sigma > 0 && slip_force > 0)) return std::nullopt;
    return contact::IdentifyContact(kind, sigma, slip_force, known);
  };
}

constexpr std::string_view kWhyNoSphere =
    "of Hertz's law, σ ∝ N^(1/3), which the load series denies";

/// False where a loop that slides measures another force in that direction: then the asymmetry and
/// the offset of the force stand for each other.
bool IsThatOfThePlateau(const FitResult& fit, double sense, double slip_force) {
  const loop::LoopFacts& facts = fit.WidestRecord().facts;
  if (!loop::Slides(facts) || !facts.half_gap || facts.cycles.empty()) return true;
  double centre = 0.0;
  for (const loop::CycleFacts& cycle : facts.cycles) centre += cycle.centre_force.value_or(0.0);
  centre /= static_cast<double>(facts.cycles.size());
  const double plateau = std::abs(*facts.half_gap) + sense * centre;
  return std::abs(slip_force - plateau) <
         identification::Thresholds().off_plateau * std::abs(*facts.half_gap);
}

/// Returns the force at which the contact slips in one direction, Tc(1 ± A).
/// @param sense  +1 towards positive displacement, −1 the other way
void FillSlipForce(const FitResult& fit, double sense, ContactQuantity& quantity) {
  const Formula formula = [sense](const Values& at) -> std::optional<UncertainValue> {
    const double force = at.at("slip_force") * (1 + sense * at.at("asymmetry"));
    return force > 0 ? std::optional<UncertainValue>(force) : std::nullopt;
  };
  const std::optional<UncertainValue> found = formula(ValuesOf(fit));
  if (!fit.Find("slip_force")->is_known() || !fit.Find("asymmetry")->is_known() || !found) {
    quantity.why = "slip_force or asymmetry is not identifiable";
  } else if (!IsThatOfThePlateau(fit, sense, found->value)) {
    quantity.why = "the measured strokes do not show it: it stands for an offset of the force";
  } else {
    Fill(fit, formula, quantity);
  }
}

constexpr double kThird = contact::kMindlinShapeExponent;  // of α, and Hertz's of the load

bool ExcludesAThird(const ParameterEstimate& estimate) {
  return (estimate.lower95 && *estimate.lower95 > kThird) ||
         (estimate.upper95 && *estimate.upper95 < kThird);
}

ContactQuantity NormalLoad(const FitResult& fit, const KnownContact& known) {
  ContactQuantity load{.name = "normal_load", .symbol = "N", .unit = "N"};
  load.why = known.normal_load ? "exact" : "not given, and no column has it";
  if (!known.normal_load) return load;
  load.value = known.normal_load->value;
  const double half_width = NormalQuantile(fit.confidence) * known.normal_load->standard_error;
  if (half_width > 0) {
    load.lower = *load.value - half_width;
    load.upper = *load.value + half_width;
  }
  return load;
}

}  // namespace

std::vector<ContactQuantity> DescribeContact(const FitResult& fit, const KnownContact& known) {
  const bool denies_hertz = DeniesHertz(fit);
  const auto describe = [&](const QuantityRow& row) {
    ContactQuantity quantity{
        .name = row.name, .symbol = row.symbol, .unit = row.unit, .parameter = row.parameter};
    const ParameterEstimate& parameter = *fit.Find(row.parameter);
    const bool needs_fit = !(row.name == "maximum_pressure" && known.contact_radius);
    const Formula formula = FormulaOf(row.kind, known);
    const std::optional<UncertainValue> at_estimate = formula(ValuesOf(fit));
    if (row.is_of_sphere && denies_hertz) {
      quantity.why = kWhyNoSphere;
    } else if (!at_estimate) {
      quantity.why = row.why;
      if (quantity.why.empty()) {
        quantity.why =
            fmt::format("needs {}", fmt::join(contact::MissingInputs(known, row.kind), ", "));
      }
    } else if (needs_fit && !parameter.is_known()) {
      quantity.why = fmt::format("needs an identifiable {}", row.parameter);
      if (row.name == "friction_coefficient" && WhatIsShown(parameter) == Shown::kLowerLimit) {
        quantity.lower = at_estimate->value * *parameter.lower95 / parameter.value;
      }
    } else {
      Fill(fit, formula, quantity);
    }
    return quantity;
  };
  std::vector<ContactQuantity> quantities;
  for (const QuantityRow& row : kQuantities) {
    quantities.push_back(describe(row));
    if (row.name != "friction_coefficient" || fit.Find("asymmetry") == nullptr) continue;
    for (const auto& [name, symbol, sense] :
         {std::tuple("slip_force_positive", "Tc up", 1.0), {"slip_force_negative", "down", -1.0}}) {
      ContactQuantity& force = quantities.emplace_back(
          ContactQuantity{.name = name, .symbol = symbol, .unit = "N", .parameter = "slip_force"});
      FillSlipForce(fit, sense, force);
    }
  }
  for (const QuantityRow& row : kOfSeries) {
    const bool is_known = FormulaOf(row.kind, known)(ValuesOf(fit)).has_value();
    if (!fit.is_load_series() || !known.normal_load || !is_known) continue;
    const auto old = std::ranges::find(quantities, row.name, &ContactQuantity::name);
    if (old == quantities.end()) {
      quantities.push_back(describe(row));
    } else if (!old->value) {
      *old = describe(row);
    }
  }
  ContactQuantity gross_slip{
      .name = "gross_slip_displacement", .symbol = "δc", .unit = "m", .parameter = "alpha"};
  if (!fit.Find("sigma")->is_known() || !fit.Find("slip_force")->is_known()) {
    gross_slip.why = "needs an identifiable sigma and slip_force";
  } else if (TestAlpha(fit).is_rejected.value_or(false)) {
    gross_slip.why = "of Mindlin's contact, α = 1/3, which is rejected";
  } else {
    const Formula formula = [](const Values& at) {
      return 1.5 * at.at("slip_force") / at.at("sigma");
    };
    Fill(fit, formula, gross_slip);
  }
  quantities.push_back(std::move(gross_slip));
  quantities.push_back(NormalLoad(fit, known));
  return quantities;
}

AlphaTest TestAlpha(const FitResult& fit) {
  AlphaTest test;
  const ParameterEstimate& alpha = *fit.Find("alpha");
  if (alpha.status == ParameterStatus::kFixed) return test;
  test.minus_third = alpha.value - kThird;
  if (!alpha.is_known()) return test;
  test.is_rejected = ExcludesAThird(alpha);
  const double error = fit.ErrorTowards(alpha, kThird);
  if (error > 0 && std::isfinite(error)) {
    test.p_value = PValueOfT(*test.minus_third / error, fit.ErrorDegreesOfFreedom());
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

bool SlipsGrossly(const models::FrictionModel& model, const models::BranchLaw& law,
                  double contact_amplitude) {
  const double gross_slip = models::SteadyGrossSlipAmplitude(model, law);
  if (std::isfinite(gross_slip)) return contact_amplitude >= gross_slip;
  return models::SteadyPeakForce(model, law, contact_amplitude) >=
         (1 - identification::Thresholds().never_slips) * law.slip_force;
}

}  // namespace mindahl::report
