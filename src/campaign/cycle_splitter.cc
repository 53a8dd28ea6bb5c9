#include "mindahl/campaign/cycle_splitter.h"

#include <fmt/format.h>

#include <array>
#include <optional>
#include <utility>

#include "mindahl/core/error.h"
#include "mindahl/loop/preparation.h"

namespace mindahl::campaign {
namespace {

void Append(const loop::RecordView& samples, std::span<const std::size_t> lines, io::Samples& to) {
  const std::array columns = {samples.displacement, samples.force, samples.time,
                              samples.normal_load};
  for (std::size_t k = 0; k < columns.size(); ++k) {
    std::vector<double>& column = to.*loop::kRecordColumns[k];
    column.insert(column.end(), columns[k].begin(), columns[k].end());
  }
  to.lines.insert(to.lines.end(), lines.begin(), lines.end());
}

}  // namespace

CycleSplitter::CycleSplitter(double gate, std::size_t together)
    : gate_(gate), together_(together), finder_(gate) {
  RequireNonNegative("reversal gate [m]", gate);
  if (together < 1) ThrowInvalid("cycles to a piece [-]", 0, "must be >= 1");
}

void CycleSplitter::Add(const loop::RecordView& samples, std::span<const std::size_t> lines,
                        std::vector<Cycle>& cycles) {
  Append(samples, lines, kept_);
  for (const double displacement : samples.displacement) {
    const std::optional<std::size_t> turn = finder_.Add(displacement);
    if (!turn) continue;
    if (turns_ == 0) begin_ = *turn - dropped_;
    if (turns_ % 2 == 0) end_ = *turn - dropped_;
    if (turns_++ == 2 * together_) TakeOff(cycles);
  }
  const auto end = static_cast<std::ptrdiff_t>(begin_);
  const auto erase_before = [end](auto& values) {
    if (!values.empty()) values.erase(values.begin(), values.begin() + end);
  };
  for (const auto column : loop::kRecordColumns) erase_before(kept_.*column);
  erase_before(kept_.lines);
  end_ -= begin_;
  dropped_ += std::exchange(begin_, 0);
  if (kept_.size() > kMostSamples) {
    throw InvalidArgument(
        fmt::format("more than {} samples without a whole cycle, from line {} on: the displacement "
                    "does not turn by more than {} m",
                    kMostSamples, kept_.lines.front(), gate_));
  }
}

void CycleSplitter::TakeOff(std::vector<Cycle>& cycles) {
  const std::size_t count = (turns_ - 1) / 2;
  Cycle& cycle = cycles.emplace_back(Cycle{
      .number = cycles_ + 1, .cycles = count, .first_line = kept_.lines[begin_], .record = {}});
  for (const auto column : loop::kRecordColumns) {
    const std::span<const double> values = kept_.*column;
    if (values.empty()) continue;
    const auto own = values.subspan(begin_, end_ + 1 - begin_);
    (cycle.record.*column).assign(own.begin(), own.end());
  }
  cycles_ += count;
  begin_ = end_;
  turns_ = 1;
}

std::size_t CycleSplitter::Restart(std::vector<Cycle>& cycles) {
  if (turns_ >= 3) TakeOff(cycles);
  const std::size_t left = kept_.size() - begin_;
  const std::size_t cycles_so_far = cycles_;
  *this = CycleSplitter(gate_, together_);
  cycles_ = cycles_so_far;
  return left;
}

io::Samples ReadHead(io::RecordStream& stream) {
  constexpr std::size_t kReversals = 8;
  constexpr std::size_t kMostSamples = 1'000'000;
  io::Samples head;
  io::Samples piece;
  std::size_t next_look = 1;  // at twice as much each time: a look is at all of it
  while (head.size() < kMostSamples && stream.Next(piece)) {
    Append(piece, piece.lines, head);
    if (head.size() < next_look) continue;
    const double gate = loop::ChooseReversalGate(head.displacement).gate;
    if (loop::FindReversals(head.displacement, gate).size() >= kReversals) break;
    next_look = 2 * head.size();
  }
  return head;
}

loop::ReversalGate ChooseGate(const loop::RecordView& head, identification::FitOptions& fit) {
  const loop::PreparedRecords prepared = loop::Prepare({&head, 1}, fit.preparation);
  fit.preparation.reversal_gate = prepared.records.front().gate.gate;
  fit.preparation.force_sense = prepared.force_sense;
  return prepared.records.front().gate;
}

}  // namespace mindahl::campaign
