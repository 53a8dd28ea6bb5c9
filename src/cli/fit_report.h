#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cli/contact_options.h"
#include "mindahl/contact/mindlin_dahl_mapping.h"
#include "mindahl/identification/fit.h"
#include "mindahl/identification/model_selection.h"
#include "mindahl/io/plot.h"
#include "mindahl/io/record_reader.h"

namespace mindahl::cli {

/// Everything a report says of a fit beyond the fit itself.
struct FitReport {
  std::vector<std::string> files;
  std::vector<io::RecordFile> inputs;
  identification::FitResult fit;
  std::optional<double> model_energy;             ///< W [J] of the fitted model at the amplitude
  std::optional<double> energy_ratio;             ///< A = W/(4XT*)
  std::optional<double> gross_slip_displacement;  ///< δc [m]
  std::optional<double> stick_radius_ratio;       ///< c/a
  bool gross_slip = false;
  contact::IdentifiedContact contact;
  std::optional<double> given_normal_load;
  std::optional<identification::Interval> load_window;  ///< [N]

  std::optional<double> alpha_minus_third;
  std::optional<double> alpha_z;        ///< (α − 1/3)/SE
  std::optional<double> alpha_p_value;  ///< two-sided
  std::optional<contact::UncertainValue> sigma_over_hertz_mindlin;
  std::vector<identification::FitWarning> warnings;  ///< the fit's and those of the translation
  std::optional<identification::ModelSelection> selection;  ///< where the model was chosen
};

/// Loop, contact and mapping from a fit.
FitReport MakeFitReport(std::vector<std::string> files, std::vector<io::RecordFile> inputs,
                        identification::FitResult fit, const contact::KnownContact& known);

/// Schema mindahl.fit/1.
nlohmann::ordered_json ToJson(const FitReport& report);

/// For people; UTF-8, at most 100 columns.
std::string ToText(const FitReport& report);

/// Measured and fitted loop, with the residual along the displacement below: of samples in the load
/// window where there is one.
io::Plot ToPlot(const FitReport& report);

/// Measured and fitted force of every sample, as CSV.
std::string ResidualsCsv(const FitReport& report);

}  // namespace mindahl::cli
