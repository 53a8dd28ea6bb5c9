#include "mindahl/contact/mindlin_dahl_mapping.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <initializer_list>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "contact/body_requirements.h"
#include "mindahl/core/error.h"

namespace mindahl::contact {
namespace {

/// What may be uncertain: the fit's two, then the inputs.
enum Source : std::size_t {
  kStiffness,
  kSlipForce,
  kFriction,
  kNormalLoad,
  kYoungsModulus1,
  kPoissonRatio1,
  kRadius1,
  kYoungsModulus2,
  kPoissonRatio2,
  kRadius2,
  kContactRadius,
  kCompliance,
  kSourceCount
};

constexpr std::array<std::string_view, kSourceCount> kSourceNames = {"tangential stiffness",
                                                                     "slip force",
                                                                     "friction coefficient",
                                                                     "normal load",
                                                                     "Young's modulus of body 1",
                                                                     "Poisson ratio of body 1",
                                                                     "radius of body 1",
                                                                     "Young's modulus of body 2",
                                                                     "Poisson ratio of body 2",
                                                                     "radius of body 2",
                                                                     "contact radius",
                                                                     "tangential compliance"};

/// A quantity and, for each source, the relative change that one standard error of the source makes
/// in it, signed. Since every source has a place of its own, what enters twice is counted once.
struct Quantity {
  double value = 0.0;
  std::array<double, kSourceCount> change{};
};

Quantity Independent(const UncertainValue& source, Source place) {
  Quantity quantity{.value = source.value};
  quantity.change[place] = source.standard_error / source.value;
  return quantity;
}

struct Factor {
  const Quantity& quantity;
  int power = 1;
};

/// A product of powers, whose value is computed elsewhere: relative changes add, times the powers.
Quantity Product(double value, std::initializer_list<Factor> factors, double root = 1.0) {
  Quantity product{.value = value};
  for (const Factor& factor : factors) {
    for (std::size_t source = 0; source < kSourceCount; ++source) {
      product.change[source] += factor.power / root * factor.quantity.change[source];
    }
  }
  return product;
}

PropagatedValue Total(const Quantity& quantity, double correlation = 0.0) {
  const double by_stiffness = quantity.change[kStiffness];
  const double by_slip_force = quantity.change[kSlipForce];
  // The square of the sum, with the correlation split so that nothing is subtracted under the root.
  // What the fit leaves open stays so: its correlation says nothing.
  const bool open = std::isinf(by_stiffness) || std::isinf(by_slip_force);
  const double fit =
      open ? std::hypot(by_stiffness, by_slip_force)
           : std::hypot(by_stiffness + correlation * by_slip_force,
                        std::sqrt((1.0 - correlation) * (1.0 + correlation)) * by_slip_force);
  double inputs = 0.0;
  double largest = 0.0;
  PropagatedValue total;
  for (std::size_t source = kSlipForce + 1; source < kSourceCount; ++source) {
    const double change = std::abs(quantity.change[source]);
    inputs = std::hypot(inputs, change);
    if (change <= largest) continue;
    largest = change;
    total.largest_input = kSourceNames[source];
  }
  total.value = quantity.value;
  total.fit_error = quantity.value * fit;
  total.input_error = quantity.value * inputs;
  total.standard_error = std::hypot(total.fit_error, total.input_error);
  return total;
}

void RequireStandardError(std::string_view quantity, double standard_error) {
  RequireNonNegative(fmt::format("standard uncertainty of the {}", quantity), standard_error);
}

void RequireKnown(std::string_view quantity, const std::optional<UncertainValue>& known) {
  if (!known) return;
  RequirePositive(quantity, known->value);
  RequireStandardError(quantity, known->standard_error);
}

void RequireFitted(std::string_view quantity, std::string_view unit,
                   const UncertainValue& estimate) {
  RequirePositive(fmt::format("{} [{}]", quantity, unit), estimate.value);
  // Infinity is allowed: a fit may leave a parameter open.
  if (!(estimate.standard_error >= 0.0)) {
    ThrowInvalid(fmt::format("standard error of the {} [{}]", quantity, unit),
                 estimate.standard_error, "must be >= 0");
  }
}

void RequireBody(const KnownBody& body, int number) {
  RequireKnown(fmt::format("Young's modulus of body {} [Pa]", number), body.youngs_modulus);
  if (body.poisson_ratio) {
    const std::string quantity = fmt::format("Poisson ratio of body {}", number);
    RequirePoissonRatio(quantity, body.poisson_ratio->value);
    RequireStandardError(quantity, body.poisson_ratio->standard_error);
  }
  if (body.radius) {
    const std::string quantity = fmt::format("radius of body {} [m]", number);
    RequireSurfaceRadius(quantity, body.radius->value);
    RequireStandardError(quantity, body.radius->standard_error);
    if (std::isinf(body.radius->value) && body.radius->standard_error > 0.0) {
      ThrowInvalid(fmt::format("standard uncertainty of the {}", quantity),
                   body.radius->standard_error, "must be 0 for a plane, which is exact");
    }
  }
}

void RequireKnown(const KnownContact& known) {
  RequireKnown("normal load [N]", known.normal_load);
  RequireKnown("contact radius [m]", known.contact_radius);
  RequireKnown("tangential compliance [1/Pa]", known.tangential_compliance);
  RequireBody(known.body_1, 1);
  RequireBody(known.body_2, 2);
}

/// What the caller has found to be known.
template <typename Value>
const Value& Present(const std::optional<Value>& quantity) {
  if (!quantity) throw std::logic_error("a quantity of the contact that is needed is not known");
  return *quantity;
}

bool IsElastic(const KnownBody& body) { return body.youngs_modulus && body.poisson_ratio; }

/// For functions that do not read the radius.
Body Elastic(const KnownBody& body) {
  return {.youngs_modulus = Present(body.youngs_modulus),
          .poisson_ratio = Present(body.poisson_ratio)};
}

/// A material and the place of its errors.
struct Material {
  const KnownBody& body;
  Source youngs_modulus;
  Source poisson_ratio;
};

std::array<Material, 2> Materials(const KnownContact& known) {
  return {{{known.body_1, kYoungsModulus1, kPoissonRatio1},
           {known.body_2, kYoungsModulus2, kPoissonRatio2}}};
}

/// 1/E* = Σ (1 − ν²)/E
Quantity EffectiveModulusOf(const KnownContact& known) {
  Quantity modulus{.value = EffectiveModulus(Elastic(known.body_1), Elastic(known.body_2))};
  for (const Material& material : Materials(known)) {
    const UncertainValue& youngs_modulus = Present(material.body.youngs_modulus);
    const UncertainValue& poisson_ratio = Present(material.body.poisson_ratio);
    const double ratio = modulus.value / youngs_modulus.value;
    modulus.change[material.youngs_modulus] =
        ratio * (1.0 - poisson_ratio.value * poisson_ratio.value) *
        (youngs_modulus.standard_error / youngs_modulus.value);
    modulus.change[material.poisson_ratio] =
        ratio * 2.0 * poisson_ratio.value * poisson_ratio.standard_error;
  }
  return modulus;
}

/// G* = Σ 2(2 − ν)(1 + ν)/E
Quantity TangentialComplianceOf(const KnownContact& known) {
  Quantity compliance{.value = TangentialCompliance(Elastic(known.body_1), Elastic(known.body_2))};
  for (const Material& material : Materials(known)) {
    const UncertainValue& youngs_modulus = Present(material.body.youngs_modulus);
    const UncertainValue& poisson_ratio = Present(material.body.poisson_ratio);
    const double ratio = 2.0 / (youngs_modulus.value * compliance.value);
    compliance.change[material.youngs_modulus] =
        -ratio * (2.0 - poisson_ratio.value) * (1.0 + poisson_ratio.value) *
        (youngs_modulus.standard_error / youngs_modulus.value);
    compliance.change[material.poisson_ratio] =
        ratio * (1.0 - 2.0 * poisson_ratio.value) * poisson_ratio.standard_error;
  }
  return compliance;
}

/// 1/ρ = 1/R₁ + 1/R₂; a plane changes nothing.
Quantity EquivalentRadiusOf(const UncertainValue& radius_1, const UncertainValue& radius_2) {
  Quantity radius{.value = EquivalentRadius(radius_1.value, radius_2.value)};
  const auto change = [&](const UncertainValue& one) {
    return radius.value / one.value * (one.standard_error / one.value);
  };
  radius.change[kRadius1] = change(radius_1);
  radius.change[kRadius2] = change(radius_2);
  return radius;
}

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

/// What gives the contact radius from the loop, where it is missing.
std::string RadiusInputs(const KnownContact& known) {
  return fmt::format("the tangential compliance (or what gives it: {})",
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
  const auto is_complete = [](const KnownBody& body) { return IsElastic(body) && body.radius; };
  const bool by_radius = known.contact_radius && known.tangential_compliance;
  const bool by_bodies = is_complete(known.body_1) && is_complete(known.body_2);
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
    identified.friction_coefficient = Total(Product(force.value / derived.normal_load->value,
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

}  // namespace mindahl::contact
