#pragma once

#include <CLI/App.hpp>
#include <string>

#include "mindahl/identification/fit_result.h"

namespace mindahl::cli {

/// Requirements of `--strict` on a fit.
enum class Strictness {
  kNone,      ///< the fit converged
  kDoubtful,  ///< also that the model is not inadequate and every free parameter known
  kAdequate,  ///< also that the model is adequate and every free parameter identifiable
};

/// Returns true if a fit is done, for the exit status.
bool Established(const identification::FitResult& fit, Strictness strictness);

/// Adds `--strict`, which asks for kAdequate, and `--strict=doubtful`.
/// @param otherwise  what happens to a fit that is not: "exit status 3"
void AddStrict(CLI::App& command, Strictness& strictness, const std::string& otherwise,
               const std::string& group);

}  // namespace mindahl::cli
