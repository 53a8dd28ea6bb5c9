#include "mindahl/report/contact.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
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

double Correlation(const FitResult& fit, std::string_view first, std::string_view second) {
  const std::size_t count = fit.parameters.size();
  const auto place = [&](std::string_view name) {
    return static_cast<std::size_t>(fit.Find(name) - fit.parameters.data());
  };
  const std::size_t at = place(first) * count + place(second);
  const double correlation = at < fit.correlation.size() ? fit.correlation[at] : 0.0;
  return std::isfinite(correlation) ? std::clamp(correlation, -1.0, 1.0) : 0.0;
}

/// A parameter from which a quantity follows.
struct Influence {
  const ParameterEstimate& parameter;
  bool raises;  ///< the quantity grows with it
  /// Change of the quantity's logarithm where the parameter has another value; empty where that is
  /// none of a contact.
  std::function<std::optional<double>(double)> way;
};

/// Returns how far the end of the parameter's interval that raises, or lowers, the quantity takes
/// its logarithm; empty where that end is open.
std::optional<double> WayTo(const Influence& of, bool up) {
  const ParameterEstimate& parameter = of.parameter;
  std::optional<double> end = up == of.raises ? parameter.upper95 : parameter.lower95;
  if (parameter.status == ParameterStatus::kFixed) end = parameter.value;
  const std::optional<double> way = end ? of.way(*end) : std::nullopt;
  return way && std::isfinite(*way) ? std::optional(std::abs(*way)) : std::nullopt;
}

/// Adds in quadrature, with a correlation that is of ways in the same direction.
std::optional<double> Together(const std::optional<double>& one, const std::optional<double>& other,
                               double correlation) {
  if (!one || !other) return std::nullopt;
  if (*one == 0 || *other == 0) return std::abs(*one) + std::abs(*other);
  const double squares = *one * *one + *other * *other + 2 * correlation * *one * *other;
  return std::sqrt(std::max(squares, 0.0));
}

/// Sets value and ends of a quantity that follows from one parameter or two, with the uncertainty
/// of its inputs.
void Fill(const FitResult& fit, const UncertainValue& found, const std::vector<Influence>& of,
          ContactQuantity& quantity) {
  quantity.value = found.value;
  quantity.why = "the interval of what it follows from is open";
  const double of_inputs =
      NormalQuantile(fit.confidence) * found.standard_error / std::abs(found.value);
  double correlation = 0.0;
  if (of.size() == 2 && of[0].parameter.status == ParameterStatus::kFree &&
      of[1].parameter.status == ParameterStatus::kFree) {
    correlation = Correlation(fit, of[0].parameter.name, of[1].parameter.name);
    if (of[0].raises != of[1].raises) correlation = -correlation;
  }
  for (const bool up : {false, true}) {
    std::optional<double> way = 0.0;
    for (const Influence& each : of) way = Together(way, WayTo(each, up), correlation);
    if (!way) continue;
    const double whole = std::hypot(*way, of_inputs);
    (up ? quantity.upper : quantity.lower) = found.value * std::exp(up ? whole : -whole);
  }
}

/// Returns what a parameter that is a factor of a quantity, or of its inverse, does to it.
Influence FactorOf(const ParameterEstimate& parameter, bool raises = true) {
  return {parameter, raises,
          [&parameter](double value) { return std::log(value / parameter.value); }};
}

std::optional<UncertainValue> Identified(Kind kind, const FitResult& fit,
                                         const KnownContact& known) {
  return contact::IdentifyContact(kind, fit.Find("sigma")->value, fit.Find("slip_force")->value,
                                  known);
}

