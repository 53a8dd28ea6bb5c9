#include "mindahl/campaign/reading.h"

#include <fmt/format.h>

#include <memory_resource>

#include "mindahl/core/error.h"
#include "mindahl/loop/preparation.h"

namespace mindahl::campaign {

using identification::FitOptions;

namespace {

void AppendSamples(const io::Samples& from, io::Samples& to) {
  const auto append = [](const auto& source, auto& target) {
    target.insert(target.end(), source.begin(), source.end());
  };
  append(from.displacement, to.displacement);
  append(from.force, to.force);
  append(from.time, to.time);
  append(from.normal_load, to.normal_load);
  append(from.lines, to.lines);
}

}  // namespace

loop::RecordView ViewOf(const io::Samples& samples) {
  return {samples.displacement, samples.force, samples.time, samples.normal_load};
}

io::Samples ReadHead(io::RecordStream& stream) {
  constexpr std::size_t kReversals = 8;
  constexpr std::size_t kMostSamples = 1'000'000;
  io::Samples head;
  io::Samples piece;
  std::size_t next_look = 1;  // at twice as much each time: a look is at all of it
  while (head.size() < kMostSamples && stream.Next(piece)) {
    AppendSamples(piece, head);
    if (head.size() < next_look) continue;
    if (loop::ChooseReversalGate(head.displacement).count >= kReversals) break;
    next_look = 2 * head.size();
  }
  return head;
}

Reading ChooseReading(const loop::RecordView& head, FitOptions& fit) {
  std::pmr::monotonic_buffer_resource memory;
  const loop::PreparedRecords prepared = loop::Prepare({&head, 1}, fit.preparation, &memory);
  const loop::PreparedRecord& record = prepared.records.front();
  const Reading reading{.gate = record.gate_choice,
                        .gate_is_given = fit.preparation.reversal_gate.has_value(),
                        .samples = head.size()};
  fit.preparation.reversal_gate = record.reversal_gate;
  fit.preparation.force_sense = prepared.force_sense;
  return reading;
}

std::optional<std::string> DoubtAbout(const Reading& reading, std::string_view source) {
  if (reading.gate.certain) return std::nullopt;
  return fmt::format(
      "{}: the reversals are uncertain: of its first {} samples {} by a gate of {:.3g} m, {} by "
      "{:.3g} m: set --reversal-gate",
      source, reading.samples, reading.gate.count, reading.gate.gate, reading.gate.other_count,
      reading.gate.other_gate);
}

void RequireCycles(std::size_t cycles, std::size_t together, const Reading& reading, double gate,
                   std::string_view source) {
  if (cycles > 0) return;
  if (reading.gate.count > 2) {
    throw InputError(fmt::format("--average {}: {} turn only {} times, two a cycle: average fewer",
                                 together, source, reading.gate.count));
  }
  throw InputError(fmt::format(
      "{}: no whole cycle: the displacement turns {} times by more than {:.3g} m: choose another "
      "column with --displacement, or a smaller --reversal-gate",
      source, reading.gate.count, gate));
}

}  // namespace mindahl::campaign
