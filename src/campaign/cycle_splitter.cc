#include "mindahl/campaign/cycle_splitter.h"

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "mindahl/core/error.h"

namespace mindahl::campaign {
namespace {

template <typename Value>
void AppendColumn(std::span<const Value> from, std::vector<Value>& to) {
  to.insert(to.end(), from.begin(), from.end());
}

/// From `begin` to before `end`; nothing of what is not recorded.
std::vector<double> PartOf(const std::vector<double>& values, std::size_t begin, std::size_t end) {
  if (values.empty()) return {};
  return {values.begin() + static_cast<std::ptrdiff_t>(begin),
          values.begin() + static_cast<std::ptrdiff_t>(end)};
}

template <typename Value>
void EraseFirst(std::vector<Value>& values, std::size_t count) {
  if (values.empty()) return;
  values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count));
}

}  // namespace

CycleSplitter::CycleSplitter(double gate, std::size_t together)
    : gate_(gate), together_(together), finder_(gate) {
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
                               .normal_load = part(kept_.normal_load)}});
  cycles_ += together_;
  begin_ = turn;
  turns_ = 1;
}

std::size_t CycleSplitter::Restart() {
  const std::size_t left = kept_.size();
  kept_ = {};
  lines_.clear();
  finder_ = loop::ReversalFinder(gate_);
  dropped_ = 0;
  begin_ = 0;
  turns_ = 0;
  return left;
}

}  // namespace mindahl::campaign
