#pragma once

#include <functional>
#include <ostream>
#include <string>
#include <vector>

namespace CLI {
class App;
}  // namespace CLI

namespace mindahl::cli {

/// Holds what every command writes to, and its exit status.
struct Console {
  std::ostream& out;           // results
  std::ostream& err;           // messages and progress
  std::string json_path = {};  // of the answer as JSON: "" none, "-" standard output
  int exit_status = 0;
  std::string command_line = {};  // as a shell takes it
};

inline constexpr int kDone = 0;
inline constexpr int kInternalError = 1;
inline constexpr int kBadInput = 2;
inline constexpr int kNotEstablished = 3;  // not converged, not identifiable when strict, not valid

/// Runs the command line and returns the exit status of docs/contract.md.
int Run(int argc, const char* const* argv, std::ostream& out, std::ostream& err);

/// Reads options without running a command, as its words would be read.
/// @param words  "--model", "dahl", ...
/// @param add    adds the options to an application that goes when they are read
/// @throws InputError as a command refuses them
void ReadOptions(const std::vector<std::string>& words, const std::function<void(CLI::App&)>& add);

// Each adds one command to the application; its callback runs the command and sets the exit status.
void AddFitCommand(CLI::App& app, Console& console);
void AddSimulateCommand(CLI::App& app, Console& console);
void AddValidateCommand(CLI::App& app, Console& console);
void AddContactCommand(CLI::App& app, Console& console);
void AddConvertCommand(CLI::App& app, Console& console);
void AddTradeoffCommand(CLI::App& app, Console& console);
void AddPlanCommand(CLI::App& app, Console& console);
void AddTrackCommand(CLI::App& app, Console& console);
void AddBatchCommand(CLI::App& app, Console& console);

}  // namespace mindahl::cli
