#pragma once

#include <string_view>

#include "cli/contact_options.h"
#include "cli/options.h"
#include "mindahl/io/record_reader.h"
#include "mindahl/report/report.h"
#include "mindahl/request/fit_request.h"

namespace mindahl::cli {

using request::FitRequest;
using request::kAutomatic;
using request::Strictness;

void AddFitOptions(CLI::App& command, FitRequest& request, NormalLoads loads);

/// The group of the columns in the help of a command.
inline constexpr std::string_view kColumnGroup = "Columns and units";

void AddJoin(CLI::App& command, FitRequest& options);

/// Adds the options that say which columns of a record are read, and in what unit.
void AddColumnOptions(CLI::App& command, io::RecordColumns& columns);

/// Adds the options of the model that is fitted to them.
void AddModelOptions(CLI::App& command, FitRequest& request);

/// Adds `--strict`, which asks for kAdequate, and `--strict=doubtful`.
/// @param otherwise  what happens to a fit that is not: "exit status 3"
void AddStrict(const OptionGroup& group, Strictness& strictness, const std::string& otherwise);

}  // namespace mindahl::cli
