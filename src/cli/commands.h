#pragma once

#include <CLI/CLI.hpp>

#include "cli/app.h"

namespace mindahl::cli {

// Each adds one command to the application; its callback runs the command and sets the exit status.
void AddFitCommand(CLI::App& app, Console& console);
void AddSimulateCommand(CLI::App& app, Console& console);
void AddValidateCommand(CLI::App& app, Console& console);
void AddContactCommand(CLI::App& app, Console& console);
void AddConvertCommand(CLI::App& app, Console& console);
void AddTradeoffCommand(CLI::App& app, Console& console);
void AddRecommendCommand(CLI::App& app, Console& console);
void AddPlanCommand(CLI::App& app, Console& console);
void AddTrackCommand(CLI::App& app, Console& console);
void AddBatchCommand(CLI::App& app, Console& console);

}  // namespace mindahl::cli
