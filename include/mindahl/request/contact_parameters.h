#pragma once

#include <string>
#include <vector>

#include "mindahl/contact/mindlin_dahl_mapping.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/request/contact_request.h"

namespace mindahl::request {

/// A line of the report on a contact.
struct ContactQuantity {
  std::string section;  // of the JSON
  std::string name;
  contact::UncertainValue value;
  std::string unit;
  std::string meaning;
};

struct ContactParameters {
  models::BranchLaw law;
  std::vector<ContactQuantity> quantities;
};

/// Returns Dahl's parameters of a contact described by friction and normal load with either contact
/// radius and compliance or the materials and radii of both bodies; uncertain inputs make uncertain
/// quantities.
/// @throws InputError naming the options that are missing
ContactParameters ResolveContact(const ContactOptions& options);

}  // namespace mindahl::request
