#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mindahl/report/report.h"
#include "mindahl/request/fit_request.h"

namespace mindahl::request {

/// Holds the fit of one source of a batch, or the fault for which it has none.
struct BatchEntry {
  std::string file;
  std::string fault = {};                    ///< why it is not done; "" where it is
  std::string fit = {};                      ///< its JSON, as `mindahl fit --json` writes it; or ""
  std::vector<std::string> notes = {};       ///< assumptions of the run, one sentence each
  std::string verdict = {};                  ///< one word for the fit's adequacy
  std::vector<std::string> parameters = {};  ///< σ, α and Tc in words
  /// FitResult::ErrorOf() by name, of those of σ, α and Tc that are estimated or held.
  std::map<std::string, double> errors = {};

  /// True if it is fitted, and nothing is in WhyNotEstablished().
  [[nodiscard]] bool done() const { return fault.empty(); }
};

/// Fits one source on its own. A fault of the source is one of the entry.
/// @param fit  reads and fits it
BatchEntry FitSource(const std::string& name, Strictness strictness,
                     const std::function<report::Report()>& fit);

/// Fits each of the request's files on its own, in their order whatever the number of threads.
/// Options that break a rule, or a page that cannot be written, are a fault of each file.
/// @param pages    directory for the page of each file, to which the index leads; "" for none
/// @param command  as of report::ToPage()
std::vector<BatchEntry> FitFiles(const FitRequest& request, Strictness strictness,
                                 std::size_t threads, const std::filesystem::path& pages = {},
                                 std::string_view command = {});

/// Holds what `mindahl batch` answers.
struct BatchAnswer {
  std::string rows;   ///< rows of the table as JSON
  std::string table;  ///< the same as CSV, which `--output` writes
  std::string json;   ///< schema mindahl.batch/1, which `--json` writes
  std::string text;
  /// Index of the entries' pages: each with its verdict and parameters, those alone that it
  /// identifies, what failed and why, and the scatter between files against their stated errors.
  std::string index;
};

/// @param output   path of the table; null in the JSON and not said where it is empty
/// @param command  as of report::ToPage()
BatchAnswer AnswerOf(std::span<const BatchEntry> entries, const std::string& output = {},
                     std::string_view command = {});

}  // namespace mindahl::request
