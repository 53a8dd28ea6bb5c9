#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mindahl/io/record_reader.h"
#include "mindahl/loop/trim.h"
#include "mindahl/report/report.h"
#include "mindahl/request/fit_request.h"

namespace mindahl::request {

/// Receives the assumptions, one sentence each.
using Tell = std::function<void(std::string_view)>;

/// Requirements of `--strict` on a fit.
enum class Strictness {
  kNone,      ///< the fit converged
  kDoubtful,  ///< also that the model is not inadequate and every free parameter known
  kAdequate,  ///< also that the model is adequate and every free parameter identifiable
};

/// Returns true if a fit is done, for the exit status.
bool Established(const identification::FitResult& fit, Strictness strictness);

/// Has the fit leave out what is no part of the test of each record, and take the contact for one
/// that was not unloaded before where that leaves out every first loading and nothing else is
/// stated of it.
/// @param trims  one a record, or none
void LeaveOutTrimmed(std::span<const loop::Trim> trims, identification::FitOptions& options);

/// @throws InvalidArgument or InputError for options that break a rule whatever the records are
void Validate(const FitRequest& request);

/// Adds the terms that the first cycles of a test require to the options of its cycles' fits, where
/// the request leaves them to be chosen.
/// @param head     samples of the first cycles
/// @param options  of MakeCycleFitOptions()
/// @returns what to say of it; empty where nothing was chosen
std::string ChooseTermsOfCycles(const FitRequest& request, const loop::RecordView& head,
                                identification::FitOptions& options);

/// Keeps the samples in the request's time window, where it has one, with a note in the record.
/// @param name  the record's, for messages
/// @throws InputError as io::KeepTimeWindow()
void KeepTimeWindow(const FitRequest& request, const std::string& name, io::RecordFile& record);

/// Reads the request's files, within its limits and time window.
/// @throws InputError naming file, line and column
std::vector<io::RecordFile> ReadRecords(const FitRequest& request, const Tell& note);

/// Adds the backbone of the report's records, without any law's shape, and withdraws the advice
/// that cannot be followed together with one.
/// @throws InputError for a fit that has none
void AddBackbone(const FitRequest& request, report::Report& report);

/// Returns the warnings of a fit that its text does not have, one sentence each.
std::vector<std::string> WarningsBesideText(const report::Report& report);

/// Fits records together as one contact at Depth::kThorough, and reports.
/// @param records  within the time window, called as request.files; one whose normal load goes in
///   steps becomes a record for each load
/// @throws InvalidArgument or InputError naming record, line and column, or the option
report::Report FitRecords(const FitRequest& request, std::vector<io::RecordFile> records,
                          const Tell& note);

}  // namespace mindahl::request
