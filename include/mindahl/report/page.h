#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mindahl/report/report.h"

namespace mindahl::report {

/// Identifies a file from which a result was made.
struct InputFile {
  std::string name{};                   ///< name given by the user
  std::optional<std::string> sha256{};  ///< io::Sha256OfFile(); empty where it is no regular file
};

/// Holds what is needed to make a result again.
struct Provenance {
  std::string command{};            ///< command for a shell; "" where there was none
  std::vector<InputFile> inputs{};  ///< files that were read
  /// Options with their values, those of a configuration file too.
  std::vector<std::pair<std::string, std::string>> options{};
};

/// Returns the report of a fit as one page of HTML 5, for people: the answer's lines beside the
/// loop with its residual, and details below. It loads nothing and runs no script, follows the
/// light or dark scheme of its reader, and prints. Of a fit that failed, why, and what it was made
/// from.
///
/// Figures have at most 6000 points each, so that the size of a page, some hundred kilobytes, does
/// not grow with the record.
std::string ToPage(const Report& report, const Provenance& provenance = {});

}  // namespace mindahl::report
