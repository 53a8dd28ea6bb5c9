#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

#include "identification/inference/noise.h"
#include "identification/problem/problem.h"

namespace mindahl::identification {

/// Single readings that are far off, which no column of forces is in proportion to.
inline constexpr std::string_view kHeavyTails = "heavy_tails";
inline constexpr std::string_view kHeavyTailsMeaning =
    "fraction of the readings that are far off both their neighbours";

/// Readings far off in the residuals of a fit.
struct HeavyTails {
  double p_value = 1.0;     // that noise alone makes them
  double delta_aicc = 0.0;  // against one width of noise
  double explains = 0.0;    // fraction of the sum of squares
  double fraction = 0.0;    // of the readings
};

/// Samples of a fit one by one, those that were measured, record after record.
struct FittedSample {
  std::size_t record = 0;
  double response = 0.0;  // of the contact over the slip force
  double residual = 0.0;  // weighted, model − measured
  bool counts = false;
  bool turns = false;  // the motion turns there
};

/// Readings that are far off both their neighbours, more of them than noise of one width makes.
///   uᵢ = rᵢ − (rᵢ₋₁ + rᵢ₊₁)/2
/// is free of whatever is smooth along the loop. A reading is off where |uᵢ| is beyond six
/// deviations of the samples on which the force is as steep, by their median, and its neighbours'
/// are of the other sign: a corner of the residuals, or a step, is none.
/// @returns empty where there is none
std::optional<HeavyTails> FindHeavyTails(std::span<const FittedSample> samples,
                                         const Evidence& evidence);

/// Finds them in the weighted residuals of all samples of a problem. Cost: n log n, negligible
/// against a fit.
std::optional<HeavyTails> FindHeavyTails(const Problem& problem, std::span<const double> theta,
                                         std::span<const double> residual, const Noise& noise,
                                         Response& response);

}  // namespace mindahl::identification
