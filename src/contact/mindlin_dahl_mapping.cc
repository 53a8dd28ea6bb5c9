#include "mindahl/contact/mindlin_dahl_mapping.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "contact/known_contact.h"
#include "mindahl/core/error.h"

namespace mindahl::contact {

namespace {

Quantity HertzContactRadiusOf(const Quantity& normal_load, const Quantity& equivalent_radius,
                              const Quantity& effective_modulus) {
  constexpr double kCubeRoot = 3.0;
  return Product(
      HertzContactRadius(normal_load.value, equivalent_radius.value, effective_modulus.value),
      {{normal_load}, {equivalent_radius}, {effective_modulus, -1}}, kCubeRoot);
}

Quantity MaximumPressureOf(const Quantity& normal_load, const Quantity& contact_radius) {
  return Product(HertzMaximumPressure(normal_load.value, contact_radius.value),
                 {{normal_load}, {contact_radius, -2}});
}

Quantity TangentialStiffnessOf(const Quantity& contact_radius, const Quantity& compliance) {
  return Product(MindlinTangentialStiffness(contact_radius.value, compliance.value),
                 {{contact_radius}, {compliance, -1}});
}

Quantity GrossSlipDisplacementOf(const Quantity& contact_radius, const Quantity& compliance,
                                 const Quantity& slip_force) {
  return Product(GrossSlipDisplacement({contact_radius.value, compliance.value, slip_force.value}),
                 {{slip_force}, {compliance}, {contact_radius, -1}});
}

void Append(std::vector<std::string>& list, const std::vector<std::string>& more) {
  list.insert(list.end(), more.begin(), more.end());
}

std::string Needs(std::string_view quantity, const std::vector<std::string>& inputs) {
  return fmt::format("{} needs {}", quantity, fmt::join(inputs, ", "));
}

bool IsComplete(const KnownBody& body) { return IsElastic(body) && body.radius; }

/// Holds the quantities that follow from the known properties alone, without the fit.
struct Derived {
  std::optional<Quantity> normal_load;
  std::optional<Quantity> effective_modulus;
  std::optional<Quantity> tangential_compliance;
  std::optional<Quantity> equivalent_radius;
};

Derived DeriveFromKnown(const KnownContact& known, std::vector<std::string>& redundant) {
  Derived derived;
  if (known.normal_load) derived.normal_load = Independent(*known.normal_load, kNormalLoad);
  if (known.tangential_compliance) {
    derived.tangential_compliance = Independent(*known.tangential_compliance, kCompliance);
  }
  if (IsElastic(known.body_1) && IsElastic(known.body_2)) {
    derived.effective_modulus = EffectiveModulusOf(known);
    const Quantity of_materials = TangentialComplianceOf(known);
    if (known.tangential_compliance) {
      const double given = known.tangential_compliance->value;
      redundant.push_back(
          fmt::format("tangential compliance is given as {:.6g} 1/Pa and is {:.6g} 1/Pa from the "
                      "elastic constants (given/derived = {:.6g}): the given value is used",
                      given, of_materials.value, given / of_materials.value));
    } else {
      derived.tangential_compliance = of_materials;
    }
  }
  if (known.body_1.radius && known.body_2.radius) {
    derived.equivalent_radius =
        EquivalentRadiusOf(Present(known.body_1.radius), Present(known.body_2.radius));
  }
  return derived;
}

HertzPrediction Predict(const Quantity& stiffness, const Quantity& slip_force,
                        const Derived& derived, const Quantity& measured_gross_slip,
                        double correlation) {
  const Quantity radius =
      HertzContactRadiusOf(Present(derived.normal_load), Present(derived.equivalent_radius),
                           Present(derived.effective_modulus));
  const Quantity predicted = TangentialStiffnessOf(radius, Present(derived.tangential_compliance));
  const Quantity gross_slip =
      GrossSlipDisplacementOf(radius, Present(derived.tangential_compliance), slip_force);
  const auto ratio = [&](const Quantity& measured, const Quantity& other) {
    return Total(Product(measured.value / other.value, {{measured}, {other, -1}}), correlation);
  };
  // Tc cancels in the ratio of displacements, also where it is open: ∞ − ∞ would not.
  const Quantity inverse = Product(1.0, {{predicted}, {stiffness, -1}});
  return {.effective_modulus = Total(Present(derived.effective_modulus)),
          .equivalent_radius = Total(Present(derived.equivalent_radius)),
          .contact_radius = Total(radius),
          .maximum_pressure = Total(MaximumPressureOf(Present(derived.normal_load), radius)),
          .tangential_stiffness = Total(predicted),
          .gross_slip_displacement = Total(gross_slip, correlation),
          .sigma_over_hertz_mindlin = ratio(stiffness, predicted),
          .gross_slip_displacement_ratio =
              Total({measured_gross_slip.value / gross_slip.value, inverse.change}, correlation)};
}

/// Names the missing inputs from which the contact radius would follow with the loop.
std::string RadiusInputs(const KnownContact& known) {
  return fmt::format("the tangential compliance (or, to derive it: {})",
                     fmt::join(MissingElasticConstants(known), ", "));
}

std::vector<std::string> Unidentified(const KnownContact& known, const Derived& derived,
                                      const IdentifiedContact& identified) {
  std::vector<std::string> unidentified;
  const auto add = [&](std::string_view name, ContactQuantity quantity) {
    unidentified.push_back(Needs(name, MissingInputs(known, quantity)));
  };
  if (!identified.friction_coefficient) {
    add("friction coefficient", ContactQuantity::kFrictionCoefficient);
  }
  if (!known.contact_radius && !identified.contact_radius) {
    add("contact radius", ContactQuantity::kContactRadius);
    add("tangential compliance", ContactQuantity::kTangentialCompliance);
  }
  if (!identified.equivalent_radius) add("equivalent radius", ContactQuantity::kEquivalentRadius);
  if (!identified.maximum_pressure) add("maximum pressure", ContactQuantity::kMaximumPressure);
  if (known.contact_radius && !derived.tangential_compliance) {
    unidentified.push_back(
        Needs("comparison of the stiffness with the given contact radius", {RadiusInputs(known)}));
  }
  if (!identified.hertz) {
    // The elastic constants give the compliance too, and with it the contact radius.
    std::vector<std::string> inputs = MissingInputs(known, ContactQuantity::kEquivalentRadius);
    Append(inputs, MissingRadii(known));
    unidentified.push_back(Needs("Hertz prediction of the stiffness", inputs));
  }
  return unidentified;
}

}  // namespace

std::vector<std::string> MissingInputs(const KnownContact& known, ContactQuantity quantity) {
  const std::vector<std::string> elastic = MissingElasticConstants(known);
  const bool compliance_known = known.tangential_compliance || elastic.empty();
  std::vector<std::string> missing;
  const bool needs_load = quantity == ContactQuantity::kFrictionCoefficient ||
                          quantity == ContactQuantity::kEquivalentRadius ||
                          quantity == ContactQuantity::kMaximumPressure;
  if (needs_load && !known.normal_load) missing.emplace_back("the normal load");
  switch (quantity) {
    case ContactQuantity::kFrictionCoefficient:
      break;
    case ContactQuantity::kContactRadius:
      if (!compliance_known) missing.push_back(RadiusInputs(known));
      break;
    case ContactQuantity::kTangentialCompliance:
      if (!known.contact_radius) missing.emplace_back("the contact radius");
      break;
    case ContactQuantity::kEquivalentRadius:
      // The elastic constants give the compliance too, and with it the contact radius.
      Append(missing, elastic);
      break;
    case ContactQuantity::kMaximumPressure:
      if (!known.contact_radius && !compliance_known) {
        missing.push_back("the contact radius or " + RadiusInputs(known));
      }
      break;
  }
  return missing;
}

models::BranchLaw MapMindlinToDahl(const MindlinContact& contact) {
  Validate(contact);
  return {.tangential_stiffness =
              MindlinTangentialStiffness(contact.contact_radius, contact.tangential_compliance),
          .shape_exponent = kMindlinShapeExponent,
          .slip_force = contact.slip_force};
}

double PropagatedValue::FitShare() const {
  if (std::isinf(fit_error)) return 1.0;
  if (standard_error == 0.0) return 0.0;
  return (fit_error / standard_error) * (fit_error / standard_error);
}

double PropagatedValue::InputShare() const {
  return standard_error == 0.0 ? 0.0 : 1.0 - FitShare();
}

PredictedContact PredictContact(const KnownContact& known,
                                const UncertainValue& friction_coefficient) {
  RequireKnown(known);
  RequireKnown("friction coefficient [-]", friction_coefficient);
  const bool by_radius = known.contact_radius && known.tangential_compliance;
  const bool by_bodies = IsComplete(known.body_1) && IsComplete(known.body_2);
  if (!known.normal_load || by_radius == by_bodies) {
    throw InvalidArgument(
        "contact: must be given by its normal load and either contact radius and tangential "
        "compliance or E, ν and R of both bodies");
  }

  PredictedContact predicted;
  const Quantity load = Independent(*known.normal_load, kNormalLoad);
  Quantity compliance;
  Quantity radius;
  if (by_radius) {
    compliance = Independent(*known.tangential_compliance, kCompliance);
    radius = Independent(*known.contact_radius, kContactRadius);
  } else {
    compliance = TangentialComplianceOf(known);
    const Quantity effective_modulus = EffectiveModulusOf(known);
    const Quantity equivalent_radius =
        EquivalentRadiusOf(Present(known.body_1.radius), Present(known.body_2.radius));
    radius = HertzContactRadiusOf(load, equivalent_radius, effective_modulus);
    predicted.effective_modulus = Total(effective_modulus);
    predicted.equivalent_radius = Total(equivalent_radius);
    predicted.approach = Total(Product(HertzApproach(radius.value, equivalent_radius.value),
                                       {{radius, 2}, {equivalent_radius, -1}}));
  }
  const Quantity slip_force = Product(GrossSlipForce(friction_coefficient.value, load.value),
                                      {{Independent(friction_coefficient, kFriction)}, {load}});
  predicted.tangential_compliance = Total(compliance);
  predicted.contact_radius = Total(radius);
  predicted.maximum_pressure = Total(MaximumPressureOf(load, radius));
  predicted.tangential_stiffness = Total(TangentialStiffnessOf(radius, compliance));
  predicted.slip_force = Total(slip_force);
  predicted.gross_slip_displacement =
      Total(GrossSlipDisplacementOf(radius, compliance, slip_force));
  return predicted;
}

IdentifiedContact IdentifyContact(const UncertainValue& tangential_stiffness,
                                  const UncertainValue& slip_force, const KnownContact& known,
                                  double correlation) {
  RequireFitted("tangential stiffness", "N/m", tangential_stiffness);
  RequireFitted("slip force", "N", slip_force);
  RequireKnown(known);
  if (!(std::abs(correlation) <= 1.0)) {
    ThrowInvalid("correlation of tangential stiffness and slip force [-]", correlation,
                 "must be >= -1 and <= 1");
  }

  IdentifiedContact identified;
  const Derived derived = DeriveFromKnown(known, identified.redundant);
  const Quantity stiffness = Independent(tangential_stiffness, kStiffness);
  const Quantity force = Independent(slip_force, kSlipForce);
  const Quantity gross_slip =
      Product(1.5 * force.value / stiffness.value, {{force}, {stiffness, -1}});
  identified.gross_slip_displacement = Total(gross_slip, correlation);

  if (derived.normal_load) {
    const long double ratio = static_cast<long double>(force.value) / derived.normal_load->value;
    identified.friction_coefficient = Total(Product(InRange("friction coefficient [-]", ratio),
                                                    {{force}, {Present(derived.normal_load), -1}}));
  }
  std::optional<Quantity> measured_radius;
  if (derived.tangential_compliance) {
    measured_radius = Product(0.125 * stiffness.value * derived.tangential_compliance->value,
                              {{stiffness}, {Present(derived.tangential_compliance)}});
    identified.contact_radius = Total(*measured_radius);
  }
  std::optional<Quantity> given_radius;
  if (known.contact_radius) {
    given_radius = Independent(*known.contact_radius, kContactRadius);
    identified.tangential_compliance = Total(
        Product(8.0 * given_radius->value / stiffness.value, {{*given_radius}, {stiffness, -1}}));
  }

  const std::optional<Quantity>& radius = given_radius ? given_radius : measured_radius;
  if (radius && derived.normal_load) {
    identified.maximum_pressure = Total(MaximumPressureOf(Present(derived.normal_load), *radius));
    if (derived.effective_modulus) {
      identified.equivalent_radius =
          Total(Product(HertzEquivalentRadius(derived.normal_load->value, radius->value,
                                              derived.effective_modulus->value),
                        {{Present(derived.effective_modulus)},
                         {*radius, 3},
                         {Present(derived.normal_load), -1}}));
    }
  }
  if (given_radius && derived.tangential_compliance) {
    const Quantity predicted =
        TangentialStiffnessOf(*given_radius, Present(derived.tangential_compliance));
    identified.sigma_over_mindlin =
        Total(Product(stiffness.value / predicted.value, {{stiffness}, {predicted, -1}}));
  }
  if (derived.normal_load && derived.equivalent_radius && derived.effective_modulus) {
    identified.hertz = Predict(stiffness, force, derived, gross_slip, correlation);
    if (known.contact_radius) {
      const double given = known.contact_radius->value;
      const double of_hertz = identified.hertz->contact_radius.value;
      identified.redundant.push_back(fmt::format(
          "contact radius is given as {:.6g} m and is {:.6g} m from Hertz "
          "(given/derived = {:.6g}): the given value is used, Hertz's for the prediction",
          given, of_hertz, given / of_hertz));
    }
  }
  identified.unidentified = Unidentified(known, derived, identified);
  return identified;
}

namespace {

constexpr double kSoftestModulus = 1e6;     // [Pa]
constexpr double kStiffestModulus = 2e12;   // [Pa]
constexpr double kLargestCompliance = 1.0;  // [1/Pa]
constexpr double kLargestFriction = 5.0;    // [-]
constexpr double kLargestRadiusShare = 1.0 / 3.0;

double SmallestRadius(const KnownContact& known) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const KnownBody* body : {&known.body_1, &known.body_2}) {
    if (body->radius) smallest = std::min(smallest, std::abs(body->radius->value));
  }
  return smallest;
}