/// Sets a quantity that follows from one parameter and what is known of the contact.
void FillIdentified(const FitResult& fit, const KnownContact& known, Kind kind,
                    ContactQuantity& quantity) {
  const UncertainValue found = *Identified(kind, fit, known);
  const double sigma = fit.Find("sigma")->value;
  const double slip_force = fit.Find("slip_force")->value;
  const bool is_of_sigma = quantity.parameter == "sigma";
  const auto way = [&](double value) -> std::optional<double> {
    if (!(value > 0)) return std::nullopt;
    const auto moved = contact::IdentifyContact(kind, is_of_sigma ? value : sigma,
                                                is_of_sigma ? slip_force : value, known);
    return moved ? std::optional(std::log(moved->value / found.value)) : std::nullopt;
  };
  const ParameterEstimate& parameter = *fit.Find(quantity.parameter);
  // The step shows whether the quantity grows with the parameter. It is small because E may have no
  // value further away. Where the contact radius is given, p₀ does not depend on the fit.
  constexpr double kFurther = 1 + 1e-6;
  const double trend = way(kFurther * parameter.value).value_or(0.0);
  std::vector<Influence> of;
  if (trend != 0) of.push_back({parameter, trend > 0, way});
  Fill(fit, found, of, quantity);
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

constexpr std::string_view kWhyNoSphere =
    "of Hertz's law, σ ∝ N^(1/3), which the load series denies";

/// False where a loop that slides measures another force in that direction: then the asymmetry and
/// the offset of the force stand for each other.
bool IsThatOfThePlateau(const FitResult& fit, double sense, double slip_force) {
  const loop::LoopFacts& facts = fit.WidestRecord().facts;
  if (!loop::Slides(facts) || !facts.half_gap || facts.cycles.empty()) return true;
  double centre = 0.0;
  for (const loop::CycleFacts& cycle : facts.cycles) centre += cycle.centre_force;
  centre /= static_cast<double>(facts.cycles.size());
  const double plateau = std::abs(*facts.half_gap) + sense * centre;
  return std::abs(slip_force - plateau) <
         identification::Thresholds().off_plateau * std::abs(*facts.half_gap);
}

/// Returns the force at which the contact slips in one direction, Tc(1 ± A).
/// @param sense  +1 towards positive displacement, −1 the other way
void FillSlipForce(const FitResult& fit, double sense, ContactQuantity& quantity) {
  const ParameterEstimate& slip_force = *fit.Find("slip_force");
  const ParameterEstimate& asymmetry = *fit.Find("asymmetry");
  const double share = 1 + sense * asymmetry.value;
  if (!slip_force.is_known() || !asymmetry.is_known() || !(share > 0)) {
    quantity.why = "slip_force or asymmetry is not identifiable";
    return;
  }
  if (!IsThatOfThePlateau(fit, sense, slip_force.value * share)) {
    quantity.why = "the measured strokes do not show it: it stands for an offset of the force";
    return;
  }
  const Influence of_asymmetry = {asymmetry, sense > 0,
                                  [&](double value) { return (value - asymmetry.value) / share; }};
  Fill(fit, slip_force.value * share, {FactorOf(slip_force), of_asymmetry}, quantity);
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
    const std::optional<UncertainValue> at_estimate = Identified(row.kind, fit, known);
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
      FillIdentified(fit, known, row.kind, quantity);
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
    if (!fit.is_load_series() || !known.normal_load || !Identified(row.kind, fit, known)) continue;
    const auto old = std::ranges::find(quantities, row.name, &ContactQuantity::name);
    if (old == quantities.end()) {
      quantities.push_back(describe(row));
    } else if (!old->value) {
      *old = describe(row);
    }
  }
  ContactQuantity gross_slip{
      .name = "gross_slip_displacement", .symbol = "δc", .unit = "m", .parameter = "alpha"};
  const ParameterEstimate& sigma = *fit.Find("sigma");
  const ParameterEstimate& slip_force = *fit.Find("slip_force");
  const std::optional<bool> is_rejected = TestAlpha(fit).is_rejected;
  if (!sigma.is_known() || !slip_force.is_known()) {
    gross_slip.why = "needs an identifiable sigma and slip_force";
  } else if (is_rejected && *is_rejected) {
    gross_slip.why = "of Mindlin's contact, α = 1/3, which is rejected";
  } else {
    Fill(fit, 1.5 * slip_force.value / sigma.value,
         {FactorOf(slip_force), FactorOf(sigma, /*raises=*/false)}, gross_slip);
  }
  quantities.push_back(std::move(gross_slip));
  quantities.push_back(NormalLoad(fit, known));
  return quantities;
}

AlphaTest TestAlpha(const FitResult& fit) {
  AlphaTest test;
  const ParameterEstimate& alpha = *fit.Find("alpha");
  if (alpha.status == ParameterStatus::kFixed) return test;
  constexpr double kThird = contact::kMindlinShapeExponent;
  test.minus_third = alpha.value - kThird;
  if (!alpha.is_known()) return test;
  test.is_rejected =
      (alpha.lower95 && *alpha.lower95 > kThird) || (alpha.upper95 && *alpha.upper95 < kThird);
  const double error = fit.ErrorTowards(alpha, kThird);
  if (error > 0 && std::isfinite(error)) {
    test.p_value = PValueOfT(*test.minus_third / error, fit.ErrorDegreesOfFreedom());
  }
  return test;
}

namespace {

/// True if a load series may follow σ ∝ N^p with an exponent between two values: where the interval
/// of the fitted one, or what it is held at, as written with three digits, reaches one of these.
bool MayHaveExponent(const FitResult& fit, double least, double greatest) {
  constexpr double kWritten = 1e-3;
  const ParameterEstimate& fitted = *fit.Find("load_exponent");
  if (fitted.status == ParameterStatus::kFixed) {
    return fitted.value > least - kWritten && fitted.value < greatest + kWritten;
  }
  return !fitted.is_known() || !((fitted.lower95 && *fitted.lower95 > greatest) ||
                                 (fitted.upper95 && *fitted.upper95 < least));
}

}  // namespace

std::vector<std::string> TheoriesOfLoad(const FitResult& fit) {
  std::vector<std::string> theories;
  if (!fit.is_load_series() || !fit.Find("load_exponent")->is_known()) return theories;
  const auto add = [&](const char* name, double exponent, double least, double greatest) {
    if (!MayHaveExponent(fit, least, greatest)) return;
    theories.push_back(fmt::format("{} ({:.3g})", name, exponent));
  };
  constexpr double kThird = contact::kMindlinShapeExponent;
  const ParameterEstimate& alpha = *fit.Find("alpha");
  add("smooth sphere", kThird, kThird, kThird);
  add("elements in parallel, α", alpha.value, alpha.lower95.value_or(alpha.value),
      alpha.upper95.value_or(alpha.value));
  for (const auto& [name, exponent] :
       {std::pair("cone", 0.5), {"flat punch", 0.0}, {"rough surfaces", 1.0}}) {
    add(name, exponent, exponent, exponent);
  }
  return theories;
}

bool DeniesHertz(const FitResult& fit) {
  constexpr double kThird = contact::kMindlinShapeExponent;
  return fit.is_load_series() && !MayHaveExponent(fit, kThird, kThird);
}

bool SlipsGrossly(const models::FrictionModel& model, const models::BranchLaw& law,
                  double contact_amplitude) {
  const double gross_slip = models::SteadyGrossSlipAmplitude(model, law);
  if (std::isfinite(gross_slip)) return contact_amplitude >= gross_slip;
  return models::SteadyPeakForce(model, law, contact_amplitude) >=
         (1 - identification::Thresholds().never_slips) * law.slip_force;
}

}  // namespace mindahl::report
