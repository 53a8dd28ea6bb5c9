#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "mindahl/identification/fit_options.h"
#include "mindahl/io/record_stream.h"
#include "mindahl/loop/record.h"
#include "mindahl/loop/reversals.h"

namespace mindahl::campaign {

/// How all cycles of a long record are read, by its first samples.
struct Reading {
  loop::ReversalGate gate;  ///< `certain` where it was given
  bool gate_is_given = false;
  std::size_t samples = 0;  ///< number of samples examined
};

/// Returns the samples as every stage takes them, valid as long as they.
loop::RecordView ViewOf(const io::Samples& samples);

/// Reads the first samples, as many as determine how the record is read: some cycles, or the
/// first million.
io::Samples ReadHead(io::RecordStream& stream);

/// Chooses the reversal gate and the force's sign, one for all cycles.
/// @param fit  written: both
/// @throws InputError where the head shows no turning points
Reading ChooseReading(const loop::RecordView& head, identification::FitOptions& fit);

/// Returns a sentence where the reversals are uncertain; empty where they are not.
/// @param source  what was read
std::optional<std::string> DoubtAbout(const Reading& reading, std::string_view source);

/// @param cycles    whole ones that were found
/// @param together  that were to be fitted as one
/// @param gate      [m] in use
/// @param source    what was read, for messages
/// @throws InputError unless there is one
void RequireCycles(std::size_t cycles, std::size_t together, const Reading& reading, double gate,
                   std::string_view source);

}  // namespace mindahl::campaign
