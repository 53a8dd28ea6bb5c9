#include "mindahl/contact/plausibility.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace mindahl::contact {
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

bool IsComplete(const KnownBody& body) {
  return body.youngs_modulus && body.poisson_ratio && body.radius;
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
        "compliance G* = {:.4g} 1/Pa is that of no solid (above {:g}): many texts write G* for its "
        "inverse, a modulus; give {:.4g} if it is that",
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
        "contact radius a = {:.4g} m is more than a third of the radius {:.4g} m of a body, where "
        "Hertz's theory ends: look at load, radii, moduli and their units",
        *contact_radius, radius));
    break;
  }
  if (friction_coefficient && *friction_coefficient > kLargestFriction) {
    doubts.push_back(
        fmt::format("friction coefficient mu = {:.4g} is above {:g}: look at the normal load, the "
                    "force and their units",
                    *friction_coefficient, kLargestFriction));
  }
  return doubts;
}

}  // namespace mindahl::contact