/// Returns Hertz's contact radius [m] where materials, radii and load are known.
std::optional<double> HertzRadius(const KnownContact& known) {
  if (!known.normal_load || !IsComplete(known.body_1) || !IsComplete(known.body_2)) {
    return std::nullopt;
  }
  const KnownContact bodies{
      .normal_load = known.normal_load, .body_1 = known.body_1, .body_2 = known.body_2};
  return PredictContact(bodies, 1.0).contact_radius.value;
}

}  // namespace

std::vector<std::string> DoubtsAbout(const KnownContact& known,
                                     std::optional<double> friction_coefficient,
                                     std::optional<double> fitted_radius) {
  std::vector<std::string> doubts;
  if (known.tangential_compliance && known.tangential_compliance->value > kLargestCompliance) {
    doubts.push_back(fmt::format(
        "compliance G* = {:.4g} 1/Pa is above that of any solid ({:g}): many texts write G* for "
        "its inverse, a modulus; give {:.4g} if so",
        known.tangential_compliance->value, kLargestCompliance,
        1 / known.tangential_compliance->value));
  }
  int number = 1;
  for (const KnownBody* body : {&known.body_1, &known.body_2}) {
    if (body->youngs_modulus && body->youngs_modulus->value < kSoftestModulus) {
      doubts.push_back(
          fmt::format("Young's modulus of body {} = {:.4g} Pa is below 1 MPa, softer than rubber: "
                      "give it in Pa, as 210e9",
                      number, body->youngs_modulus->value));
    }
    if (body->youngs_modulus && body->youngs_modulus->value > kStiffestModulus) {
      doubts.push_back(fmt::format(
          "Young's modulus of body {} = {:.4g} Pa is above 2 TPa, stiffer than diamond: "
          "give it in Pa, as 210e9",
          number, body->youngs_modulus->value));
    }
    ++number;
  }
  const std::optional<double> given =
      known.contact_radius ? std::optional<double>(known.contact_radius->value) : std::nullopt;
  const double radius = SmallestRadius(known);
  for (const std::optional<double>& contact_radius : {given, fitted_radius, HertzRadius(known)}) {
    if (!contact_radius || !(*contact_radius > kLargestRadiusShare * radius)) continue;
    doubts.push_back(fmt::format(
        "contact radius a = {:.4g} m is more than a third of the radius {:.4g} m of a body, beyond "
        "Hertz's theory: check load, radii, moduli and their units",
        *contact_radius, radius));
    break;
  }
  if (friction_coefficient && *friction_coefficient > kLargestFriction) {
    doubts.push_back(
        fmt::format("friction coefficient mu = {:.4g} is above {:g}: check the normal load, the "
                    "force and their units",
                    *friction_coefficient, kLargestFriction));
  }
  return doubts;
}

}  // namespace mindahl::contact
