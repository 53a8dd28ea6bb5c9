#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mindahl/identification/fit_options.h"
#include "mindahl/identification/fit_result.h"
#include "mindahl/loop/record.h"

namespace mindahl::identification {

/// Terms that may be added together, or a column of the records.
struct TermChoice {
  std::vector<std::string> terms;
  std::string covariate;  // its name; empty where it is none

  [[nodiscard]] FitOptions AddedTo(FitOptions options) const;
};

/// Predicts, to first order, a fit with some more terms.
struct TermScore {
  double gain = 0.0;            // fraction by which the choice lowers the rms
  double p_value = 1.0;         // that chance alone makes its effect
  double rms = 0.0;             // of all samples after the step [N]
  std::size_t parameters = 0;   // that it adds
  bool is_negative = false;     // a mass or a damping would be
  std::array<double, 3> law{};  // by how much θ of σ, α and Tc moves
};

/// Scores choices by one Gauss-Newton step from a fit that has none of them, by the products of its
/// Jacobian and the derivatives by their parameters. Exact for terms that are linear.
/// @param options  of the fit
/// @returns a score a choice; nothing where it has no effect
/// @throws InvalidArgument as the fit would
std::vector<std::optional<TermScore>> ScoreTerms(std::span<const loop::RecordView> records,
                                                 const FitResult& fit, const FitOptions& options,
                                                 std::span<const TermChoice> choices);

}  // namespace mindahl::identification
