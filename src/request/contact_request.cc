#include "mindahl/request/contact_request.h"

#include "core/refuse.h"

namespace mindahl::request {

using contact::KnownBody;
using contact::UncertainValue;
using models::BranchLaw;

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
  const auto is_any_known = [](const KnownBody& body) {
    return body.youngs_modulus || body.poisson_ratio || body.radius;
  };
  return known.friction_coefficient || known.normal_load || known.contact_radius ||
         known.tangential_compliance || is_any_known(known.body_1) || is_any_known(known.body_2);
}

void Validate(const ContactOptions& options, std::size_t records) {
  contact::Validate(options.known);
  const std::size_t loads = options.normal_loads.size();
  if (loads > 1 && loads != records) {
    Refuse("--normal-load: {} loads for {} record{}: give one for all or one a record", loads,
           records, records > 1 ? "s" : "");
  }
}

bool IsAnythingGiven(const LawRequest& request) {
  return request.sigma || request.alpha || request.slip_force || IsAnythingGiven(request.contact);
}

BranchLaw ResolveLaw(const LawRequest& request, std::string_view model,
                     std::optional<double> prescribed_exponent) {
  Validate(request.contact);
  const bool by_contact = IsAnythingGiven(request.contact);
  if ((request.sigma || request.slip_force) && by_contact) {
    Refuse(
        "--sigma and --slip-force exclude --friction, --normal-load and other options that "
        "describe a contact: give one of the two");
  }
  BranchLaw law;
  if (by_contact) {
    const contact::PredictedContact predicted = contact::PredictContact(request.contact.known);
    law = {.tangential_stiffness = predicted.tangential_stiffness.value,
           .shape_exponent = contact::kMindlinShapeExponent,
           .slip_force = predicted.slip_force.value};
  } else if (request.sigma && request.slip_force) {
    law = {.tangential_stiffness = *request.sigma, .slip_force = *request.slip_force};
  } else {
    Refuse("{} missing: give --sigma and --slip-force{}",
           request.sigma ? "--slip-force" : "--sigma",
           model.empty() ? ""
                         : ", or a contact (--friction, --normal-load, --contact-radius, "
                           "--compliance or materials and radii)");
  }
  if (request.alpha) law.shape_exponent = *request.alpha;
  Validate(law);
  if (!prescribed_exponent) return law;
  if (request.alpha && *request.alpha != *prescribed_exponent) {
    Refuse("--alpha {} contradicts --model {}, whose alpha is {}: use --model mindlin-dahl",
           *request.alpha, model, *prescribed_exponent);
  }
  law.shape_exponent = *prescribed_exponent;
  return law;
}

}  // namespace mindahl::request
