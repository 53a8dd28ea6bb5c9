#pragma once

#include "cli/app.h"
#include "mindahl/request/motion.h"

namespace mindahl::cli {

using DriveOptions = request::DriveRequest;
using request::ImposedForce;
using request::ImposedMotion;

/// Adds --waveform … --growth, --path and --path-unit; --seed is the command's.
/// @param request  must outlive the application
void AddDriveOptions(CLI::App& command, DriveOptions& request);

/// Adds --normal-load-column and --normal-load-unit, of the file that --path names.
void AddLoadColumnOptions(CLI::App& command, DriveOptions& request);

/// Adds --force-path and --force-path-unit, which exclude all of the above.
void AddForcePathOptions(CLI::App& command, DriveOptions& request);

}  // namespace mindahl::cli
