#include "mindahl/contact/shape_under_load.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "contact/known_contact.h"
#include "mindahl/core/error.h"

namespace mindahl::contact {
namespace {

/// A stiffness under a load, and what of the contact is known.
struct Question {
  const KnownContact& known;
  Quantity stiffness;
  Quantity load;
};

Quantity Compliance(const KnownContact& known) {
  return known.tangential_compliance ? Independent(*known.tangential_compliance, kCompliance)
                                     : TangentialComplianceOf(known);
}

bool HasElasticBodies(const KnownContact& known) {
  return IsElastic(known.body_1) && IsElastic(known.body_2);
}

bool KnowsCompliance(const KnownContact& known) {
  return known.tangential_compliance.has_value() || HasElasticBodies(known);
}

/// Returns a = σG*/8.
Quantity ContactRadiusOf(const Quantity& stiffness, const Quantity& compliance) {
  return Product(0.125 * stiffness.value * compliance.value, {{stiffness}, {compliance}});
}

/// Returns 1 or 2, the body whose E is unknown while all else is known; else 0.
int BodyOfUnknownModulus(const KnownContact& known) {
  if (!known.body_1.poisson_ratio || !known.body_2.poisson_ratio) return 0;
  if (known.body_1.youngs_modulus.has_value() == known.body_2.youngs_modulus.has_value()) return 0;
  return known.body_1.youngs_modulus ? 2 : 1;
}

/// Returns ν of both bodies, where it is one.
const UncertainValue* CommonPoissonRatio(const KnownContact& known) {
  const std::optional<UncertainValue>& first = known.body_1.poisson_ratio;
  const std::optional<UncertainValue>& second = known.body_2.poisson_ratio;
  if (!first || !second || first->value != second->value) return nullptr;
  return first->standard_error > second->standard_error ? &*first : &*second;
}

std::optional<UncertainValue>& ModulusOf(KnownContact& known, int body) {
  return body == 1 ? known.body_1.youngs_modulus : known.body_2.youngs_modulus;
}

/// σ of Hertz's contact, over which E a body has.
class StiffnessOverModulus {
 public:
  StiffnessOverModulus(const Question& question, const Quantity& equivalent_radius, int body)
      : known_(question.known),
        load_(question.load.value),
        radius_(equivalent_radius.value),
        body_(body) {}

  double operator()(double modulus) const {
    KnownContact known = known_;
    ModulusOf(known, body_) = modulus;
    const double contact_radius =
        HertzContactRadius(load_, radius_, EffectiveModulusOf(known).value);
    return MindlinTangentialStiffness(contact_radius, TangentialComplianceOf(known).value);
  }

