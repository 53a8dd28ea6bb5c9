#include "identification/misfit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "identification/verdicts.h"

namespace mindahl::identification {
namespace {

/// Of the variance of the residuals, where they are poor and where they fail; less is noise.
constexpr double kRepeats = 0.3;
constexpr double kRepeatsAtAll = 0.1;
/// rms over Tc, or over T* if that is smaller: from here on a curve is visibly another one,
constexpr double kPoor = 0.02;
/// and from here on no parameter but Tc should be believed.
constexpr double kFails = 0.1;

struct Peak {
  int direction = 1;
  StrokeBin bin;
};

Peak LargestBin(const ResidualStructure& structure) {
  Peak peak;
  for (const StrokeResiduals& direction : structure.directions) {
    for (const StrokeBin& bin : direction.bins) {
      if (std::abs(bin.mean) > std::abs(peak.bin.mean)) peak = {direction.direction, bin};
    }
  }
  return peak;
}

/// Correlation between the residuals of the two directions, over the same part of the stroke since
/// the reversal, or at the same displacement.
double Correlation(const ResidualStructure& structure, bool at_same_displacement) {
  const auto& up = structure.directions[0].bins;
  const auto& down = structure.directions[1].bins;
  if (up.size() != down.size() || up.empty()) return 0.0;
  double product = 0.0;
  double up_squares = 0.0;
  double down_squares = 0.0;
  for (std::size_t i = 0; i < up.size(); ++i) {
    const double other = down[at_same_displacement ? down.size() - 1 - i : i].mean;
    product += up[i].mean * other;
    up_squares += up[i].mean * up[i].mean;
    down_squares += other * other;
  }
  return up_squares > 0 && down_squares > 0 ? product / std::sqrt(up_squares * down_squares) : 0.0;
}

std::string Kind(const ResidualStructure& structure, const Peak& peak) {
  constexpr double kAlike = 0.6;
  constexpr double kEarly = 0.25;  // of the stroke
  // A force of position is the same on the way back; one of direction turns its sign.
  if (Correlation(structure, /*at_same_displacement=*/true) > kAlike) {
    return "the same on the way back: a force that depends on the position";
  }
  const bool mirrored = Correlation(structure, /*at_same_displacement=*/false) < -kAlike;
  if (peak.bin.position < kEarly) {
    return mirrored
               ? "mirrored on the way back, after each reversal: backlash, or a stiffness that "
                 "is not the contact's"
               : "after the reversal, unlike on the way back: backlash on one side, or a drive "
                 "that is not symmetric";
  }
  return mirrored ? "mirrored on the way back: the shape of the loop is another one"
                  : "unlike in the two directions: friction that is not symmetric";
}

}  // namespace

void JudgeMisfit(FitResult& result) {
  // Where the slip force is open it says nothing of how well the loop is followed.
  const double force = std::min(result.law.slip_force, result.WidestRecord().measures.peak_force);
  if (!(force > 0)) return;
  const double poor = result.residuals.rms / force;
  if (!(poor > kPoor)) return;
  for (std::size_t r = 0; r < result.records.size(); ++r) {
    const ResidualStructure& structure = result.records[r].structure;
    if (structure.repeatable_share < (poor > kFails ? kRepeatsAtAll : kRepeats)) continue;
    const Peak peak = LargestBin(structure);
    const std::string where = fmt::format(
        "{:.0f} % of the residuals' variance comes back in every stroke, up to {:.3g} N {:.0f} % "
        "of "
        "the way {}; {}",
        100 * structure.repeatable_share, std::abs(peak.bin.mean), 100 * peak.bin.position,
        peak.direction > 0 ? "up" : "down", Kind(structure, peak));
    if (poor > kFails) {
      Warn(result, "no_model_fits",
           fmt::format(
               "no parameters of {} follow this record (rms {:.3g} % of the force): {}. Tc and the "
               "energy may still be of use, sigma and alpha not",
               result.model->name, 100 * poor, where));
      for (ParameterEstimate& estimate : result.parameters) {
        const bool of_the_shape = estimate.name == "sigma" || estimate.name == "alpha";
        if (of_the_shape && estimate.status != ParameterStatus::kFixed) {
          estimate.identifiability = Identifiability::kNotIdentifiable;
        }
      }
    } else {
      Warn(result, "systematic_residual",
           fmt::format(
               "{} misses something systematic (rms {:.3g} % of the force): {}. Intervals are "
               "widened for it; compare with --model auto",
               result.model->name, 100 * poor, where));
    }
    return;
  }
}

}  // namespace mindahl::identification
