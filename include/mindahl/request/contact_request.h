#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "mindahl/contact/mindlin_dahl_mapping.h"
#include "mindahl/models/branch_law.h"

namespace mindahl::request {

/// Holds the properties of the contact that the user gave.
struct ContactOptions {
  contact::KnownContact known{};
  /// Loads as given, one or one a file; known.normal_load is their mean.
  std::vector<contact::UncertainValue> normal_loads{};
};

/// Sets the normal loads [N], one for all records or one a record: their mean is what is known of
/// the contact, their uncertainties independent.
/// @throws InvalidArgument for one that is not > 0
void SetNormalLoads(ContactOptions& options, std::span<const contact::UncertainValue> loads);

/// True if any of it was given.
bool IsAnythingGiven(const ContactOptions& options);

/// @param records  under these loads
/// @throws InvalidArgument naming the option, its value and the rule, InputError where there are
///   other loads than one for all or one a record
void Validate(const ContactOptions& options, std::size_t records = 1);

/// A branch law: by its parameters, or by a contact.
struct LawRequest {
  std::optional<double> sigma{};       ///< [N/m]
  std::optional<double> alpha{};       ///< [-]
  std::optional<double> slip_force{};  ///< [N]
  ContactOptions contact{};
};

/// True if a parameter, or anything of a contact, was given.
bool IsAnythingGiven(const LawRequest& request);

/// Returns the law; α is 1/3 where it is not given.
/// @param model, prescribed_exponent  a model and the α that it prescribes, if it does
/// @throws InputError when parameters are missing or given twice, or --alpha contradicts the model,
///   InvalidArgument out of range
models::BranchLaw ResolveLaw(const LawRequest& request, std::string_view model = {},
                             std::optional<double> prescribed_exponent = std::nullopt);

}  // namespace mindahl::request
