#pragma once

#include <optional>
#include <span>

#include "identification/problem/scaled_records.h"
#include "mindahl/identification/fit_options.h"
#include "mindahl/identification/fit_result.h"
#include "mindahl/loop/record.h"

namespace mindahl::identification {

/// Masing's law against Dahl's own, whichever of them was fitted, by AICc on the effective samples
/// of the one that leaves less. The other is fitted too where the record may distinguish them, from
/// where its loop at the widest amplitude would be the same; of one amplitude it follows in closed
/// form.
/// @param data  the records, scaled
/// @param fit   of them, from Depth::kErrors on
/// @returns empty where the laws are one (α = 0), and where they are not compared
std::optional<LawChoice> CompareLaws(std::span<const loop::RecordView> records,
                                     const FitOptions& options, const ScaledRecords& data,
                                     const FitResult& fit);

}  // namespace mindahl::identification
