#pragma once

#include <optional>
#include <span>
#include <vector>

#include "mindahl/contact/mindlin_dahl_mapping.h"

namespace mindahl::request {

/// G*, said in every report that uses it: many texts write it for the inverse.
inline constexpr const char* kComplianceDefinition = "G* = (2-nu1)/G1 + (2-nu2)/G2";
inline constexpr const char* kComplianceUnit = "1/Pa";

/// Holds the properties of the contact that the user gave.
struct ContactOptions {
  contact::KnownContact known;
  /// Loads as given, one or one a file; known.normal_load is their mean.
  std::vector<contact::UncertainValue> normal_loads;
  std::optional<contact::UncertainValue> friction_coefficient;
};

/// Sets the normal loads [N], one for all records or one a record: their mean is what is known of
/// the contact, their uncertainties independent.
/// @throws InvalidArgument for one that is not > 0
void SetNormalLoads(ContactOptions& options, std::span<const contact::UncertainValue> loads);

/// True if any of it was given.
bool IsAnythingGiven(const ContactOptions& options);

/// @throws InvalidArgument naming the option, its value and the rule; InputError for a plane with
/// an uncertain radius
void Validate(const ContactOptions& options);

}  // namespace mindahl::request
