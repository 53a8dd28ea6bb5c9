#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mindahl/contact/mindlin_dahl_mapping.h"
#include "mindahl/identification/backbone_estimate.h"
#include "mindahl/identification/fit.h"
#include "mindahl/identification/model_selection.h"
#include "mindahl/identification/term_selection.h"
#include "mindahl/io/record_reader.h"
#include "mindahl/loop/trim.h"
#include "mindahl/report/load_series.h"
#include "mindahl/report/loop_description.h"
#include "mindahl/report/mapping_tests.h"
#include "mindahl/report/slip_forces.h"
#include "mindahl/report/units.h"
#include "mindahl/report/warning.h"

namespace mindahl::report {

/// Holds the inputs of a report.
struct ReportInput {
  std::vector<std::string> files;       ///< name of each record, as it is to be printed
  std::vector<io::RecordFile> records;  ///< records that were fitted, as read
  identification::FitResult fit;
  identification::FitOptions options = {};  ///< of the fit, with what was chosen by it
  contact::KnownContact known = {};  ///< known properties of the contact, in addition to the fit
  /// Normal loads [N] of the samples that counted, as given to the fit.
  std::optional<identification::Interval> load_window = {};
  /// Holds the parts left out of each record as not of its test; empty where not requested.
  std::vector<loop::Trim> trims = {};
  std::optional<identification::ModelSelection> selection = {};   ///< if a model was chosen
  std::optional<identification::TermSelection> terms = {};        ///< if terms were chosen
  std::optional<identification::BackboneEstimate> backbone = {};  ///< if it was requested
};

/// Everything that is said of a fit: what was given, and what follows from it. ToJson(), ToText(),
/// ToPlot() and ResidualsCsv() write it.
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

}  // namespace mindahl::report
