#pragma once

#include <memory_resource>
#include <vector>

#include "loop/rules.h"
#include "mindahl/loop/disturbances.h"
#include "mindahl/loop/record.h"

namespace mindahl::loop {

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
/// @param record  valid
/// @param memory  of the result and of scratch
Mended FindAndMend(const RecordView& record, const GlitchRules& rules,
                   std::pmr::memory_resource* memory);

}  // namespace mindahl::loop
