#pragma once

#include <CLI/CLI.hpp>
#include <optional>

#include "mindahl/contact/mindlin_dahl_mapping.h"

namespace mindahl::cli {

/// What the user knows of the contact: the same options in every command.
struct ContactOptions {
  KnownContact known;
  std::optional<double> friction_coefficient;
};

/// Adds --normal-load, --youngs-modulus-1 … --radius-2, --contact-radius and --compliance.
/// @param options  must outlive the application
void AddContactOptions(CLI::App& command, ContactOptions& options);

/// Adds --friction.
void AddFrictionOption(CLI::App& command, ContactOptions& options);

/// Was any of the options given?
bool IsAnythingGiven(const ContactOptions& options);

/// @throws InvalidArgument naming the option, its value and the rule
void Validate(const ContactOptions& options);

/// A value that may be missing, read from one option.
CLI::Option* AddOptional(CLI::App& command, const std::string& name, std::optional<double>& target,
                         const std::string& description, const std::string& unit);

}  // namespace mindahl::cli
