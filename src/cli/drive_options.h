#pragma once

#include <CLI/CLI.hpp>

#include "mindahl/request/motion.h"

namespace mindahl::cli {

using request::DriveRequest;

/// Adds --waveform … --growth, --path and --path-unit; --seed is the command's.
/// @param request  must outlive the application
void AddDriveOptions(CLI::App& command, DriveRequest& request);

/// Adds --normal-load-column and --normal-load-unit, of the file that --path names.
void AddLoadColumnOptions(CLI::App& command, DriveRequest& request);

/// Adds --force-path and --force-path-unit, which exclude all of the above.
void AddForcePathOptions(CLI::App& command, DriveRequest& request);

}  // namespace mindahl::cli
