#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "cli/contact_options.h"
#include "mindahl/models/branch_law.h"

namespace mindahl::cli {

/// A branch law on the command line: by its parameters, or by a contact.
struct LawOptions {
  std::optional<double> sigma;
  std::optional<double> alpha;
  std::optional<double> slip_force;
  ContactOptions contact;
};

/// Adds --sigma, --alpha, --slip-force and what describes a contact, --friction included.
/// @param options  must outlive the application
void AddLawOptions(CLI::App& command, LawOptions& options);

bool IsAnythingGiven(const LawOptions& options);

/// @throws InputError or InvalidArgument naming the option and the rule
void Validate(const LawOptions& options);

/// α is the option's, by default 1/3.
/// @throws InputError when parameters are missing or given twice
models::BranchLaw ResolveLaw(const LawOptions& options);

/// The law as a model uses it that prescribes α.
/// @throws InputError when --alpha contradicts it
models::BranchLaw ResolveLaw(const LawOptions& options, std::string_view model,
                             std::optional<double> prescribed_exponent);

/// The options that say the same law in a command to copy: "--sigma 1e8 --alpha 0.33 …".
std::string LawArguments(const models::BranchLaw& law);

}  // namespace mindahl::cli
