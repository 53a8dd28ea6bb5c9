#pragma once

#include <optional>
#include <span>
#include <vector>

#include "mindahl/identification/fit_options.h"
#include "mindahl/identification/fit_result.h"
#include "mindahl/loop/record.h"

namespace mindahl::identification {

/// A value with the ends of its 95 % interval.
struct BandValue {
  double value = 0.0;
  double lower95 = 0.0;
  double upper95 = 0.0;
};

/// The backbone at one displacement.
struct BackbonePoint {
  double displacement = 0.0;  ///< [m] on the virgin curve
  BandValue force;            ///< [N]
  double law = 0.0;           ///< force of the fitted law [N], behind its rig
};

/// Jenkins elements whose slip displacements lie in one range.
struct SlipShare {
  double from = 0.0;       ///< [m]
  double to = 0.0;         ///< [m]
  double stiffness = 0.0;  ///< [N/m], >= 0: −f″ over the range
};

/// A backbone without an assumed law: the distribution of slip displacements of Jenkins elements in
/// parallel (Iwan 1966), with the part that never slips within the record.
struct BackboneEstimate {
  std::vector<BackbonePoint> points;  ///< from 0 to the largest displacement
  std::vector<SlipShare> elements;
  BandValue first_stiffness;  ///< [N/m] secant over the first hundredth of the displacement
  BandValue elastic;          ///< stiffness [N/m] of the part that does not slip within the record
  double smoothing = 0.0;     ///< regularisation over the weight of the data [–]
  double effective_samples = 0.0;
  double rms = 0.0;  ///< rms residual of the backbone [N]
  /// True if the stiffness that never slips is surely below a fiftieth of the first stiffness.
  bool reaches_plateau = false;
};

/// True if the backbone is defined: a fit of forces, one load, no lag, Masing's memory.
bool HasBackbone(const FitResult& fit);

/// Estimates the backbone F(x) = Σ wₖ·pₖ(x) + w∞·x, wₖ ≥ 0, of which the records' forces are
///   T = Σ s·m·F(|Δδ|/m) along branches + offset,  m = 1 on the virgin branch, else 2
/// (docs/theory.md §5 and §13), by least squares. Of all distributions of slip displacements that
/// cost the likelihood no more than 2 ln Λ = 1 it is the smoothest over their logarithm. The band
/// is that of 400 draws of the residuals' own noise, and of the smoothness, fitted again. Initial
/// state, reversals, sign of the force and all terms besides the contact's force are the fit's.
/// @param records  those that were fitted
/// @param options  that they were fitted with
/// @throws InvalidArgument unless HasBackbone(fit)
/// Cost: 45 columns a sample, 360 bytes.
BackboneEstimate EstimateBackbone(std::span<const loop::RecordView> records,
                                  const FitOptions& options, const FitResult& fit);

}  // namespace mindahl::identification
