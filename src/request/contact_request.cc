#include "mindahl/request/contact_request.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "mindahl/contact/mindlin_dahl_mapping.h"
#include "mindahl/core/error.h"

namespace mindahl::request {

using contact::KnownBody;
using contact::UncertainValue;
using models::BranchLaw;

namespace {

void RequireBody(const KnownBody& body, int number) {
  if (body.youngs_modulus) {
    RequirePositive(fmt::format("--youngs-modulus-{} [Pa]", number), body.youngs_modulus->value);
  }
  if (body.poisson_ratio && !(body.poisson_ratio->value > -1 && body.poisson_ratio->value <= 0.5)) {
    ThrowInvalid(fmt::format("--poisson-{} [-]", number), body.poisson_ratio->value,
                 "must be > -1 and <= 0.5");
  }
  if (!body.radius) return;
  const auto [radius, uncertainty] = std::pair{body.radius->value, body.radius->standard_error};
  if (std::isnan(radius) || radius == 0) {
    ThrowInvalid(fmt::format("--radius-{} [m]", number), radius,
                 "must be a number other than 0; inf is a plane");
  }
  if (std::isinf(radius) && uncertainty > 0) {
    throw InputError(fmt::format(
        "--radius-{}: the standard uncertainty {} of a plane is invalid: a plane is exact, write "
        "{}",
        number, uncertainty, radius));
  }
}

void CollectMissing(const contact::KnownBody& body, int number, std::vector<std::string>& missing) {
  if (!body.youngs_modulus) missing.push_back(fmt::format("--youngs-modulus-{}", number));
  if (!body.poisson_ratio) missing.push_back(fmt::format("--poisson-{}", number));
  if (!body.radius) missing.push_back(fmt::format("--radius-{}", number));
}

[[noreturn]] void ThrowMissing(const std::vector<std::string>& missing) {
  throw InputError(fmt::format(
      "{} missing: a contact needs --friction, --normal-load and either --contact-radius with "
      "--compliance or --youngs-modulus-1, --poisson-1, --radius-1 and the same of body 2",
      fmt::join(missing, ", ")));
}

}  // namespace

void SetNormalLoads(ContactOptions& options, std::span<const UncertainValue> loads) {
  double sum = 0.0;
  double variance = 0.0;
  for (const UncertainValue& load : loads) {
    RequirePositive("--normal-load [N]", load.value);
    sum += load.value;
    variance += load.standard_error * load.standard_error;
  }
  options.normal_loads.assign(loads.begin(), loads.end());
  options.known.normal_load.reset();
  if (loads.empty()) return;
  const auto count = static_cast<double>(loads.size());
  options.known.normal_load = UncertainValue{sum / count, std::sqrt(variance) / count};
}

bool IsAnythingGiven(const ContactOptions& options) {
  const contact::KnownContact& known = options.known;
  const auto body_given = [](const KnownBody& body) {
    return body.youngs_modulus || body.poisson_ratio || body.radius;
  };
  return options.friction_coefficient || known.normal_load || known.contact_radius ||
         known.tangential_compliance || body_given(known.body_1) || body_given(known.body_2);
}

void Validate(const ContactOptions& options) {
  const auto require_positive = [](const char* option, const std::optional<UncertainValue>& known) {
    if (known) RequirePositive(option, known->value);
  };
  require_positive("--normal-load [N]", options.known.normal_load);
  require_positive("--contact-radius [m]", options.known.contact_radius);
  require_positive("--compliance [1/Pa]", options.known.tangential_compliance);
  require_positive("--friction [-]", options.friction_coefficient);
  RequireBody(options.known.body_1, 1);
  RequireBody(options.known.body_2, 2);
}

contact::PredictedContact ResolveContact(const ContactOptions& options) {
  const contact::KnownContact& known = options.known;
  std::vector<std::string> missing;
  if (!options.friction_coefficient) missing.emplace_back("--friction");
  if (!known.normal_load) missing.emplace_back("--normal-load");
  const bool by_radius = known.contact_radius || known.tangential_compliance;
  std::vector<std::string> missing_bodies;
  CollectMissing(known.body_1, 1, missing_bodies);
  CollectMissing(known.body_2, 2, missing_bodies);
  constexpr std::size_t kBodyOptions = 6;
  if (by_radius && missing_bodies.size() < kBodyOptions) {
    throw InputError(
        "a contact is described either by --contact-radius with --compliance or by the materials "
        "and radii of its bodies: give one of the two");
  }
  if (by_radius) {
    if (!known.contact_radius) missing.emplace_back("--contact-radius");
    if (!known.tangential_compliance) missing.emplace_back("--compliance");
  } else {
    missing.insert(missing.end(), missing_bodies.begin(), missing_bodies.end());
  }
  if (!options.friction_coefficient || !missing.empty()) ThrowMissing(missing);

  return contact::PredictContact(known, *options.friction_coefficient);
}

bool IsAnythingGiven(const LawRequest& request) {
  return request.sigma || request.slip_force || IsAnythingGiven(request.contact);
}

BranchLaw ResolveLaw(const LawRequest& request) {
  Validate(request.contact);
  const bool by_parameters = request.sigma || request.slip_force;
  const bool by_contact = IsAnythingGiven(request.contact);
  if (by_parameters && by_contact) {
    throw InputError(
        "--sigma and --slip-force exclude --friction, --normal-load and other options that "
        "describe a contact: give one of the two");
  }
  BranchLaw law;
  if (by_contact) {
    const contact::PredictedContact predicted = ResolveContact(request.contact);
    law = {.tangential_stiffness = predicted.tangential_stiffness.value,
           .shape_exponent = contact::kMindlinShapeExponent,
           .slip_force = predicted.slip_force.value};
  } else if (request.sigma && request.slip_force) {
    law = {.tangential_stiffness = *request.sigma, .slip_force = *request.slip_force};
  } else {
    throw InputError(fmt::format(
        "{} missing: give --sigma and --slip-force, or a contact (--friction, --normal-load, "
        "--contact-radius, --compliance or materials and radii)",
        request.sigma ? "--slip-force" : "--sigma"));
  }
  if (request.alpha) law.shape_exponent = *request.alpha;
  Validate(law);
  return law;
}

BranchLaw ResolveLaw(const LawRequest& request, std::string_view model,
                     std::optional<double> prescribed_exponent) {
  BranchLaw law = ResolveLaw(request);
  if (!prescribed_exponent) return law;
  if (request.alpha && *request.alpha != *prescribed_exponent) {
    throw InputError(fmt::format(
        "--alpha {} contradicts --model {}, whose alpha is {}: use --model mindlin-dahl",
        *request.alpha, model, *prescribed_exponent));
  }
  law.shape_exponent = *prescribed_exponent;
  return law;
}

std::vector<std::string> DoubtsAbout(const ContactOptions& options) {
  std::optional<double> friction;
  if (options.friction_coefficient) friction = options.friction_coefficient->value;
  return contact::DoubtsAbout(options.known, friction);
}

}  // namespace mindahl::request
