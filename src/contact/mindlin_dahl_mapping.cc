#include "mindahl/contact/mindlin_dahl_mapping.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include "contact/requirements.h"
#include "core/refuse.h"

namespace mindahl::contact {

namespace {

/// @param require  throws unless a value may be one of the quantity
void RequireKnown(std::string_view quantity, const std::optional<UncertainValue>& known,
                  void (*require)(std::string_view, double) = RequirePositive) {
  if (!known) return;
  require(quantity, known->value);
  const std::string uncertainty = fmt::format("standard uncertainty of the {}", quantity);
  RequireNonNegative(uncertainty, known->standard_error);
  if (std::isinf(known->value) && known->standard_error > 0) {
    ThrowInvalid(uncertainty, known->standard_error, "must be 0 for a plane, which is exact");
  }
}

void RequireBody(const KnownBody& body, int number) {
  RequireKnown(fmt::format("youngs_modulus_{} [Pa]", number), body.youngs_modulus);
  RequireKnown(fmt::format("poisson_{} [-]", number), body.poisson_ratio, RequirePoissonRatio);
  RequireKnown(fmt::format("radius_{} [m]", number), body.radius, RequireSurfaceRadius);
}

bool AreElastic(const KnownContact& known) {
  return known.body_1.youngs_modulus && known.body_1.poisson_ratio && known.body_2.youngs_modulus &&
         known.body_2.poisson_ratio;
}
bool KnowsRadii(const KnownContact& known) { return known.body_1.radius && known.body_2.radius; }
bool KnowsHertz(const KnownContact& known) {
  return known.normal_load && AreElastic(known) && KnowsRadii(known);
}

// Quantities of the known ones; the caller has found that they are known.

Body BodyOf(const KnownBody& known) {
  return {.youngs_modulus = *known.youngs_modulus, .poisson_ratio = *known.poisson_ratio};
}
double EffectiveModulusOf(const KnownContact& known) {
  return EffectiveModulus(BodyOf(known.body_1), BodyOf(known.body_2));
}
double ComplianceOf(const KnownContact& known) {
  if (known.tangential_compliance) return *known.tangential_compliance;
  return TangentialCompliance(BodyOf(known.body_1), BodyOf(known.body_2));
}
double EquivalentRadiusOf(const KnownContact& known) {
  return EquivalentRadius(*known.body_1.radius, *known.body_2.radius);
}
double HertzRadiusOf(const KnownContact& known) {
  return HertzContactRadius(*known.normal_load, EquivalentRadiusOf(known),
                            EffectiveModulusOf(known));
}

/// Returns a quantity with the error that those of the inputs make in it.
/// @param compute  of known properties
template <typename Compute>
UncertainValue Propagated(const KnownContact& known, const Compute& compute) {
  KnownContact moved = known;
  UncertainValue result = compute(known);
  const auto add = [&](std::optional<UncertainValue>& input, bool is_poisson_ratio = false) {
    constexpr double kStep = 1e-5;
    constexpr double kLargestPoissonRatio = 0.5;
    if (!input || !(input->standard_error > 0)) return;
    const double at = input->value;
    const double step = kStep * (is_poisson_ratio ? 1 + at : std::abs(at));
    const double above = is_poisson_ratio ? std::min(at + step, kLargestPoissonRatio) : at + step;
    const double below = at - step;
    input->value = above;
    const double more = compute(moved);
    input->value = below;
    const double change = (more - compute(moved)) / (above - below) * input->standard_error;
    input->value = at;
    result.standard_error = std::hypot(result.standard_error, change);
  };
  for (KnownBody* body : {&moved.body_1, &moved.body_2}) {
    add(body->youngs_modulus);
    add(body->radius);
    add(body->poisson_ratio, true);
  }
  add(moved.friction_coefficient);
  add(moved.normal_load);
  add(moved.contact_radius);
  add(moved.tangential_compliance);
  return result;
}

/// Returns a quantity by the values of what is known; empty where they do not determine it.
std::optional<double> ValueOf(ContactQuantity quantity, double stiffness, double slip_force,
                              const KnownContact& known) {
  const std::optional<double> compliance = TangentialCompliance(known);
  const double fitted_radius = compliance ? 0.125 * stiffness * *compliance : 0.0;
  const double radius = known.contact_radius.value_or(fitted_radius);
  const bool has_pressure = known.normal_load && radius > 0;
  switch (quantity) {
    case ContactQuantity::kFrictionCoefficient:
      if (!known.normal_load) return std::nullopt;
      return InRange("friction coefficient [-]",
                     static_cast<long double>(slip_force) / known.normal_load->value);
    case ContactQuantity::kContactRadius:
      if (!compliance) return std::nullopt;
      return fitted_radius;
    case ContactQuantity::kTangentialCompliance:
      if (!known.contact_radius) return std::nullopt;
      return 8.0 * radius / stiffness;
    case ContactQuantity::kEquivalentRadius:
      if (!has_pressure || !AreElastic(known)) return std::nullopt;
      return HertzEquivalentRadius(known.normal_load->value, radius, EffectiveModulusOf(known));
    case ContactQuantity::kMaximumPressure:
      if (!has_pressure) return std::nullopt;
      return HertzMaximumPressure(known.normal_load->value, radius);
    case ContactQuantity::kStiffnessRatio:
      if (!KnowsHertz(known) && !(known.contact_radius && compliance)) return std::nullopt;
      return stiffness / MindlinTangentialStiffness(
                             KnowsHertz(known) ? HertzRadiusOf(known) : radius, *compliance);
  }
  return std::nullopt;
}

}  // namespace

void Validate(const KnownContact& known) {
  RequireKnown("friction [-]", known.friction_coefficient);
  RequireKnown("normal load [N]", known.normal_load);
  RequireKnown("contact radius [m]", known.contact_radius);
  RequireKnown("compliance [1/Pa]", known.tangential_compliance);
  RequireBody(known.body_1, 1);
  RequireBody(known.body_2, 2);
  if (KnowsRadii(known)) EquivalentRadiusOf(known);  // refuses two planes
}

models::BranchLaw MapMindlinToDahl(const MindlinContact& contact) {
  Validate(contact);
  return {.tangential_stiffness =
              MindlinTangentialStiffness(contact.contact_radius, contact.tangential_compliance),
          .shape_exponent = kMindlinShapeExponent,
          .slip_force = contact.slip_force};
}

std::optional<double> TangentialCompliance(const KnownContact& known) {
  if (!known.tangential_compliance && !AreElastic(known)) return std::nullopt;
  return ComplianceOf(known);
}

PredictedContact PredictContact(const KnownContact& known) {
  Validate(known);
  const bool by_radius = known.contact_radius && known.tangential_compliance;
  const bool by_bodies = AreElastic(known) && KnowsRadii(known);
  if (!known.friction_coefficient || !known.normal_load || by_radius == by_bodies) {
    Refuse(
        "a contact needs --friction, --normal-load and either --contact-radius with --compliance "
        "or --youngs-modulus-1, --poisson-1, --radius-1 and the same of body 2");
  }
  const auto radius_of = [by_radius](const KnownContact& at) {
    return by_radius ? at.contact_radius->value : HertzRadiusOf(at);
  };
  const auto slip_force_of = [](const KnownContact& at) {
    return GrossSlipForce(*at.friction_coefficient, *at.normal_load);
  };
  PredictedContact predicted;
  if (by_bodies) {
    predicted.effective_modulus = Propagated(known, EffectiveModulusOf);
    predicted.equivalent_radius = Propagated(known, EquivalentRadiusOf);
  }
  predicted.tangential_compliance = Propagated(known, ComplianceOf);
  predicted.contact_radius = Propagated(known, radius_of);
  predicted.maximum_pressure = Propagated(known, [&](const KnownContact& at) {
    return HertzMaximumPressure(*at.normal_load, radius_of(at));
  });
  predicted.tangential_stiffness = Propagated(known, [&](const KnownContact& at) {
    return MindlinTangentialStiffness(radius_of(at), ComplianceOf(at));
  });
  predicted.slip_force = Propagated(known, slip_force_of);
  predicted.gross_slip_displacement = Propagated(known, [&](const KnownContact& at) {
    return GrossSlipDisplacement({radius_of(at), ComplianceOf(at), slip_force_of(at)});
  });
  return predicted;
}

std::optional<UncertainValue> IdentifyContact(ContactQuantity quantity, double stiffness,
                                              double slip_force, const KnownContact& known) {
  RequirePositive("tangential stiffness [N/m]", stiffness);
  RequirePositive("slip force [N]", slip_force);
  Validate(known);
  const auto value_at = [&](const KnownContact& at) {
    return ValueOf(quantity, stiffness, slip_force, at);
  };
  if (!value_at(known)) return std::nullopt;
  return Propagated(known, [&](const KnownContact& at) {
    return value_at(at).value_or(std::numeric_limits<double>::infinity());
  });
}

std::vector<std::string> DoubtsAbout(const KnownContact& known,
                                     std::optional<double> fitted_radius) {
  constexpr double kSoftestModulus = 1e6;     // [Pa]
  constexpr double kStiffestModulus = 2e12;   // [Pa]
  constexpr double kLargestCompliance = 1.0;  // [1/Pa]
  constexpr double kLargestRadiusShare = 1.0 / 3.0;
  std::vector<std::string> doubts;
  if (known.tangential_compliance && known.tangential_compliance->value > kLargestCompliance) {
    doubts.push_back(fmt::format(
        "compliance G* = {:.4g} 1/Pa is above that of any solid ({:g}): many texts write G* for "
        "its inverse, a modulus; give {:.4g} if so",
        known.tangential_compliance->value, kLargestCompliance,
        1 / known.tangential_compliance->value));
  }
  double smallest_radius = std::numeric_limits<double>::infinity();
  for (const auto& [body, number] : {std::pair{&known.body_1, 1}, std::pair{&known.body_2, 2}}) {
    if (body->radius) smallest_radius = std::min(smallest_radius, std::abs(body->radius->value));
    const double modulus = body->youngs_modulus.value_or(kSoftestModulus);
    const bool is_soft = modulus < kSoftestModulus;
    if (!is_soft && !(modulus > kStiffestModulus)) continue;
    doubts.push_back(fmt::format(
        "Young's modulus of body {} = {:.4g} Pa is {}: give it in Pa, as 210e9", number, modulus,
        is_soft ? "below 1 MPa, softer than rubber" : "above 2 TPa, stiffer than diamond"));
  }
  const std::array<double, 3> radii = {known.contact_radius.value_or(0.0),
                                       fitted_radius.value_or(0.0),
                                       KnowsHertz(known) ? HertzRadiusOf(known) : 0.0};
  const auto* const large = std::ranges::find_if(
      radii, [&](double radius) { return radius > kLargestRadiusShare * smallest_radius; });
  if (large != radii.end()) {
    doubts.push_back(fmt::format(
        "contact radius a = {:.4g} m is more than a third of the radius {:.4g} m of a body, beyond "
        "Hertz's theory: check load, radii, moduli and their units",
        *large, smallest_radius));
  }
  return doubts;
}

}  // namespace mindahl::contact
