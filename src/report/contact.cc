#include "mindahl/report/contact.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
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

using End = std::optional<double> ParameterEstimate::*;
constexpr std::array<End, 2> kEnds = {&ParameterEstimate::lower95, &ParameterEstimate::upper95};

/// Returns an end of the interval, the value of what is held; empty where it is open.
std::optional<double> EndOf(const ParameterEstimate& estimate, End end) {
  if (estimate.status == ParameterStatus::kFixed) return estimate.value;
  return estimate.*end && *(estimate.*end) > 0 ? estimate.*end : std::nullopt;
}

/// Distances of the logarithm of a quantity from its value to where the ends of a parameter take
/// it, of either sign; empty towards an end that is open.
struct LogWays {
  std::optional<double> lower = 0.0;
  std::optional<double> upper = 0.0;
};

/// Adds in quadrature, with a correlation that is of ways in the same direction.
std::optional<double> Together(const std::optional<double>& one, const std::optional<double>& other,
                               double correlation = 0.0) {
  if (!one || !other) return std::nullopt;
  if (*one == 0 || *other == 0) return std::abs(*one) + std::abs(*other);
  const double squares = *one * *one + *other * *other + 2 * correlation * *one * *other;
  return std::sqrt(std::max(squares, 0.0));
}

/// Maps the ends of the parameters' intervals to quantities of the contact.
class Mapping {
 public:
  Mapping(const FitResult& fit, const KnownContact& known)
      : fit_(fit),
        known_(known),
        sigma_(*fit.Find("sigma")),
        slip_force_(*fit.Find("slip_force")) {}

  [[nodiscard]] std::optional<UncertainValue> AtEstimate(Kind kind) const {
    return contact::IdentifyContact(kind, sigma_.value, slip_force_.value, known_);
  }

  /// Sets value and ends of a quantity that follows.
  void Fill(ContactQuantity& quantity, Kind kind) const {
    const UncertainValue found = *AtEstimate(kind);
    const bool is_of_sigma = quantity.parameter == "sigma";
    const ParameterEstimate& parameter = is_of_sigma ? sigma_ : slip_force_;
    const auto way_to = [&](double value) -> std::optional<double> {
      const auto moved = contact::IdentifyContact(kind, is_of_sigma ? value : sigma_.value,
                                                  is_of_sigma ? slip_force_.value : value, known_);
      return moved ? std::optional(std::log(moved->value / found.value)) : std::nullopt;
    };
    // Of a given contact radius, p₀ does not follow from the fit; a little further E would not end.
    constexpr double kFurther = 1 + 1e-6;
    const double trend = way_to(kFurther * parameter.value).value_or(0.0);
    LogWays ways;
    if (trend != 0) {
      const auto way = [&](End end) {
        const std::optional<double> value = EndOf(parameter, end);
        return value ? way_to(*value) : std::nullopt;
      };
      ways = {.lower = way(kEnds[trend > 0 ? 0 : 1]), .upper = way(kEnds[trend > 0 ? 1 : 0])};
    }
    Set(quantity, found, ways);
  }

  /// Sets those of δc = 3Tc/(2σ), which follows from both.
  void FillGrossSlip(ContactQuantity& quantity) const {
    const auto way = [](const ParameterEstimate& estimate, End end) {
      const std::optional<double> at = EndOf(estimate, end);
      return at ? std::optional(std::abs(std::log(*at / estimate.value))) : std::nullopt;
    };
    const bool are_free =
        sigma_.status == ParameterStatus::kFree && slip_force_.status == ParameterStatus::kFree;
    // Tc and 1/σ: their ways in one direction are correlated the other way round.
    const double correlation = are_free ? -Correlation(fit_, "sigma", "slip_force") : 0.0;
    LogWays ways;
    ways.lower = Together(way(slip_force_, kEnds[0]), way(sigma_, kEnds[1]), correlation);
    ways.upper = Together(way(slip_force_, kEnds[1]), way(sigma_, kEnds[0]), correlation);
    Set(quantity, 1.5 * slip_force_.value / sigma_.value, ways);
  }

 private:
  /// Adds the inputs' uncertainty to the ways.
  void Set(ContactQuantity& quantity, const UncertainValue& found, const LogWays& ways) const {
    quantity.value = found.value;
    const double of_inputs =
        NormalQuantile(fit_.confidence) * found.standard_error / std::abs(found.value);
    if (ways.lower) quantity.lower = found.value * std::exp(-std::hypot(*ways.lower, of_inputs));
    if (ways.upper) quantity.upper = found.value * std::exp(std::hypot(*ways.upper, of_inputs));
    quantity.why = "the interval of what it follows from is open";
  }

  const FitResult& fit_;
  const KnownContact& known_;
  const ParameterEstimate& sigma_;
  const ParameterEstimate& slip_force_;
};

