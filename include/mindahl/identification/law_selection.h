#pragma once

#include "mindahl/identification/fit.h"

namespace mindahl::identification {

/// True if a record that Masing's law was fitted to may follow Dahl's own: that is preferred by the
/// comparison of a fit at Depth::kFull, or that is undecided and the model not adequate. False
/// where the two cannot be compared: where σ or Tc is held, slip forces differ or the load varies.
/// @param options  of the fit
bool MayFollowOtherLaw(const FitResult& fit, const FitOptions& options);

/// True if another law describes the same records better beyond doubt,
///   AICc(than) − AICc(other) >= Thresholds::rival_law,
/// on the effective samples of the one with the smaller rms. False where a parameter of the other
/// ended at a bound.
/// @param than, other  fits of the same samples from depth kIntervals on
bool IsBetterLaw(const FitResult& other, const FitResult& than, const Thresholds& thresholds);

}  // namespace mindahl::identification
