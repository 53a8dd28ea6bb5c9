#include "cli/contact_options.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "cli/options.h"
#include "core/text.h"
#include "io/cells.h"
#include "mindahl/core/error.h"
#include "mindahl/core/units.h"

namespace mindahl::cli {

using contact::KnownBody;
using contact::UncertainValue;

namespace {

constexpr const char* kGroup = "What is known of the contact";

/// Value and uncertainty, which is empty where there is no separator.
std::pair<std::string_view, std::optional<std::string_view>> SplitUncertainty(
    std::string_view text) {
  constexpr std::array<std::string_view, 3> kSeparators = {"±", "+/-", "+-"};
  for (const std::string_view separator : kSeparators) {
    const std::size_t at = text.find(separator);
    if (at != std::string_view::npos) {
      return {text.substr(0, at), text.substr(at + separator.size())};
    }
  }
  return {text, std::nullopt};
}

void AddKnown(CLI::App& command, const std::string& name, std::optional<UncertainValue>& target,
              const std::string& description, const std::string& unit, const std::string& type) {
  OptionGroup(command, kGroup)
      .AddRead(
          name,
          [&target, name, unit](const std::string& text) {
            target = ParseUncertainValue(text, name, unit);
          },
          description, type + "[+-U]");
}

/// "25,50±1%,100".
void ReadNormalLoads(const std::string& text, ContactOptions& options) {
  std::vector<UncertainValue> loads;
  for (const std::string_view load : PartsOf(text, ',')) {
    loads.push_back(ParseUncertainValue(load, "--normal-load", "N"));
  }
  SetNormalLoads(options, loads);
}

void AddBodyOptions(CLI::App& command, KnownBody& body, int number) {
  AddKnown(command, fmt::format("--youngs-modulus-{}", number), body.youngs_modulus,
           fmt::format("Young's modulus of body {} [Pa]", number), "Pa", "PA");
  AddKnown(command, fmt::format("--poisson-{}", number), body.poisson_ratio,
           fmt::format("Poisson's ratio of body {} [-], in (-1, 0.5]", number), "-", "NU");
  AddKnown(command, fmt::format("--radius-{}", number), body.radius,
           fmt::format("radius of body {} [m]; inf is a plane, negative a concave seat", number),
           "m", "M");
}

}  // namespace

UncertainValue ParseUncertainValue(std::string_view text, std::string_view option,
                                   std::string_view unit) {
  const auto [number, uncertainty] = SplitUncertainty(text);
  std::string stated(number);
  std::optional<double> standard_error = 0.0;
  bool is_percentage = false;
  if (uncertainty) {
    std::string_view magnitude = io::Trimmed(*uncertainty);
    is_percentage = magnitude.ends_with('%');
    if (is_percentage) magnitude.remove_suffix(1);
    // A unit at the end is that of the value too.
    if (io::Trimmed(number.substr(BeginOfUnit(number))).empty()) {
      stated += magnitude.substr(BeginOfUnit(magnitude));
    }
    standard_error = ParseQuantity(magnitude, is_percentage ? "-" : unit);
  }
  const std::optional<double> value = ParseQuantity(stated, unit);
  if (value && standard_error && is_percentage && std::isfinite(*value)) {
    *standard_error *= 0.01 * std::abs(*value);
  }
  if (standard_error && !(std::isfinite(*standard_error) && *standard_error >= 0)) {
    throw InputError(
        fmt::format("{}: the standard uncertainty in '{}' is {}: must be finite and >= 0; leave it "
                    "out where the value is exact",
                    option, text, *standard_error));
  }
  if (!value || !standard_error) {
    throw InputError(fmt::format(
        "{}: '{}' is not a number{}, nor one with its standard uncertainty: write 50, 50±0.5, "
        "50+-0.5, 50+/-0.5 or 50±1%",
        option, text, unit == "-" ? "" : fmt::format(" or a quantity in {}", unit)));
  }
  return {*value, *standard_error};
}

void AddContactOptions(CLI::App& command, ContactOptions& options, NormalLoads loads) {
  if (loads == NormalLoads::kOneAFile) {
    OptionGroup(command, kGroup)
        .AddRead(
            "--normal-load",
            [&options](const std::string& text) { ReadNormalLoads(text, options); },
            "normal load N [N], one for all files or one a file: 25,50,100; like\n"
            "all below exact, or with a standard uncertainty: 50±0.5, 50+-0.5,\n"
            "50+/-0.5, 50±1%",
            "N[+-U],...");
  } else {
    AddKnown(command, "--normal-load", options.known.normal_load,
             "normal load N [N]; like all below exact, or with a standard\n"
             "uncertainty: 50±0.5, 50+-0.5, 50+/-0.5, 50±1%",
             "N", "N");
  }
  AddBodyOptions(command, options.known.body_1, 1);
  AddBodyOptions(command, options.known.body_2, 2);
  AddKnown(command, "--contact-radius", options.known.contact_radius, "contact radius a [m]", "m",
           "M");
  AddKnown(command, "--compliance", options.known.tangential_compliance,
           "G* = (2-nu1)/G1 + (2-nu2)/G2 [1/Pa], a compliance (many texts write G* for its "
           "inverse)",
           "1/Pa", "1/PA");
}

void AddFrictionOption(CLI::App& command, ContactOptions& options) {
  AddKnown(command, "--friction", options.friction_coefficient, "friction coefficient mu [-]", "-",
           "MU");
}

void AddLawOptions(CLI::App& command, LawOptions& request) {
  const OptionGroup parameters(command, "Parameters");
  parameters.Add("--sigma", request.sigma, "tangential stiffness sigma [N/m]", "N/M")
      ->transform(InUnit("N/m"));
  parameters.Add("--alpha", request.alpha,
                 "shape exponent [-], default 1/3 where the model leaves it free", "ALPHA");
  parameters.Add("--slip-force", request.slip_force, "slip force Tc [N]", "N")
      ->transform(InUnit("N"));
  AddContactOptions(command, request.contact);
  AddFrictionOption(command, request.contact);
}

double SlipReach(const models::BranchLaw& law, const models::SeriesSpring& rig) {
  const double slip = models::GrossSlipDisplacement(law);
  return (std::isfinite(slip) ? slip : 3 * law.slip_force / law.tangential_stiffness) +
         law.slip_force / rig.stiffness;
}

}  // namespace mindahl::cli
