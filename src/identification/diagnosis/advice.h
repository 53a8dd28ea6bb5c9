#pragma once

#include <string>
#include <string_view>

#include "identification/problem/problem.h"
#include "mindahl/identification/fit_options.h"

namespace mindahl::identification {

/// Returns the options, as a cause names them, that the program accepts in addition to those of the
/// fit: as they are, with what they need in addition, or nothing where they would be refused. Every
/// advice is checked here, against what the fit's own requirements refuse.
/// @param wanted  words of the command line, e.g. "--viscous fit --speed-exponent fit"; may be
/// empty
std::string AcceptedOptions(const Problem& problem, const FitOptions& options,
                            std::string_view wanted);

}  // namespace mindahl::identification
