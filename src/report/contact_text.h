#pragma once

#include <string>

#include "mindahl/report/report.h"

namespace mindahl::report {

// Describes the contact that a fit identifies, in words; each text is of whole lines.

/// Lists the identified quantities with their formulas, and the inputs that the rest needs.
std::string ContactText(const Report& report);

/// Lists what Hertz and Mindlin predict; empty where load, materials or radii are not known.
std::string HertzText(const Report& report);

/// Returns the contact under each load of a series, and the theories of the load's exponent; empty
/// without a series.
std::string LoadSeriesText(const Report& report);

/// Tests whether it is Mindlin's contact: α against 1/3 and σ against 8a/G*.
std::string MappingText(const Report& report);

}  // namespace mindahl::report
