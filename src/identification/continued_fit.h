#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "mindahl/core/error.h"
#include "mindahl/identification/fit.h"

namespace mindahl::identification {

/// True if the fit found parameters.
inline bool IsFitted(const FitResult& fit) { return !fit.parameters.empty(); }

/// Gives the options the values that a fit found, for a search to begin with.
inline void StartFrom(const FitResult& fit, FitOptions& options) {
  for (const ParameterEstimate& parameter : fit.parameters) {
    if (parameter.status != ParameterStatus::kFixed) {
      options.start[parameter.name] = parameter.value;
    }
  }
}

/// Samples [begin, end) of a record.
struct SampleRange {
  std::size_t record = 0;
  std::size_t begin = 0;
  std::size_t end = 0;
};

/// Fits without some samples, which still make history; without parameters and not converged where
/// a term is not identifiable, the rig softer than it can be, or samples are too few.
inline FitResult FitWithout(std::span<const SampleRange> held_out,
                            std::span<const loop::RecordView> records, FitOptions options,
                            Depth depth = Depth::kEstimate) {
  std::vector<std::vector<bool>>& masks = options.preparation.held_out;
  if (!held_out.empty()) masks.resize(records.size());
  for (std::size_t r = 0; r < masks.size(); ++r) masks[r].resize(records[r].size());
  for (const auto& [record, begin, end] : held_out) {
    for (std::size_t i = begin; i < end; ++i) masks[record][i] = true;
  }
  try {
    return Fitter(std::move(options)).Fit(records, depth);
  } catch (const InvalidArgument&) {
    return {};
  }
}

}  // namespace mindahl::identification
