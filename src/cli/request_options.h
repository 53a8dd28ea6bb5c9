#pragma once

#include <string>
#include <string_view>

#include "cli/app.h"
#include "cli/options.h"
#include "mindahl/contact/mindlin_dahl_mapping.h"
#include "mindahl/io/record_reader.h"
#include "mindahl/models/response.h"
#include "mindahl/request/contact_request.h"
#include "mindahl/request/fit_request.h"

// Options that make a request: for a contact, for a law, and for a fit.
namespace mindahl::cli {

using request::ContactOptions;
using request::FitRequest;
using LawOptions = request::LawRequest;
using request::Strictness;

/// Reads "0.01", "0.01±0.0001", "0.01+-0.0001", "0.01+/-0.0001" or "0.01±1%": a number as in every
/// other option and, unless it is exact, one standard uncertainty, in percent of the number's
/// magnitude with %. Either may have a unit, "50 N ± 0.5 N"; one at the end is of both, "50±0.5 N".
/// @param unit  that of a number
/// @throws InputError naming the option, the text, the rule and the remedy
contact::UncertainValue ParseUncertainValue(std::string_view text, std::string_view option,
                                            std::string_view unit);

/// How many normal loads an option may give.
enum class NormalLoads { kOne, kOneAFile };

/// Adds --normal-load, --youngs-modulus-1 … --radius-2, --contact-radius and --compliance.
/// Each takes a standard uncertainty.
/// @param options  must outlive the application
void AddContactOptions(CLI::App& command, ContactOptions& options,
                       NormalLoads loads = NormalLoads::kOne);

/// Adds --friction. As above it takes a standard uncertainty.
void AddFrictionOption(CLI::App& command, ContactOptions& options);

/// Adds --sigma, --alpha, --slip-force and what describes a contact, --friction included.
/// @param request  must outlive the application
void AddLawOptions(CLI::App& command, LawOptions& request);

/// Returns the displacement [m] of λ = 1, behind a rig: gross slip, or three elastic limits where
/// slip is only approached.
double SlipReach(const models::BranchLaw& law, const models::SeriesSpring& rig = {});

void AddFitOptions(CLI::App& command, FitRequest& request, NormalLoads loads);

void AddJoin(CLI::App& command, FitRequest& options);

/// Adds the options that say which columns of a record are read, and in what unit.
void AddColumnOptions(CLI::App& command, io::RecordColumns& columns);

/// Adds the options of the model that is fitted to them.
void AddModelOptions(CLI::App& command, FitRequest& request);

/// Adds `--strict`, which asks for kAdequate, and `--strict=doubtful`.
/// @param otherwise  what happens to a fit that is not: "exit status 3"
void AddStrict(const OptionGroup& group, Strictness& strictness, const std::string& otherwise);

}  // namespace mindahl::cli
