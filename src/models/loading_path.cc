#include "mindahl/models/loading_path.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/extremes.h"
#include "mindahl/core/error.h"
#include "models/madelung.h"

namespace mindahl::models {
namespace {

std::int8_t SignOf(double value) { return value < 0 ? std::int8_t{-1} : std::int8_t{1}; }

/// The branches that are open at the present displacement, oldest first. The only state is the
/// stack: the origins on it are the surviving extrema.
class OpenBranches {
 public:
  /// Opens what is open before the first sample.
  OpenBranches(std::span<const double> displacement, std::span<const Turn> turns, Memory memory,
               const InitialContact& initial, LoadingPath& path)
      : path_(path),
        memory_(memory),
        asymmetry_(initial.state == InitialState::kVirgin ? initial.asymmetry : 0.0) {
    const double first_extreme = turns.empty() ? displacement.back() : turns.front().displacement;
    const double next = turns.size() > 1    ? turns[1].displacement
                        : turns.size() == 1 ? displacement.back()
                                            : displacement.front();
    const std::int8_t direction = SignOf(first_extreme - next);  // in which the record sets out
    if (initial.state == InitialState::kVirgin) {
      const double origin = initial.unloaded_displacement;
      const double first_step = displacement.front() - origin;
      const std::int8_t first_direction = first_step == 0 ? direction : SignOf(first_step);
      Open({.origin = origin, .start = BranchStart::kUnloaded, .direction = first_direction});
      if (asymmetry_ != 0) {  // the virgin curve of the other direction
        Branch& back = path_.branches.emplace_back(path_.branches.back());
        back.direction = static_cast<std::int8_t>(-first_direction);
      }
      if (first_direction != direction) Reverse(displacement.front());
      return;
    }
    auto [lowest, highest] = ExtremesOf(displacement);
    for (const Turn& turn : turns) {
      lowest = std::min(lowest, turn.displacement);
      highest = std::max(highest, turn.displacement);
    }
    const double amplitude = (highest - lowest) / 2;
    const double near_extreme = initial.turns_at_first ? displacement.front()
                                : direction > 0        ? lowest
                                                       : highest;
    if (memory_ == Memory::kNone) {
      Open({near_extreme, amplitude, -1, BranchStart::kSteadyExtreme, direction});
      return;
    }
    // One turn of the loop from the unloaded contact: a Masing law is steady after it.
    Open({.origin = lowest + amplitude,
          .start = BranchStart::kSteadyCentre,
          .direction = direction});
    Reverse(direction > 0 ? highest : lowest);
    Reverse(near_extreme);
  }

  /// Starts the branch back from `extreme` on the present one.
  void Reverse(double extreme) {
    Open({.origin = extreme, .direction = static_cast<std::int8_t>(-direction_)});
  }

  /// Returns how many of the samples ahead the present branch has before it closes.
  [[nodiscard]] std::size_t SamplesAhead(std::span<const double> displacement) const {
    if (memory_ == Memory::kNone || path_.open.size() < 2) return displacement.size();
    const double closing = ClosingDisplacement(path_.open.size(), OriginOf{path_}, asymmetry_);
    const double direction = direction_;
    std::size_t ahead = 0;
    while (ahead < displacement.size() && direction * (displacement[ahead] - closing) < 0) ++ahead;
    return ahead;
  }

  /// Moves on to `displacement` in the present direction; closes what it passes.
  void Advance(double displacement) {
    if (memory_ == Memory::kNone) return;
    const std::size_t open = path_.open.size();
    path_.open.resize(StillOpen(open, OriginOf{path_}, direction_, displacement, asymmetry_));
    if (asymmetry_ == 0 || open == 1 || path_.open.size() > 1) return;
    // The virgin curve of either direction is among the first two branches of the path.
    path_.open.front() = path_.branches.front().direction == direction_ ? 0 : 1;
  }

 private:
  struct OriginOf {
    const LoadingPath& path;
    double operator()(std::size_t i) const {
      return path.branches[static_cast<std::size_t>(path.open[i])].origin;
    }
  };

  void Open(Branch branch) {
    branch.parent = path_.open.empty() ? -1 : path_.open.back();
    direction_ = branch.direction;
    path_.branches.push_back(branch);
    path_.open.push_back(static_cast<std::int32_t>(path_.branches.size() - 1));
  }

  LoadingPath& path_;
  Memory memory_;
  double asymmetry_;           // of a virgin contact; 0 of another
  std::int8_t direction_ = 1;  // of the motion; the virgin curve is run both ways
};

}  // namespace

LoadingPath MakeLoadingPath(std::span<const double> displacement,
                            std::span<const std::size_t> reversals, Memory memory,
                            const InitialContact& initial) {
  std::vector<Turn> turns;
  turns.reserve(reversals.size());
  for (const std::size_t reversal : reversals) {
    if (reversal < displacement.size()) turns.push_back({reversal + 1, displacement[reversal]});
  }
  LoadingPath path;
  MakeLoadingPath(displacement, turns, memory, initial, path);
  return path;
}

void MakeLoadingPath(std::span<const double> displacement, std::span<const Turn> turns,
                     Memory memory, const InitialContact& initial, LoadingPath& path) {
  if (displacement.empty()) {
    throw InvalidArgument("the displacement history is empty: must have samples");
  }
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    if (std::abs(displacement[i]) <= kLargestPathDisplacement) continue;
    RequireWithinReach(fmt::format("displacement [m] of sample {}", i), displacement[i]);
  }
  RequireWithinReach("unloaded displacement [m]", initial.unloaded_displacement);
  if (!(std::abs(initial.asymmetry) < 1)) {
    ThrowInvalid("asymmetry [-]", initial.asymmetry, "must be in (-1, 1)");
  }
  if (initial.asymmetry != 0 && memory == Memory::kNone) {
    ThrowInvalid("asymmetry [-]", initial.asymmetry,
                 "must be 0 of a law without memory: its two directions would differ in stiffness");
  }
  path.asymmetry = initial.asymmetry;
  path.branches.clear();
  path.runs.clear();
  path.open.clear();
  path.branches.reserve(turns.size() + 3);  // and those that are open before the first sample
  OpenBranches open(displacement, turns, memory, initial, path);
  std::size_t i = 0;
  const auto run_to = [&](std::size_t end) {
    while (i < end) {
      open.Advance(displacement[i]);
      const std::size_t next = i + 1 + open.SamplesAhead(displacement.subspan(i + 1, end - i - 1));
      if (path.runs.empty() || path.runs.back().branch != path.open.back()) {
        path.runs.push_back({static_cast<std::uint32_t>(i), 0, path.open.back()});
      }
      path.runs.back().end = static_cast<std::uint32_t>(next);
      i = next;
    }
  };
  for (const Turn& turn : turns) {
    run_to(turn.next);
    open.Advance(turn.displacement);
    open.Reverse(turn.displacement);
  }
  run_to(displacement.size());
}

}  // namespace mindahl::models
