#include "mindahl/request/contact_parameters.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <optional>

#include "mindahl/core/error.h"

namespace mindahl::request {
namespace {

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

ContactParameters ResolveContact(const ContactOptions& options) {
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

  const contact::PredictedContact predicted =
      contact::PredictContact(known, *options.friction_coefficient);
  ContactParameters result{.law = {.tangential_stiffness = predicted.tangential_stiffness.value,
                                   .shape_exponent = contact::kMindlinShapeExponent,
                                   .slip_force = predicted.slip_force.value},
                           .quantities = {}};
  const auto add = [&](const char* section, const char* name,
                       const std::optional<contact::UncertainValue>& value, const char* unit,
                       const char* meaning) {
    if (value) result.quantities.push_back({section, name, *value, unit, meaning});
  };
  add("contact", "friction_coefficient", options.friction_coefficient, "-", "mu");
  add("contact", "normal_load", known.normal_load, "N", "N");
  add("contact", "effective_modulus", predicted.effective_modulus, "Pa", "E*");
  add("contact", "equivalent_radius", predicted.equivalent_radius, "m", "rho");
  add("contact", "approach", predicted.approach, "m", "normal approach a^2/rho");
  add("contact", "compliance", predicted.tangential_compliance, "1/Pa",
      "G* = (2-nu1)/G1 + (2-nu2)/G2, a compliance");
  add("contact", "contact_radius", predicted.contact_radius, "m", "a");
  add("contact", "maximum_pressure", predicted.maximum_pressure, "Pa", "p0 = 3N/(2 pi a^2)");
  add("contact", "gross_slip_displacement", predicted.gross_slip_displacement, "m",
      "delta_c = 3 mu N G*/(16 a)");
  add("parameters", "sigma", predicted.tangential_stiffness, "N/m", "8a/G*");
  add("parameters", "alpha", contact::UncertainValue(contact::kMindlinShapeExponent), "-",
      "1/3, Mindlin");
  add("parameters", "slip_force", predicted.slip_force, "N", "Tc = mu N");
  return result;
}

}  // namespace mindahl::request
