#include "mindahl/campaign/cycle_splitter.h"

#include <array>

#include "core/refuse.h"
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
    if (const auto turn = finder_.Add(displacement)) turns_.push_back(*turn);
    if (turns_.size() > 2 * together_) TakeOff(cycles);
  }
  const auto unused = static_cast<std::ptrdiff_t>(Begin());
  const auto drop = [unused](auto& values) {
    if (!values.empty()) values.erase(values.begin(), values.begin() + unused);
  };
  dropped_ += Begin();
  for (const auto column : loop::kRecordColumns) drop(kept_.*column);
  drop(kept_.lines);
  if (kept_.size() > kMostSamples) {
    Refuse<InvalidArgument>(
        "more than {} samples without a whole cycle, from line {} on: the displacement does not "
        "turn by more than {} m",
        kMostSamples, kept_.lines.front(), gate_);
  }
}

void CycleSplitter::TakeOff(std::vector<Cycle>& cycles) {
  const std::size_t count = (turns_.size() - 1) / 2;
  const auto last = turns_.begin() + static_cast<std::ptrdiff_t>(2 * count);
  const std::size_t size = *last - turns_.front() + 1;
  Cycle& cycle = cycles.emplace_back(Cycle{
      .number = cycles_ + 1, .cycles = count, .first_line = kept_.lines[Begin()], .record = {}});
  for (const auto column : loop::kRecordColumns) {
    const std::span<const double> values = kept_.*column;
    if (values.empty()) continue;
    const auto own = values.subspan(Begin(), size);
    (cycle.record.*column).assign(own.begin(), own.end());
  }
  cycles_ += count;
  turns_.erase(turns_.begin(), last);
}

std::size_t CycleSplitter::Restart(std::vector<Cycle>& cycles) {
  if (turns_.size() >= 3) TakeOff(cycles);
  const std::size_t left = kept_.size() - Begin();
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
