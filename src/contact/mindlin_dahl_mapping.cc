#include "mindahl/contact/mindlin_dahl_mapping.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <string_view>
#include <utility>

#include "contact/body_requirements.h"
#include "mindahl/core/error.h"

namespace mindahl {
namespace {

void RequireUncertain(std::string_view quantity, std::string_view unit,
                      const UncertainValue& estimate) {
  RequirePositive(fmt::format("{} [{}]", quantity, unit), estimate.value);
  // Infinity is allowed: a fit may leave a parameter open.
  if (!(estimate.standard_error >= 0.0)) {
    ThrowInvalid(fmt::format("standard error of the {} [{}]", quantity, unit),
                 estimate.standard_error, "must be >= 0");
  }
}

void RequireBody(const KnownBody& body, int number) {
  if (body.youngs_modulus) {
    RequirePositive(fmt::format("Young's modulus of body {} [Pa]", number), *body.youngs_modulus);
  }
  if (body.poisson_ratio) {
    RequirePoissonRatio(fmt::format("Poisson ratio of body {}", number), *body.poisson_ratio);
  }
  if (body.radius) {
    RequireSurfaceRadius(fmt::format("radius of body {} [m]", number), *body.radius);
  }
}

void RequireKnown(const KnownContact& known) {
  if (known.normal_load) RequirePositive("normal load [N]", *known.normal_load);
  if (known.contact_radius) RequirePositive("contact radius [m]", *known.contact_radius);
  if (known.tangential_compliance) {
    RequirePositive("tangential compliance [1/Pa]", *known.tangential_compliance);
  }
  RequireBody(known.body_1, 1);
  RequireBody(known.body_2, 2);
}

/// A result proportional to the given power of an estimate.
UncertainValue Propagate(double value, int power, const UncertainValue& estimate) {
  const double relative_error = estimate.standard_error / estimate.value;
  return {value, value * std::abs(power) * relative_error};
}

/// The body for functions that do not read its radius.
std::optional<Body> Elastic(const KnownBody& body) {
  if (!body.youngs_modulus || !body.poisson_ratio) return std::nullopt;
  return Body{.youngs_modulus = *body.youngs_modulus, .poisson_ratio = *body.poisson_ratio};
}

std::vector<std::string> MissingElasticConstants(const KnownContact& known) {
  std::vector<std::string> missing;
  for (const auto& [body, number] : {std::pair{&known.body_1, 1}, std::pair{&known.body_2, 2}}) {
    if (!body->youngs_modulus) {
      missing.push_back(fmt::format("Young's modulus of body {}", number));
    }
    if (!body->poisson_ratio) {
      missing.push_back(fmt::format("the Poisson ratio of body {}", number));
    }
  }
  constexpr std::size_t kAll = 4;
  if (missing.size() == kAll) return {"E and ν of both bodies"};
  return missing;
}

std::vector<std::string> MissingRadii(const KnownContact& known) {
  std::vector<std::string> missing;
  if (!known.body_1.radius) missing.emplace_back("the radius of body 1");
  if (!known.body_2.radius) missing.emplace_back("the radius of body 2");
  constexpr std::size_t kAll = 2;
  if (missing.size() == kAll) return {"the radii of both bodies"};
  return missing;
}

void Append(std::vector<std::string>& list, const std::vector<std::string>& more) {
  list.insert(list.end(), more.begin(), more.end());
}

std::string Needs(std::string_view quantity, const std::vector<std::string>& inputs) {
  return fmt::format("{} needs {}", quantity, fmt::join(inputs, ", "));
}

/// What can be had from the knowledge alone, before the fit is used.
struct Derived {
  std::optional<double> effective_modulus;
  std::optional<double> tangential_compliance;
  std::optional<double> equivalent_radius;
};

Derived DeriveFromKnown(const KnownContact& known, std::vector<std::string>& redundant) {
  Derived derived;
  derived.tangential_compliance = known.tangential_compliance;
  const std::optional<Body> body_1 = Elastic(known.body_1);
  const std::optional<Body> body_2 = Elastic(known.body_2);
  if (body_1 && body_2) {
    derived.effective_modulus = EffectiveModulus(*body_1, *body_2);
    const double of_materials = TangentialCompliance(*body_1, *body_2);
    if (known.tangential_compliance) {
      redundant.push_back(fmt::format(
          "tangential compliance is given as {:.6g} 1/Pa and is {:.6g} 1/Pa from the "
          "elastic constants (given/derived = {:.6g}): the given value is used",
          *known.tangential_compliance, of_materials, *known.tangential_compliance / of_materials));
    } else {
      derived.tangential_compliance = of_materials;
    }
  }
  if (known.body_1.radius && known.body_2.radius) {
    derived.equivalent_radius = EquivalentRadius(*known.body_1.radius, *known.body_2.radius);
  }
  return derived;
}

HertzPrediction Predict(const UncertainValue& tangential_stiffness,
                        const UncertainValue& slip_force, double normal_load,
                        double equivalent_radius, double effective_modulus,
                        double tangential_compliance) {
  HertzPrediction hertz;
  hertz.effective_modulus = effective_modulus;
  hertz.equivalent_radius = equivalent_radius;
  hertz.contact_radius = HertzContactRadius(normal_load, equivalent_radius, effective_modulus);
  hertz.maximum_pressure = HertzMaximumPressure(normal_load, hertz.contact_radius);
  hertz.tangential_stiffness =
      MindlinTangentialStiffness(hertz.contact_radius, tangential_compliance);
  hertz.gross_slip_displacement =
      Propagate(GrossSlipDisplacement(
                    MindlinContact{hertz.contact_radius, tangential_compliance, slip_force.value}),
                1, slip_force);
  hertz.sigma_over_hertz_mindlin =
      Propagate(tangential_stiffness.value / hertz.tangential_stiffness, 1, tangential_stiffness);
  return hertz;
}

std::vector<std::string> Unidentified(const KnownContact& known, const Derived& derived,
                                      const IdentifiedContact& identified) {
  std::vector<std::string> unidentified;
  const std::vector<std::string> missing_elastic = MissingElasticConstants(known);
  std::vector<std::string> missing_load;
  if (!known.normal_load) missing_load.emplace_back("the normal load");
  // A radius from the loop takes G*, which takes the materials.
  const bool radius_known = known.contact_radius || identified.contact_radius;
  const std::string radius_inputs = fmt::format("the tangential compliance (or what gives it: {})",
                                                fmt::join(missing_elastic, ", "));

  if (!identified.friction_coefficient) {
    unidentified.push_back(Needs("friction coefficient", missing_load));
  }
  if (!radius_known) {
    unidentified.push_back(Needs("contact radius", {radius_inputs}));
    unidentified.push_back(Needs("tangential compliance", {"the contact radius"}));
  }
  if (!identified.equivalent_radius) {
    std::vector<std::string> inputs = missing_load;
    // The elastic constants give the compliance too, and with it the contact radius.
    Append(inputs, missing_elastic);
    unidentified.push_back(Needs("equivalent radius", inputs));
  }
  if (!identified.maximum_pressure) {
    std::vector<std::string> inputs = missing_load;
    if (!radius_known) inputs.push_back("the contact radius or " + radius_inputs);
    unidentified.push_back(Needs("maximum pressure", inputs));
  }
  if (known.contact_radius && !derived.tangential_compliance) {
    unidentified.push_back(
        Needs("comparison of the stiffness with the given contact radius", {radius_inputs}));
  }
  if (!identified.hertz) {
    std::vector<std::string> inputs = missing_load;
    Append(inputs, missing_elastic);
    Append(inputs, MissingRadii(known));
    unidentified.push_back(Needs("Hertz prediction of the stiffness", inputs));
  }
  return unidentified;
}

}  // namespace

MindlinDahlParameters MapMindlinToDahl(const MindlinContact& contact) {
  Validate(contact);
  return {.tangential_stiffness =
              MindlinTangentialStiffness(contact.contact_radius, contact.tangential_compliance),
          .shape_exponent = kMindlinShapeExponent,
          .slip_force = contact.slip_force,
          .gross_slip_displacement = GrossSlipDisplacement(contact)};
}

HertzMindlinContact SolveHertzMindlin(const Body& body_1, const Body& body_2, double normal_load,
                                      double friction_coefficient) {
  HertzMindlinContact contact;
  contact.effective_modulus = EffectiveModulus(body_1, body_2);
  contact.tangential_compliance = TangentialCompliance(body_1, body_2);
  contact.equivalent_radius = EquivalentRadius(body_1.radius, body_2.radius);
  contact.contact_radius =
      HertzContactRadius(normal_load, contact.equivalent_radius, contact.effective_modulus);
  contact.maximum_pressure = HertzMaximumPressure(normal_load, contact.contact_radius);
  contact.approach = HertzApproach(contact.contact_radius, contact.equivalent_radius);
  contact.dahl = MapMindlinToDahl({contact.contact_radius, contact.tangential_compliance,
                                   GrossSlipForce(friction_coefficient, normal_load)});
  return contact;
}

IdentifiedContact IdentifyContact(const UncertainValue& tangential_stiffness,
                                  const UncertainValue& slip_force, const KnownContact& known) {
  RequireUncertain("tangential stiffness", "N/m", tangential_stiffness);
  RequireUncertain("slip force", "N", slip_force);
  RequireKnown(known);

  IdentifiedContact identified;
  const Derived derived = DeriveFromKnown(known, identified.redundant);

  if (known.normal_load) {
    identified.friction_coefficient =
        Propagate(slip_force.value / *known.normal_load, 1, slip_force);
  }
  if (derived.tangential_compliance) {
    identified.contact_radius =
        Propagate(0.125 * tangential_stiffness.value * *derived.tangential_compliance, 1,
                  tangential_stiffness);
  }
  if (known.contact_radius) {
    identified.tangential_compliance = Propagate(
        8.0 * *known.contact_radius / tangential_stiffness.value, -1, tangential_stiffness);
  }

  // A radius that was measured otherwise is not uncertain here.
  const std::optional<UncertainValue> contact_radius =
      known.contact_radius ? UncertainValue{*known.contact_radius, 0.0} : identified.contact_radius;
  if (contact_radius && known.normal_load) {
    identified.maximum_pressure = Propagate(
        HertzMaximumPressure(*known.normal_load, contact_radius->value), -2, *contact_radius);
    if (derived.effective_modulus) {
      identified.equivalent_radius =
          Propagate(HertzEquivalentRadius(*known.normal_load, contact_radius->value,
                                          *derived.effective_modulus),
                    3, *contact_radius);
    }
  }
  if (known.contact_radius && derived.tangential_compliance) {
    identified.sigma_over_mindlin = Propagate(
        tangential_stiffness.value /
            MindlinTangentialStiffness(*known.contact_radius, *derived.tangential_compliance),
        1, tangential_stiffness);
  }
  if (known.normal_load && derived.equivalent_radius && derived.effective_modulus) {
    identified.hertz =
        Predict(tangential_stiffness, slip_force, *known.normal_load, *derived.equivalent_radius,
                *derived.effective_modulus, *derived.tangential_compliance);
    if (known.contact_radius) {
      identified.redundant.push_back(fmt::format(
          "contact radius is given as {:.6g} m and is {:.6g} m from Hertz "
          "(given/derived = {:.6g}): the given value is used, Hertz's for the prediction",
          *known.contact_radius, identified.hertz->contact_radius,
          *known.contact_radius / identified.hertz->contact_radius));
    }
  }
  identified.unidentified = Unidentified(known, derived, identified);
  return identified;
}

}  // namespace mindahl
