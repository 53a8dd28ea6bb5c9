#pragma once

#include <CLI/CLI.hpp>

#include "cli/contact_options.h"
#include "mindahl/request/fit_request.h"

namespace mindahl::cli {

using request::FitRequest;
using request::kAutomatic;

/// Adds them to a command.
void AddFitOptions(CLI::App& command, FitRequest& request, NormalLoads loads);

/// Of these, which columns there are, and in what unit.
void AddColumnOptions(CLI::App& command, FitRequest& request);
/// And what is fitted to them.
void AddModelOptions(CLI::App& command, FitRequest& request);

}  // namespace mindahl::cli
