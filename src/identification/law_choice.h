#pragma once

#include <optional>
#include <span>

#include "identification/problem/scaled_records.h"
#include "mindahl/identification/fit_options.h"
#include "mindahl/identification/fit_result.h"
#include "mindahl/loop/record.h"

namespace mindahl::identification {

/// True if all swings of the records are as wide as the widest, those to their ends no wider. Then
/// a steady contact of Masing's law and one of Dahl's own run along one curve, each with a σ and a
/// Tc of its own (models/steady_loop.h).
bool HasOneAmplitude(const ScaledRecords& data, const Thresholds& thresholds);

/// True if the record hardly distinguishes Masing's law from Dahl's own.
/// @param delta_aicc  of the two
bool LawIsUndecided(double delta_aicc, const Thresholds& thresholds);

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
