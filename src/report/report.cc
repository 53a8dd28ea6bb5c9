#include "mindahl/report/report.h"

#include <fmt/format.h>

#include <string>
#include <utility>

#include "mindahl/contact/mindlin_dahl_mapping.h"
#include "mindahl/core/error.h"
#include "mindahl/identification/terms.h"
#include "mindahl/report/contact.h"
#include "report/adequacy.h"
#include "report/names.h"
#include "report/trims.h"

namespace mindahl::report {
namespace {

void Require(const ReportInput& input) {
  const std::size_t records = input.fit.records.size();
  if (records == 0 || input.fit.model == nullptr) {
    throw InvalidArgument("there is nothing to report: the fit has no record or no model");
  }
  RequireSameSize("names of files", input.files.size(), "records of the fit", records);
  RequireSameSize("records", input.records.size(), "records of the fit", records);
  for (std::size_t r = 0; r < records; ++r) {
    const loop::Record& record = input.records[r].record;
    if (!input.fit.parameters.empty()) {
      RequireSameSize("samples", record.size(), "residuals of the fit",
                      input.fit.records[r].residual.size());
    }
    if (input.load_window) {
      RequireSameSize("normal loads, for the load window,", record.normal_load.size(), "samples",
                      record.size());
    }
  }
}

void SayFindings(Report& report) {
  for (const identification::Finding& finding : report.fit.findings) {
    const bool is_note = finding.severity == identification::Severity::kNote;
    (is_note ? report.notes : report.fit_warnings)
        .push_back({std::string(finding.code), Sentence(finding, report.fit, report.units)});
  }
}

/// Notes which files were split where their load steps.
void SayLoadPieces(Report& report) {
  std::vector<std::string> pieces;
  std::size_t left_out = 0;
  for (std::size_t r = 0; r < report.records.size(); ++r) {
    const std::optional<io::LoadPiece>& piece = report.records[r].piece;
    if (!piece || piece->is_between_ramps) continue;
    pieces.push_back(fmt::format("{:.4g} N ({})", piece->normal_load, report.files[r]));
    left_out += piece->left_out;
  }
  if (pieces.empty()) return;
  report.notes.push_back(
      {"load_steps",
       fmt::format(
           "the normal load goes in steps: fitted as a record for each constant load, {}; "
           "{} samples in between are left out, up to the second turning point under the new load",
           fmt::join(pieces, ", "), left_out)});
}

/// Returns warnings about given values that contradict each other, or could not be used.
std::vector<Warning> ContactWarnings(const Report& report) {
  std::vector<Warning> warnings;
  if (const auto why = WhyFrictionIsWithheld(report.fit, report.known)) {
    warnings.push_back({"contact_not_identified", "contact: friction coefficient " + *why});
  }
  const auto value = [](const std::optional<contact::PropagatedValue>& quantity) {
    return quantity ? std::optional<double>(quantity->value) : std::nullopt;
  };
  for (const std::string& sentence :
       contact::DoubtsAbout(report.known, value(report.contact.friction_coefficient),
                            value(report.contact.contact_radius))) {
    warnings.push_back({"contact_implausible", "contact: " + sentence});
  }
  for (const std::string& sentence : report.contact.redundant) {
    warnings.push_back({"contact_redundant", "contact: " + sentence});
  }
  return warnings;
}

}  // namespace

Report MakeReport(ReportInput input) {
  Require(input);
  Report report;
  static_cast<ReportInput&>(report) = std::move(input);
  if (report.is_torsional()) {
    report.units = kUnitsOfTorque;
    for (identification::ParameterEstimate& estimate : report.fit.parameters) {
      // Newtons over the unit of a column, whatever that is.
      const bool is_of_column = estimate.name.starts_with(identification::NameOfCovariate(""));
      estimate.unit = is_of_column ? std::string(report.units.force) + estimate.unit.substr(1)
                                   : std::string(UnitIn(report.units, estimate.unit));
    }
    report.fit.mindlin_test.reset();
  }
  if (report.fit.response == loop::Channel::kDisplacement) {
    report.units.response = report.units.displacement;
    report.units.excitation = report.units.force;
  }
  AdaptCauses(report.units, report.fit.adequacy.causes);
  SayFindings(report);
  SayLoadPieces(report);
  for (Warning& note : TrimNotes(report)) report.notes.push_back(std::move(note));
  if (report.failed()) return report;
  report.loop = DescribeLoop(report.fit);
  report.slip_forces = DescribeSlipForces(report.fit);
  if (report.is_torsional()) return report;
  report.alpha = TestAlpha(report.fit);
  report.contact = IdentifyFittedContact(report.fit, report.known);
  if (report.fit.law_choice) {
    report.contact_by_other_law =
        IdentifyContactOf(report.fit, report.fit.law_choice->law, report.known);
  }
  report.stiffness = TestStiffness(report.fit, report.contact);
  report.load_series = DescribeLoadSeries(report.fit, report.known);
  report.contact_warnings = ContactWarnings(report);
  return report;
}

}  // namespace mindahl::report
