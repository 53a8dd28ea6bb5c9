#pragma once

#include <ostream>
#include <string_view>

#include "cli/fit_request.h"
#include "mindahl/report/report.h"

namespace mindahl::cli {

/// Receives the notes on assumptions and the warnings of a command.
struct Messages {
  std::ostream& stream;
  std::string_view command;  ///< "fit"

  void Note(std::string_view text) const;
  void Warn(std::string_view text) const;
};

/// Reads the files and fits them together as one contact.
/// @throws InputError naming file, line and column, or the option
report::Report FitRecords(const FitRequest& request, const Messages& messages);

}  // namespace mindahl::cli
