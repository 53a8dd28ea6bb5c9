#include "contact/known_contact.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "mindahl/core/error.h"

namespace mindahl::contact {

namespace {

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

}  // namespace

Quantity Independent(const UncertainValue& source, Source place) {
  Quantity quantity{.value = source.value};
  quantity.change[place] = source.standard_error / source.value;
  return quantity;
}

Quantity Product(double value, std::initializer_list<Factor> factors, double root) {
  Quantity product{.value = value};
  for (const Factor& factor : factors) {
    for (std::size_t source = 0; source < kSourceCount; ++source) {
      product.change[source] += factor.power / root * factor.quantity.change[source];
    }
  }
  return product;
}

PropagatedValue Total(const Quantity& quantity, double correlation) {
  const double by_stiffness = quantity.change[kStiffness];
  const double by_slip_force = quantity.change[kSlipForce];
  // The square of the sum, with the correlation split so that nothing is subtracted under the root.
  // An interval that the fit leaves open stays open: its correlation says nothing.
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

namespace {

void RequireStandardError(std::string_view quantity, double standard_error) {
  RequireNonNegative(fmt::format("standard uncertainty of the {}", quantity), standard_error);
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

/// Makes a body for functions that do not read the radius.
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

}  // namespace

void RequireKnown(std::string_view quantity, const std::optional<UncertainValue>& known) {
  if (!known) return;
  RequirePositive(quantity, known->value);
  RequireStandardError(quantity, known->standard_error);
}

void RequireKnown(const KnownContact& known) {
  RequireKnown("normal load [N]", known.normal_load);
  RequireKnown("contact radius [m]", known.contact_radius);
  RequireKnown("tangential compliance [1/Pa]", known.tangential_compliance);
  RequireBody(known.body_1, 1);
  RequireBody(known.body_2, 2);
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

Quantity EquivalentRadiusOf(const UncertainValue& radius_1, const UncertainValue& radius_2) {
  Quantity radius{.value = EquivalentRadius(radius_1.value, radius_2.value)};
  const auto change = [&](const UncertainValue& one) {
    return radius.value / one.value * (one.standard_error / one.value);
  };
  radius.change[kRadius1] = change(radius_1);
  radius.change[kRadius2] = change(radius_2);
  return radius;
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

}  // namespace mindahl::contact
