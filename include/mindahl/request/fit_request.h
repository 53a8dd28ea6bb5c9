#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mindahl/identification/fit_options.h"
#include "mindahl/io/record_reader.h"
#include "mindahl/report/report.h"
#include "mindahl/request/contact_request.h"

namespace mindahl::request {

/// Turns a user's request for a fit, in words and numbers, into the report that answers it: the
/// same rules and messages for the command line, whose options these name, and for Python.

/// Holds the options of `fit` on records, model and contact, which docs/contract.md describes.
struct FitRequest {
  std::vector<std::string> files{};
  io::RecordColumns columns{};
  std::optional<identification::Interval> time_window{};  // [s]
  /// Holds the options as given, without what the members below add; no model: --model auto.
  identification::FitOptions fit{.model = nullptr};
  bool compare = false;              // all models, with and without a rig
  std::vector<std::string> terms{};  ///< names of groups of terms and of columns
  bool chooses_terms = false;        ///< fits the terms that the record requires, none by name
  bool trim = true;
  ContactOptions contact{};
};

/// @throws InvalidArgument or InputError naming options that break a rule or contradict each other
identification::FitOptions MakeFitOptions(const FitRequest& request);

/// Returns the options for fits of one cycle after the other: no covariates.
/// @throws InvalidArgument or InputError likewise
identification::FitOptions MakeCycleFitOptions(const FitRequest& request);

/// Requirements of `--strict` on a fit.
enum class Strictness {
  kNone,      ///< the fit converged
  kDoubtful,  ///< also that the model is not inadequate and every free parameter known
  kAdequate,  ///< also that the model is adequate and every free parameter identifiable
};

/// Says why a fit is not established, for the exit status; "" where it is.
std::string WhyNotEstablished(const identification::FitResult& fit, Strictness strictness);

/// Adds the terms that the first cycles of a test require to the options of its cycles' fits, where
/// the request leaves them to be chosen.
/// @param head     samples of the first cycles
/// @param options  of MakeCycleFitOptions()
/// @returns what to say of it; empty where nothing was chosen
std::string ChooseTermsOfCycles(const FitRequest& request, const loop::RecordView& head,
                                identification::FitOptions& options);

/// Returns why a record is refused, where that is a column that `--terms` names: it may be a
/// misspelt term.
std::string ExplainColumnFault(const FitRequest& request, const std::string& fault);

/// @throws InputError naming the place in the file: records of two kinds, a column that never
///   changes or is beyond any unit that is meant
void RequireLoops(const std::vector<io::RecordFile>& records);

/// Reads the request's files.
/// @throws InputError naming file, line and column
std::vector<io::RecordFile> ReadRecords(const FitRequest& request);

/// Fits records together as one contact at Depth::kFull, and reports.
/// @param records  those of the request's files; the fit has one record for each, in their order
/// @throws InvalidArgument or InputError naming record, line and column, or the option
report::Report FitRecords(const FitRequest& request, std::vector<io::RecordFile> records);

}  // namespace mindahl::request