ContactQuantity Made(std::string_view name, std::string_view symbol, std::string_view unit,
                     std::string_view parameter) {
  return {.name = name,
          .symbol = symbol,
          .unit = unit,
          .parameter = parameter,
          .value = {},
          .lower = {},
          .upper = {},
          .why = {}};
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
  constexpr double kTolerance = 0.25;
  const loop::LoopFacts& facts = fit.WidestRecord().facts;
  if (!loop::Slides(facts) || !facts.half_gap || facts.cycles.empty()) return true;
  double centre = 0.0;
  for (const loop::CycleFacts& cycle : facts.cycles) centre += cycle.centre_force;
  centre /= static_cast<double>(facts.cycles.size());
  const double plateau = std::abs(*facts.half_gap) + sense * centre;
  return std::abs(slip_force - plateau) < kTolerance * std::abs(*facts.half_gap);
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
  quantity.value = slip_force.value * share;
  quantity.why = "the interval of slip_force or asymmetry is open";
  const bool are_free =
      slip_force.status == ParameterStatus::kFree && asymmetry.status == ParameterStatus::kFree;
  const double correlation = are_free ? sense * Correlation(fit, "slip_force", "asymmetry") : 0.0;
  const auto way = [&](End of_force, End of_asymmetry) {
    const std::optional<double> force = EndOf(slip_force, of_force);
    std::optional<double> other = asymmetry.*of_asymmetry;
    if (asymmetry.status == ParameterStatus::kFixed) other = asymmetry.value;
    if (!force || !other) return std::optional<double>();
    return Together(std::abs(std::log(*force / slip_force.value)),
                    std::abs(*other - asymmetry.value) / share, correlation);
  };
  const bool is_up = sense > 0;
  if (const auto found = way(kEnds[0], kEnds[is_up ? 0 : 1])) {
    quantity.lower = *quantity.value * std::exp(-*found);
  }
  if (const auto found = way(kEnds[1], kEnds[is_up ? 1 : 0])) {
    quantity.upper = *quantity.value * std::exp(*found);
  }
}

ContactQuantity NormalLoad(const FitResult& fit, const KnownContact& known) {
  ContactQuantity load = Made("normal_load", "N", "N", "");
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
  const Mapping mapping(fit, known);
  const bool denies_hertz = DeniesHertz(fit);
  const auto describe = [&](const QuantityRow& row) {
    ContactQuantity quantity = Made(row.name, row.symbol, row.unit, row.parameter);
    const ParameterEstimate& parameter = *fit.Find(row.parameter);
    const bool needs_fit = !(row.name == "maximum_pressure" && known.contact_radius);
    const std::optional<UncertainValue> at_estimate = mapping.AtEstimate(row.kind);
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
      mapping.Fill(quantity, row.kind);
    }
    return quantity;
  };
  std::vector<ContactQuantity> quantities;
  for (const QuantityRow& row : kQuantities) {
    quantities.push_back(describe(row));
    if (row.name != "friction_coefficient" || fit.Find("asymmetry") == nullptr) continue;
    quantities.push_back(Made("slip_force_positive", "Tc up", "N", "slip_force"));
    FillSlipForce(fit, 1.0, quantities.back());
    quantities.push_back(Made("slip_force_negative", "down", "N", "slip_force"));
    FillSlipForce(fit, -1.0, quantities.back());
  }
  for (const QuantityRow& row : kOfSeries) {
    if (!fit.is_load_series() || !known.normal_load || !mapping.AtEstimate(row.kind)) continue;
    const auto old = std::ranges::find(quantities, row.name, &ContactQuantity::name);
    if (old == quantities.end()) {
      quantities.push_back(describe(row));
    } else if (!old->value) {
      *old = describe(row);
    }
  }
  ContactQuantity gross_slip = Made("gross_slip_displacement", "δc", "m", "alpha");
  const std::optional<bool> is_rejected = TestAlpha(fit).is_rejected;
  if (!fit.Find("sigma")->is_known() || !fit.Find("slip_force")->is_known()) {
    gross_slip.why = "needs an identifiable sigma and slip_force";
  } else if (is_rejected && *is_rejected) {
    gross_slip.why = "of Mindlin's contact, α = 1/3, which is rejected";
  } else {
    mapping.FillGrossSlip(gross_slip);
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
  constexpr double kAsGoodAsSlip = 0.99;
  const double gross_slip = models::SteadyGrossSlipAmplitude(model, law);
  if (std::isfinite(gross_slip)) return contact_amplitude >= gross_slip;
  return models::SteadyPeakForce(model, law, contact_amplitude) >= kAsGoodAsSlip * law.slip_force;
}

}  // namespace mindahl::report
