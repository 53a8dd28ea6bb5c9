#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "identification/inference/noise.h"
#include "identification/problem/problem.h"

namespace mindahl::identification {

/// Something in a record that comes and goes, so that no column of forces is in proportion to it:
/// the residuals have a statistic of their own for it.
struct Irregularity {
  std::string_view code;
  std::string_view meaning;  // of the size
  std::string_view unit;
  std::string_view option;  // of the command line; empty where there is none
};

/// Holds the fit of one of them to the residuals.
struct IrregularityFit {
  std::size_t irregularity = 0;  // its place in Irregularities()
  double p_value = 1.0;          // that noise alone makes it
  double delta_aicc = 0.0;       // against the fit without
  double explains = 0.0;         // fraction of the sum of squares
  double size = 0.0;             // in its unit, forces in units of the data
};

std::span<const Irregularity> Irregularities();

/// Samples of a fit one by one, those that were measured, record after record.
struct FittedSample {
  std::size_t record = 0;
  double displacement = 0.0;
  double response = 0.0;  // of the contact over the slip force
  double residual = 0.0;  // weighted, model − measured
  bool counts = false;
  bool turns = false;  // the motion turns there
};

/// Finds those that the residuals show, if identifiable. Cost: n log n, negligible against a fit.
/// @param residual  weighted, of all samples
/// @param robust    large residuals count less already, and are not looked for
/// @param doubtful  then a ripple is looked for, and else only where the force drops: it costs more
///   than the rest
std::vector<IrregularityFit> FindIrregularities(const Problem& problem,
                                                std::span<const double> theta,
                                                std::span<const double> residual,
                                                const Noise& noise, bool robust, bool doubtful,
                                                Response& response);

}  // namespace mindahl::identification
