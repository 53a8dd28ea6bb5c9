#include "mindahl/campaign/cycle_splitter.h"

#include <fmt/format.h>

#include <bit>
#include <memory_resource>
#include <optional>
#include <utility>

#include "mindahl/core/error.h"
#include "mindahl/loop/preparation.h"

namespace mindahl::campaign {

namespace {

template <typename Column, typename Value>
void AppendColumn(const Column& from, std::vector<Value>& to) {
  to.insert(to.end(), from.begin(), from.end());
}

/// Returns the values from `begin` to before `end`; nothing where not recorded.
std::vector<double> PartOf(const std::vector<double>& values, std::size_t begin, std::size_t end) {
  if (values.empty()) return {};
  return {values.begin() + static_cast<std::ptrdiff_t>(begin),
          values.begin() + static_cast<std::ptrdiff_t>(end)};
}

/// Stirs a word into a checksum: the finaliser of SplitMix64 (Steele, Lea & Flood 2014), which
/// takes every 64-bit word to another.
std::uint64_t Stir(std::uint64_t checksum, std::uint64_t word) {
  std::uint64_t mixed = (checksum ^ word) + 0x9e3779b97f4a7c15U;
  mixed = (mixed ^ (mixed >> 30)) * 0xbf58476d1ce4e5b9U;
  mixed = (mixed ^ (mixed >> 27)) * 0x94d049bb133111ebU;
  return mixed ^ (mixed >> 31);
}

template <typename Value>
void EraseFirst(std::vector<Value>& values, std::size_t count) {
  if (values.empty()) return;
  values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count));
}

}  // namespace

CycleSplitter::CycleSplitter(double gate, std::size_t together, std::uint64_t seed)
    : gate_(gate), together_(together), finder_(gate), checksum_(seed) {
  RequireNonNegative("reversal gate [m]", gate);
  if (together < 1) ThrowInvalid("cycles to a piece [-]", 0, "must be >= 1");
}

void CycleSplitter::Add(const loop::RecordView& samples, std::span<const std::size_t> lines,
                        std::vector<Cycle>& cycles) {
  AppendColumn(samples.displacement, kept_.displacement);
  AppendColumn(samples.force, kept_.force);
  AppendColumn(samples.time, kept_.time);
  AppendColumn(samples.normal_load, kept_.normal_load);
  AppendColumn(lines, lines_);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const std::optional<std::size_t> turn = finder_.Add(samples.displacement[i]);
    if (turn) Complete(*turn, cycles);
  }
  EraseFirst(kept_.displacement, begin_);
  EraseFirst(kept_.force, begin_);
  EraseFirst(kept_.time, begin_);
  EraseFirst(kept_.normal_load, begin_);
  EraseFirst(lines_, begin_);
  summed_ -= begin_;
  dropped_ += std::exchange(begin_, 0);
  if (kept_.size() > kMostSamples) {
    throw InvalidArgument(
        fmt::format("more than {} samples without a whole cycle, from line {} on: the displacement "
                    "does not turn by more than {} m",
                    kMostSamples, lines_.front(), gate_));
  }
}

void CycleSplitter::Complete(std::size_t turning_point, std::vector<Cycle>& cycles) {
  const std::size_t turn = turning_point - dropped_;
  SumUpTo(turn + 1);
  if (turns_ == 0) begin_ = turn;
  if (turns_ < 2 * together_) {
    ++turns_;
    return;
  }
  const auto part = [&](const std::vector<double>& values) {
    return PartOf(values, begin_, turn + 1);
  };
  cycles.push_back({.number = cycles_ + 1,
                    .first_line = lines_[begin_],
                    .record = {.displacement = part(kept_.displacement),
                               .force = part(kept_.force),
                               .time = part(kept_.time),
                               .normal_load = part(kept_.normal_load)},
                    .checksum = checksum_});
  cycles_ += together_;
  begin_ = turn;
  turns_ = 1;
}

void CycleSplitter::SumUpTo(std::size_t end) {
  for (; summed_ < end; ++summed_) {
    checksum_ = Stir(checksum_, lines_[summed_]);
    for (const std::vector<double>* channel :
         {&kept_.displacement, &kept_.force, &kept_.time, &kept_.normal_load}) {
      if (channel->empty()) continue;
      checksum_ = Stir(checksum_, std::bit_cast<std::uint64_t>((*channel)[summed_]));
    }
  }
}

std::size_t CycleSplitter::Restart() {
  const std::size_t left = kept_.size();
  SumUpTo(left);
  summed_ = 0;
  kept_ = {};
  lines_.clear();
  finder_ = loop::ReversalFinder(gate_);
  dropped_ = 0;
  begin_ = 0;
  turns_ = 0;
  return left;
}

using identification::FitOptions;

namespace {

void AppendSamples(const io::Samples& from, io::Samples& to) {
  AppendColumn(from.displacement, to.displacement);
  AppendColumn(from.force, to.force);
  AppendColumn(from.time, to.time);
  AppendColumn(from.normal_load, to.normal_load);
  AppendColumn(from.lines, to.lines);
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
      "{}: the number of reversals is not certain: in the first {} samples {} with a gate of "
      "{:.3g} m, {} with {:.3g} m: set --reversal-gate",
      source, reading.samples, reading.gate.count, reading.gate.gate, reading.gate.other_count,
      reading.gate.other_gate);
}

void RequireCycles(std::size_t cycles, std::size_t together, const Reading& reading, double gate,
                   std::string_view source) {
  if (cycles > 0) return;
  if (reading.gate.count > 2) {
    throw InputError(
        fmt::format("--average {}: {} has only {} reversals, two a cycle: average fewer", together,
                    source, reading.gate.count));
  }
  throw InputError(fmt::format(
      "{}: no whole cycle: the displacement turns {} times by more than {:.3g} m: choose another "
      "column with --displacement, or a smaller --reversal-gate",
      source, reading.gate.count, gate));
}

}  // namespace mindahl::campaign