 private:
  KnownContact known_;
  double load_;
  double radius_;
  int body_;
};

/// Returns E [Pa] of a body by its stiffness, which grows with it; empty where it would have to be
/// more than rigid.
std::optional<double> ModulusOfStiffness(const StiffnessOverModulus& stiffness, double target,
                                         double other_modulus) {
  // Beyond these times the other body's a body is rigid, or as soft as none, to every digit.
  constexpr double kFarther = 1e18;
  const auto excess = [&](double log_modulus) {
    return std::log(stiffness(std::exp(log_modulus)) / target);
  };
  double lower = std::log(other_modulus / kFarther);
  double upper = std::log(other_modulus * kFarther);
  const double at_lower = excess(lower);
  const double at_upper = excess(upper);
  if (!(at_lower < 0) || !(at_upper > 0)) return std::nullopt;
  std::uintmax_t most = 200;
  const auto bracket = boost::math::tools::toms748_solve(
      excess, lower, upper, at_lower, at_upper, boost::math::tools::eps_tolerance<double>(), most);
  return std::exp(std::midpoint(bracket.first, bracket.second));
}

/// Identifies G*, E* and the unknown E of a sphere of known radius whose other modulus is known.
void IdentifyModulus(const Question& question, const Quantity& equivalent_radius, int body,
                     ShapeUnderLoad& shape) {
  KnownContact known = question.known;
  const std::optional<UncertainValue> other = ModulusOf(known, 3 - body);
  if (!other) return;
  const std::optional<double> modulus =
      ModulusOfStiffness(StiffnessOverModulus(question, equivalent_radius, body),
                         question.stiffness.value, other->value);
  if (!modulus) {
    shape.unidentified = fmt::format(
        "no Young's modulus of body {} makes the contact this stiff: it is stiffer than with a "
        "rigid body",
        body);
    return;
  }
  // With a relative error of 1 changes are derivatives by ln E, which follows from the rest:
  // ln σ = (ln N + ln ρ − ln E*)/3 − ln G*.
  ModulusOf(known, body) = UncertainValue{*modulus, *modulus};
  const Source place = body == 1 ? kYoungsModulus1 : kYoungsModulus2;
  Quantity compliance = TangentialComplianceOf(known);
  Quantity effective = EffectiveModulusOf(known);
  const double compliance_slope = std::exchange(compliance.change.at(place), 0.0);
  const double effective_slope = std::exchange(effective.change.at(place), 0.0);
  Quantity youngs{.value = *modulus};
  for (std::size_t s = 0; s < kSourceCount; ++s) {
    const double change =
        (question.load.change[s] + equivalent_radius.change[s] - effective.change[s]) / 3 -
        compliance.change[s] - question.stiffness.change[s];
    youngs.change[s] = change / (effective_slope / 3 + compliance_slope);
    compliance.change[s] += compliance_slope * youngs.change[s];
    effective.change[s] += effective_slope * youngs.change[s];
  }
  shape.youngs_modulus = Total(youngs);
  shape.body = body;
  shape.tangential_compliance = Total(compliance);
  shape.effective_modulus = Total(effective);
  shape.contact_radius = Total(ContactRadiusOf(question.stiffness, compliance));
}

/// G* and E* of a sphere of known radius, where all that is known of the materials is one ν.
void IdentifyMaterials(const Question& question, const Quantity& equivalent_radius,
                       const UncertainValue& poisson_ratio, ShapeUnderLoad& shape) {
  const double nu = poisson_ratio.value;
  Quantity product{.value = 2 * (2 - nu) / (1 - nu)};  // G*E*
  // How the two ν share in it depends on the moduli: the larger error stands for both.
  product.change[kPoissonRatio1] = poisson_ratio.standard_error / ((1 - nu) * (2 - nu));
  constexpr double kSquareRoot = 2.0;
  const Quantity compliance = Product(
      std::sqrt(384 * question.load.value * equivalent_radius.value / product.value /
                std::pow(question.stiffness.value, 3)),
      {{question.load}, {equivalent_radius}, {product, -1}, {question.stiffness, -3}}, kSquareRoot);
  shape.tangential_compliance = Total(compliance);
  shape.effective_modulus =
      Total(Product(product.value / compliance.value, {{product}, {compliance, -1}}));
  shape.contact_radius = Total(ContactRadiusOf(question.stiffness, compliance));
}

ShapeUnderLoad Sphere(const Question& question) {
  const KnownContact& known = question.known;
  ShapeUnderLoad sphere;
  const bool knows_radius = known.body_1.radius && known.body_2.radius;
  std::optional<Quantity> equivalent_radius;
  if (knows_radius) {
    equivalent_radius =
        EquivalentRadiusOf(Present(known.body_1.radius), Present(known.body_2.radius));
  }
  if (KnowsCompliance(known)) {
    const Quantity radius = ContactRadiusOf(question.stiffness, Compliance(known));
    sphere.contact_radius = Total(radius);
    if (HasElasticBodies(known)) {
      const Quantity effective = EffectiveModulusOf(known);
      sphere.equivalent_radius =
          Total(Product(HertzEquivalentRadius(question.load.value, radius.value, effective.value),
                        {{effective}, {radius, 3}, {question.load, -1}}));
    } else if (equivalent_radius) {
      sphere.effective_modulus = Total(
          Product(0.75 * question.load.value * equivalent_radius->value / std::pow(radius.value, 3),
                  {{question.load}, {*equivalent_radius}, {radius, -3}}));
    } else {
      sphere.unidentified = fmt::format(
          "the equivalent radius needs {}; the effective modulus needs {}",
          fmt::join(MissingElasticConstants(known), ", "), fmt::join(MissingRadii(known), ", "));
    }
    return sphere;
  }
  const int body = BodyOfUnknownModulus(known);
  const UncertainValue* const poisson_ratio = CommonPoissonRatio(known);
  const bool knows_neither = !known.body_1.youngs_modulus && !known.body_2.youngs_modulus;
  const bool knows_materials = body != 0 || (poisson_ratio != nullptr && knows_neither);
  if (equivalent_radius && body != 0) {
    IdentifyModulus(question, *equivalent_radius, body, sphere);
  } else if (equivalent_radius && knows_materials) {
    IdentifyMaterials(question, *equivalent_radius, *poisson_ratio, sphere);
  } else {
    std::vector<std::string> missing = MissingRadii(known);
    if (!knows_materials) {
      missing.emplace_back("one Poisson ratio for both bodies (or E of one and ν of both)");
    }
    sphere.unidentified =
        fmt::format("the equivalent radius needs {}; the tangential compliance needs {}",
                    fmt::join(MissingElasticConstants(known), ", "), fmt::join(missing, ", "));
  }
  return sphere;
}

ShapeUnderLoad Cone(const Question& question) {
  ShapeUnderLoad cone;
  if (KnowsCompliance(question.known)) {
    const Quantity radius = ContactRadiusOf(question.stiffness, Compliance(question.known));
    cone.contact_radius = Total(radius);
    if (HasElasticBodies(question.known)) {
      const Quantity effective = EffectiveModulusOf(question.known);
      cone.slope =
          Total(Product(2 * question.load.value /
                            (std::numbers::pi * effective.value * radius.value * radius.value),
                        {{question.load}, {effective, -1}, {radius, -2}}));
    }
  }
  if (!cone.slope) {
    cone.unidentified = fmt::format("the slope of the cone needs {}",
                                    fmt::join(MissingElasticConstants(question.known), ", "));
  }
  return cone;
}

ShapeUnderLoad FlatPunch(const Question& question) {
  ShapeUnderLoad punch;
  if (KnowsCompliance(question.known)) {
    punch.contact_radius = Total(ContactRadiusOf(question.stiffness, Compliance(question.known)));
  } else {
    punch.unidentified = fmt::format(
        "the radius of the punch needs the tangential compliance (or, to derive it: {})",
        fmt::join(MissingElasticConstants(question.known), ", "));
  }
  return punch;
}

}  // namespace

ShapeUnderLoad IdentifyShape(ContactShape shape, const UncertainValue& stiffness,
                             const KnownContact& known) {
  RequireFitted("tangential stiffness", "N/m", stiffness);
  RequireKnown(known);
  if (!known.normal_load) {
    throw InvalidArgument("a shape under load needs the normal load: must be known");
  }
  const Question question{.known = known,
                          .stiffness = Independent(stiffness, kStiffness),
                          .load = Independent(*known.normal_load, kNormalLoad)};
  switch (shape) {
    case ContactShape::kSphere:
      return Sphere(question);
    case ContactShape::kCone:
      return Cone(question);
    case ContactShape::kFlatPunch:
      return FlatPunch(question);
    case ContactShape::kRough:
      break;
  }
  ShapeUnderLoad rough;
  rough.load_over_stiffness = Total(Product(question.load.value / question.stiffness.value,
                                            {{question.load}, {question.stiffness, -1}}));
  return rough;
}

}  // namespace mindahl::contact
