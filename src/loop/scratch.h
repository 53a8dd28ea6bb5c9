#pragma once

#include <cstddef>
#include <memory_resource>
#include <span>
#include <vector>

#include "loop/rules.h"
#include "mindahl/loop/cycles.h"
#include "mindahl/loop/disturbances.h"
#include "mindahl/loop/record.h"
#include "mindahl/loop/reversals.h"

namespace mindahl::loop {

/// The public functions of this module with their scratch, and what they return, in a memory that
/// the caller gives: for stages that are run again and again. The record is valid.

void FindReversals(std::span<const double> displacement, double gate,
                   std::pmr::vector<std::size_t>& reversals);
ReversalGate ChooseReversalGate(std::span<const double> displacement, const ReversalRules& rules,
                                std::pmr::memory_resource* scratch);
double EstimateDisplacementNoise(std::span<const double> displacement,
                                 std::pmr::memory_resource* scratch);
LoopMeasures MeasureLoop(const RecordView& record, std::span<const std::size_t> reversals,
                         std::pmr::memory_resource* scratch);
int ForceSense(const RecordView& record, std::span<const std::size_t> reversals,
               std::pmr::memory_resource* scratch);

/// Returns the measures of the record whose force has its sign changed, for a sign of −1.
LoopMeasures InSense(LoopMeasures measures, int force_sense);

/// A record without its glitches: lines over the samples that are left out. All empty where there
/// is no glitch; a channel is also empty where there is none in it.
struct Mended {
  explicit Mended(std::pmr::memory_resource* memory)
      : glitches(memory), displacement(memory), force(memory) {}

  std::pmr::vector<Glitch> glitches;
  std::pmr::vector<double> displacement;  // [m]
  std::pmr::vector<double> force;         // [N]
};

/// Returns the glitches of FindGlitches, and what is left.
/// @param memory  of the result and of scratch
Mended FindAndMend(const RecordView& record, const GlitchRules& rules,
                   std::pmr::memory_resource* memory);

}  // namespace mindahl::loop
