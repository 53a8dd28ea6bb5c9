#include "cli/law_options.h"

#include <fmt/format.h>

#include "mindahl/core/error.h"
#include "mindahl/request/contact_parameters.h"

namespace mindahl::cli {

using models::BranchLaw;

void AddLawOptions(CLI::App& command, LawOptions& options) {
  const std::string parameters = "Parameters";
  AddOptional(command, "--sigma", options.sigma, "tangential stiffness sigma [N/m]", "N/M")
      ->group(parameters);
  AddOptional(command, "--alpha", options.alpha,
              "shape exponent [-], default 1/3 where the model leaves it free", "ALPHA")
      ->group(parameters);
  AddOptional(command, "--slip-force", options.slip_force, "slip force Tc [N]", "N")
      ->group(parameters);
  AddContactOptions(command, options.contact);
  AddFrictionOption(command, options.contact);
}

bool IsAnythingGiven(const LawOptions& options) {
  return options.sigma || options.slip_force || IsAnythingGiven(options.contact);
}

void Validate(const LawOptions& options) { Validate(options.contact); }

BranchLaw ResolveLaw(const LawOptions& options) {
  const bool by_parameters = options.sigma || options.slip_force;
  const bool by_contact = IsAnythingGiven(options.contact);
  if (by_parameters && by_contact) {
    throw InputError(
        "--sigma and --slip-force exclude --friction, --normal-load and whatever else describes a "
        "contact: give one of the two");
  }
  BranchLaw law;
  if (by_contact) {
    law = ResolveContact(options.contact).law;
  } else if (options.sigma && options.slip_force) {
    law = {.tangential_stiffness = *options.sigma, .slip_force = *options.slip_force};
  } else {
    throw InputError(fmt::format(
        "{} missing: give --sigma and --slip-force, or a contact (--friction, --normal-load, "
        "--contact-radius, --compliance or materials and radii)",
        options.sigma ? "--slip-force" : "--sigma"));
  }
  if (options.alpha) law.shape_exponent = *options.alpha;
  Validate(law);
  return law;
}

BranchLaw ResolveLaw(const LawOptions& options, std::string_view model,
                     std::optional<double> prescribed_exponent) {
  BranchLaw law = ResolveLaw(options);
  if (!prescribed_exponent) return law;
  if (options.alpha && *options.alpha != *prescribed_exponent) {
    throw InputError(fmt::format(
        "--alpha {} contradicts --model {}, whose alpha is {}: use --model mindlin-dahl",
        *options.alpha, model, *prescribed_exponent));
  }
  law.shape_exponent = *prescribed_exponent;
  return law;
}

std::string LawArguments(const BranchLaw& law) {
  return fmt::format("--sigma {} --alpha {} --slip-force {}", law.tangential_stiffness,
                     law.shape_exponent, law.slip_force);
}

}  // namespace mindahl::cli
