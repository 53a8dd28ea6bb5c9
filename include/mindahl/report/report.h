#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mindahl/contact/mindlin_dahl_mapping.h"
#include "mindahl/identification/finding.h"
#include "mindahl/identification/fit.h"
#include "mindahl/identification/model_selection.h"
#include "mindahl/identification/term_selection.h"
#include "mindahl/io/plot.h"
#include "mindahl/io/record_reader.h"
#include "mindahl/loop/segments.h"
#include "mindahl/report/contact.h"
#include "mindahl/report/load_series.h"
#include "mindahl/report/loop_description.h"
#include "mindahl/report/units.h"

namespace mindahl::report {

/// A warning that a person should act on.
struct Warning {
  std::string code;  ///< stable, for scripts; docs/contract.md lists them
  std::string message;
};

/// A change of the request that was fitted again and lowers the misfit.
struct NextStep {
  std::string text;            ///< in words: "a slip force that depends on the position"
  std::string options;         ///< to add to the command: "--terms slip_position"
  double misfit_before = 0.0;  ///< Adequacy::misfit_over_half_gap of the fit that is reported
  double misfit_after = 0.0;   ///< of the fit with the options
};

/// Holds the inputs of a report.
struct ReportInput {
  std::vector<std::string> files;       ///< name of each record, as it is to be printed
  std::vector<io::RecordFile> records;  ///< records that were fitted, as read
  identification::FitResult fit;
  identification::FitOptions options = {};  ///< options of the fit, with what it chose
  contact::KnownContact known = {};  ///< known properties of the contact, in addition to the fit
  /// Normal loads [N] of the samples that counted, as given to the fit.
  std::optional<identification::Interval> load_window = {};
  /// Holds the parts left out of each record as not of its test; empty where not requested.
  std::vector<loop::Trim> trims = {};
  std::optional<identification::ModelSelection> selection = {};  ///< if a model was chosen
  std::optional<identification::TermSelection> terms = {};       ///< if terms were chosen
  /// The best step that was tried; empty where none was. One that helps by less than a tenth is not
  /// reported.
  std::optional<NextStep> next = {};
};

/// Holds the answer of a fit: its inputs, and everything that follows from them. ToJson(),
/// ToText(), ToPlot() and ResidualsCsv() write it.
struct Report : ReportInput {
  std::optional<LoopDescription> loop;  ///< empty where the fit failed
  contact::IdentifiedContact contact;   ///< empty where the fit failed
  /// Holds the contact by Masing's law where Dahl's own was fitted, and the other way round; empty
  /// where the two are not compared.
  contact::IdentifiedContact contact_by_other_law;
  std::optional<SlipForces> slip_forces;  ///< empty unless the fit knows that the two differ
  std::optional<LoadSeries> load_series;  ///< empty where the records have one load
  AlphaTest alpha;
  std::vector<StiffnessTest> stiffness;   ///< one for each radius that is known besides the fit
  std::vector<Warning> fit_warnings;      ///< findings of the fit on which a person should act
  std::vector<Warning> contact_warnings;  ///< findings of the translation into the contact
  std::vector<Warning> notes;             ///< findings of the fit that are only worth knowing

  Units units;  ///< units of all numbers in words

  /// True for a torque against an angle, which has no Hertz-Mindlin contact and no mapping.
  [[nodiscard]] bool is_torsional() const { return records.front().is_torsional; }
  /// True for a fit that failed and has no parameter, residual, loop, contact or mapping.
  [[nodiscard]] bool failed() const { return fit.parameters.empty(); }
};

/// Makes loop, contact and mapping from a fit.
/// @param input  one name and one record for each record of the fit
/// @throws InvalidArgument when their numbers differ or there is none, when the fit has no model,
/// and
///   as IdentifyFittedContact()
Report MakeReport(ReportInput input);

/// Describes a finding in words, without an end of line: what was found, what it means and, where
/// something can be done, what to do.
/// @param finding  with the numbers and parameters that its code has (docs/contract.md)
/// @param fit      the fit that found it: the model's name and why the solver stopped are its own
/// @param units    of the record
/// @throws std::logic_error for a kind without a sentence, and for a number that is missing
std::string Sentence(const identification::Finding& finding, const identification::FitResult& fit,
                     const Units& units = kUnitsOfForce);

struct TextOptions {
  bool has_colours = false;  ///< escape sequences of a terminal around verdicts and headings
};

/// Returns a text for people; UTF-8, at most 100 columns. The first 24 lines have the verdict, the
/// use, the next step, the contact's parameters and the contact as far as it is known; what that
/// rests on follows. A fit that is of no use has ten lines, and no parameter.
/// @throws InvalidArgument for a fit that failed
std::string ToText(const Report& report, const TextOptions& options = {});

/// Returns the JSON of schema mindahl.fit/1, as `mindahl fit --json` writes it, with the end of
/// line: docs/contract.md. UTF-8; bytes of a file name that are not are replaced.
std::string ToJson(const Report& report);

/// Plots the measured and fitted loop, with the residual along the displacement below: of samples
/// in the load window where there is one.
/// @throws InvalidArgument for a fit that failed
io::Plot ToPlot(const Report& report);

/// Returns the measured and fitted force of every sample, as CSV. With several records the first
/// column numbers them; time is there where every record has it.
/// @throws InvalidArgument for a fit that failed
std::string ResidualsCsv(const Report& report);

}  // namespace mindahl::report
