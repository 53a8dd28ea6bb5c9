#pragma once

#include <optional>
#include <string>

#include "mindahl/identification/sweep.h"
#include "mindahl/io/record_reader.h"
#include "mindahl/request/fit_request.h"

namespace mindahl::request {

/// The fit of stiffnesses or compliances over the amplitude, and what it is of.
struct FittedSweep {
  std::string file;
  io::SweepFile sweep;
  identification::SweepOptions asked = {};
  identification::SweepFit fit = {};

  /// True if neighbouring residuals are correlated, so that the law misses the sweep's shape.
  [[nodiscard]] bool is_doubtful() const;
  /// True if the fit is done, for the exit status.
  [[nodiscard]] bool established(Strictness strictness) const;
};

/// Fits a sweep; of the request its model, confidence and what is held count.
/// @param file  its name
/// @param kind  "secant" or "tangent"
/// @throws InputError for a model that is no Masing law
FittedSweep FitSweep(const FitRequest& request, const std::string& file, io::SweepFile sweep,
                     const std::string& kind, const Tell& note);

/// Fits the request's one file, whose columns the request has too.
/// @throws InputError likewise, and for more than one file
FittedSweep FitSweepFile(const FitRequest& request, const std::string& kind,
                         const std::string& response, const Tell& note);

/// Returns the JSON of schema mindahl.sweep/1, as `mindahl fit --sweep --json` writes it.
std::string ToJson(const FittedSweep& fitted);

/// Returns the text that `mindahl fit --sweep` prints.
std::string ToText(const FittedSweep& fitted);

}  // namespace mindahl::request
