#include "mindahl/request/contact_request.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "mindahl/core/error.h"

namespace mindahl::request {

using contact::KnownBody;
using contact::UncertainValue;

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

}  // namespace mindahl::request
