#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mindahl/contact/mindlin_dahl_mapping.h"
#include "mindahl/identification/fit.h"
#include "mindahl/identification/model_comparison.h"
#include "mindahl/identification/term_selection.h"
#include "mindahl/io/plot.h"
#include "mindahl/io/record_reader.h"
#include "mindahl/report/contact.h"
#include "mindahl/report/units.h"

namespace mindahl::report {

/// A warning that a person should act on.
struct Warning {
  std::string code;  ///< stable, for scripts; docs/contract.md lists them
  std::string message;
};

/// A change of the request that was fitted again and lowers the misfit.
struct NextStep {
  std::string text;                ///< in words: "a slip force that depends on the position"
  std::string options;             ///< to add to the command: "--terms slip_position"
  double misfit_before = 0.0;      ///< Adequacy::misfit_over_half_gap of the fit that is reported
  double misfit_after = 0.0;       ///< likewise, with the options
  bool is_over_amplitude = false;  ///< misfit_after, of a fit of the displacement, over X
  /// Force [N] of that fit, one list a record, for the page; may be empty.
  std::vector<std::vector<double>> fitted_force = {};
};

/// Holds successive lines of a file that do not count.
struct LeftOut {
  std::string file;
  std::size_t samples = 0;
  std::size_t first = 0;  ///< first line in the file, 1-based; 0 where they are not in a row
  std::size_t last = 0;
  std::string why;  ///< "rest", "travel", "load ramp", "faults", "selection" …
};

/// Holds the inputs of a report.
struct ReportInput {
  std::vector<io::RecordFile> records{};  ///< records that were fitted, as read
  identification::FitResult fit{};
  identification::FitOptions options = {};  ///< options of the fit, with what it chose
  contact::KnownContact known = {};  ///< known properties of the contact, in addition to the fit
  /// Samples cut off the records as not of their tests; in a Report also what else does not count.
  std::vector<LeftOut> left_out = {};
  std::vector<std::string> notes = {};  ///< what was assumed of the records, one sentence each
  std::vector<identification::ModelScore> compared = {};    ///< if models were compared
  std::optional<identification::TermSelection> terms = {};  ///< if terms were chosen
  /// The best step that was tried; empty where none helps by a tenth.
  std::optional<NextStep> next = {};
};

/// Holds the answer of a fit: its inputs, and everything that follows from them. ToJson(),
/// ToText(), ToPage() and ToPlot() write it.
struct Report : ReportInput {
  Units units;                           ///< units of all numbers in words
  std::size_t samples = 0;               ///< of all records, with those that are left out
  std::vector<ContactQuantity> contact;  ///< empty where the fit failed, and of a torque
  AlphaTest alpha;
  std::vector<Warning> warnings;  ///< on which a person should act
  /// Names a unit or a load that is most likely wrong, to look at first; "" where none is.
  std::string check;

  /// Returns the names of the records.
  [[nodiscard]] std::vector<std::string> files() const;
  /// True for a torque against an angle, which has no Hertz-Mindlin contact and no mapping.
  [[nodiscard]] bool is_torsional() const { return records.front().is_torsional; }
  /// True for a fit that failed and has no parameter, residual, loop, contact or mapping.
  [[nodiscard]] bool failed() const { return fit.parameters.empty(); }
  /// Returns nullptr where the contact has no such quantity.
  [[nodiscard]] const ContactQuantity* Find(std::string_view quantity) const;
  /// Returns its value; empty where it has none.
  [[nodiscard]] std::optional<double> ValueOf(std::string_view quantity) const;
};

/// Names the columns that a record is from, "displacement 'x [m]' (2), force 'F [N]' (3)"; or "".
/// @param force_sense  −1: the file has the force with the opposite sign
std::string ColumnsText(const io::RecordFile& file, int force_sense);

/// Makes a report from a fit.
/// @param input  one record for each record of the fit
/// @throws InvalidArgument when their numbers differ or there is none, when the fit has no model,
///   and as DescribeContact()
Report MakeReport(ReportInput input);

/// How much ToText() prints: the answer, or every quantity and finding as well.
enum class Detail { kAnswer, kAll };

/// Returns the answer for people, one line a quantity, each with one uncertainty: its interval.
/// UTF-8, at most 100 columns.
/// @throws InvalidArgument for a fit that failed
std::string ToText(const Report& report, Detail detail = Detail::kAnswer);

/// Returns the JSON of schema mindahl.fit/2, as `mindahl fit --json` writes it, with the end of
/// line: docs/contract.md. UTF-8; bytes of a file name that are not are replaced.
std::string ToJson(const Report& report);

/// Returns the report of a fit as one page of HTML 5, for people: the answer's lines beside the
/// loop with its residual, and details below. It loads nothing and runs no script, follows the
/// light or dark scheme of its reader, and prints. Of a fit that failed, why.
///
/// Figures have at most 6000 points each: a page has some hundred kilobytes, whatever the record.
/// @param command  that makes it again, for a shell; "" where there was none
std::string ToPage(const Report& report, std::string_view command = {});

/// Plots the measured and fitted loop, with the residual along the displacement below.
/// @throws InvalidArgument for a fit that failed
io::Plot ToPlot(const Report& report);

/// Returns the measured and fitted force of every sample, as CSV. With several records the first
/// column numbers them; time is there where every record has it.
/// @throws InvalidArgument for a fit that failed
std::string ResidualsCsv(const Report& report);

}  // namespace mindahl::report
