#pragma once

#include <string>

#include "mindahl/report/report.h"

namespace mindahl::report {

// What a fit says of the contact, in words; each of whole lines.

/// What is identified of it, with the formula, and what would have to be known for the rest.
std::string ContactText(const Report& report);

/// Besides: what Hertz and Mindlin predict; empty where load, materials or radii are not known.
std::string HertzText(const Report& report);

/// The contact under each load of a series, and the theories of the load's exponent; empty
/// without a series.
std::string LoadSeriesText(const Report& report);

/// Is it Mindlin's contact? α against 1/3 and σ against 8a/G*.
std::string MappingText(const Report& report);

}  // namespace mindahl::report
