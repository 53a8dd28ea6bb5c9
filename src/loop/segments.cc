#include "mindahl/loop/segments.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <ranges>
#include <span>

#include "loop/rules.h"
#include "loop/statistics.h"
#include "loop/strokes.h"
#include "mindahl/loop/reversals.h"

namespace mindahl::loop {

namespace {

/// Medians of five, so that single readings end nothing.
std::vector<double> WithoutSpikes(std::span<const double> load) {
  constexpr std::size_t kReach = 2;
  std::vector<double> medians(load.begin(), load.end());
  for (std::size_t i = kReach; i + kReach < load.size(); ++i) {
    std::array<double, 2 * kReach + 1> about{};
    std::ranges::copy(load.subspan(i - kReach, about.size()), about.begin());
    std::ranges::nth_element(about, about.begin() + kReach);
    medians[i] = about[kReach];
  }
  return medians;
}

struct LoadRun {
  std::size_t first;
  std::size_t last;  // one past
  double load = 0.0;
  double spread = 0.0;
};

class LoadSteps {
 public:
  explicit LoadSteps(const RecordView& record)
      : noise_(NoiseByDifferences(record.normal_load, 1)),
        load_(WithoutSpikes(record.normal_load)) {
    const ReversalGate gate = ChooseReversalGate(record.displacement);
    reversals_ = FindReversals(record.displacement, gate.gate);
  }

  [[nodiscard]] std::vector<ConstantLoad> Find() const {
    std::vector<LoadRun> runs = ConstantRuns();
    if (runs.size() < 2 || !AreSteps(runs)) return {};
    std::vector<ConstantLoad> pieces;
    pieces.reserve(runs.size());
    for (const LoadRun& run : runs) pieces.push_back(PieceOf(run));
    return pieces;
  }

  [[nodiscard]] std::optional<ConstantLoad> FindSettled() const {
    const std::vector<LoadRun> runs = ConstantRuns();
    const auto longest =
        std::ranges::max_element(runs, {}, [](const LoadRun& run) { return run.last - run.first; });
    if (longest == runs.end()) return std::nullopt;
    const ConstantLoad piece = PieceOf(*longest);
    const auto samples = static_cast<double>(piece.last - piece.first);
    const bool is_whole = piece.first == 0 && piece.last == load_.size();
    if (is_whole || samples < LoadStepRules::kShare * static_cast<double>(load_.size()))
      return std::nullopt;
    return piece;
  }

 private:
  [[nodiscard]] ConstantLoad PieceOf(const LoadRun& run) const {
    const std::size_t first = run.first == 0 ? 0 : *std::next(NextTurn(run.first));
    return {.first = first, .last = run.last, .normal_load = run.load};
  }
  [[nodiscard]] double Tolerance(double load) const {
    return std::max(LoadStepRules::kConstant * load, LoadStepRules::kNoise * noise_);
  }
  [[nodiscard]] std::vector<std::size_t>::const_iterator NextTurn(std::size_t sample) const {
    return std::ranges::lower_bound(reversals_, sample);
  }

  /// Returns the samples from one on as far as the load stays within the tolerance.
  [[nodiscard]] LoadRun RunFrom(std::size_t first) const {
    double low = load_[first];
    double high = low;
    std::size_t last = first + 1;
    for (; last < load_.size(); ++last) {
      const double lower = std::min(low, load_[last]);
      const double upper = std::max(high, load_[last]);
      if (upper - lower > 2 * Tolerance((upper + lower) / 2)) break;
      low = lower;
      high = upper;
    }
    return {.first = first, .last = last};
  }

  /// Returns it without the ends of the adjacent ramps.
  void Settle(LoadRun& run) const {
    const std::span<const double> load = std::span(load_).subspan(run.first, run.last - run.first);
    run.load = UpperMedian(std::vector<double>(load.begin(), load.end()));
    const double settled = Tolerance(run.load) / 2;
    const auto is_settled = [&](std::size_t i) { return std::abs(load_[i] - run.load) <= settled; };
    while (run.first > 0 && run.first + 1 < run.last && !is_settled(run.first)) ++run.first;
    while (run.last < load_.size() && run.first + 1 < run.last && !is_settled(run.last - 1)) {
      --run.last;
    }
    const auto [low, high] =
        std::ranges::minmax(std::span(load_).subspan(run.first, run.last - run.first));
    run.spread = std::max(high - low - 2 * LoadStepRules::kNoise * noise_, 0.0);
  }

  [[nodiscard]] std::vector<LoadRun> ConstantRuns() const {
    std::vector<LoadRun> runs;
    for (std::size_t i = 0; i < load_.size();) {
      LoadRun run = RunFrom(i);
      i = run.last;
      Settle(run);
      const auto turns = static_cast<std::size_t>(NextTurn(run.last) - NextTurn(run.first));
      if (run.load > 0 && turns >= LoadStepRules::kTurns) runs.push_back(run);
    }
    return runs;
  }

  [[nodiscard]] bool AreSteps(std::span<const LoadRun> runs) const {
    std::size_t samples = runs.front().last - runs.front().first;
    for (std::size_t r = 1; r < runs.size(); ++r) {
      samples += runs[r].last - runs[r].first;
      const double step = std::abs(runs[r].load - runs[r - 1].load);
      const double smaller = std::min(runs[r].load, runs[r - 1].load);
      if (!(step > std::max(LoadStepRules::kStep * smaller, 4 * Tolerance(smaller)))) return false;
      if (std::max(runs[r].spread, runs[r - 1].spread) > LoadStepRules::kFlat * step) return false;
    }
    return static_cast<double>(samples) >=
           LoadStepRules::kShare * static_cast<double>(load_.size());
  }

  double noise_;
  std::vector<double> load_;
  std::vector<std::size_t> reversals_;
};

}  // namespace

std::optional<ConstantLoad> FindSettledLoad(const RecordView& record) {
  if (record.normal_load.empty()) return std::nullopt;
  return LoadSteps(record).FindSettled();
}

std::vector<ConstantLoad> FindLoadSteps(const RecordView& record) {
  if (record.normal_load.empty()) return {};
  return LoadSteps(record).Find();
}

}  // namespace mindahl::loop
