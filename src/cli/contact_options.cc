#include "cli/contact_options.h"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "mindahl/core/error.h"

namespace mindahl::cli {
namespace {

constexpr const char* kGroup = "What is known of the contact";

void AddBodyOptions(CLI::App& command, KnownBody& body, int number) {
  AddOptional(command, fmt::format("--youngs-modulus-{}", number), body.youngs_modulus,
              fmt::format("Young's modulus of body {} [Pa]", number), "PA")
      ->group(kGroup);
  AddOptional(command, fmt::format("--poisson-{}", number), body.poisson_ratio,
              fmt::format("Poisson's ratio of body {} [-], in (-1, 0.5]", number), "NU")
      ->group(kGroup);
  AddOptional(command, fmt::format("--radius-{}", number), body.radius,
              fmt::format("radius of body {} [m]; inf is a plane, negative a concave seat", number),
              "M")
      ->group(kGroup);
}

void RequireBody(const KnownBody& body, int number) {
  if (body.youngs_modulus) {
    RequirePositive(fmt::format("--youngs-modulus-{} [Pa]", number), *body.youngs_modulus);
  }
  if (body.poisson_ratio && !(*body.poisson_ratio > -1 && *body.poisson_ratio <= 0.5)) {
    ThrowInvalid(fmt::format("--poisson-{} [-]", number), *body.poisson_ratio,
                 "must be > -1 and <= 0.5");
  }
  if (body.radius && (std::isnan(*body.radius) || *body.radius == 0)) {
    ThrowInvalid(fmt::format("--radius-{} [m]", number), *body.radius,
                 "must be a number other than 0; inf is a plane");
  }
}

}  // namespace

CLI::Option* AddOptional(CLI::App& command, const std::string& name, std::optional<double>& target,
                         const std::string& description, const std::string& unit) {
  return command.add_option(name, target, description)->type_name(unit);
}

void AddContactOptions(CLI::App& command, ContactOptions& options) {
  AddOptional(command, "--normal-load", options.known.normal_load, "normal load N [N]", "N")
      ->group(kGroup);
  AddBodyOptions(command, options.known.body_1, 1);
  AddBodyOptions(command, options.known.body_2, 2);
  AddOptional(command, "--contact-radius", options.known.contact_radius, "contact radius a [m]",
              "M")
      ->group(kGroup);
  AddOptional(command, "--compliance", options.known.tangential_compliance,
              "G* = (2-nu1)/G1 + (2-nu2)/G2 [1/Pa], a compliance (many texts write G* for its "
              "inverse)",
              "1/PA")
      ->group(kGroup);
}

void AddFrictionOption(CLI::App& command, ContactOptions& options) {
  AddOptional(command, "--friction", options.friction_coefficient, "friction coefficient mu [-]",
              "MU")
      ->group(kGroup);
}

bool IsAnythingGiven(const ContactOptions& options) {
  const KnownContact& known = options.known;
  const auto body_given = [](const KnownBody& body) {
    return body.youngs_modulus || body.poisson_ratio || body.radius;
  };
  return options.friction_coefficient || known.normal_load || known.contact_radius ||
         known.tangential_compliance || body_given(known.body_1) || body_given(known.body_2);
}

void Validate(const ContactOptions& options) {
  const auto require_positive = [](const char* option, const std::optional<double>& value) {
    if (value) RequirePositive(option, *value);
  };
  require_positive("--normal-load [N]", options.known.normal_load);
  require_positive("--contact-radius [m]", options.known.contact_radius);
  require_positive("--compliance [1/Pa]", options.known.tangential_compliance);
  require_positive("--friction [-]", options.friction_coefficient);
  RequireBody(options.known.body_1, 1);
  RequireBody(options.known.body_2, 2);
}

}  // namespace mindahl::cli
