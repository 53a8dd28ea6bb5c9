#include "mindahl/loop/segments.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <memory_resource>
#include <numeric>
#include <optional>
#include <ranges>
#include <span>
#include <utility>

#include "core/probability.h"
#include "loop/rules.h"
#include "loop/statistics.h"
#include "loop/strokes.h"
#include "mindahl/loop/facts.h"
#include "mindahl/loop/reversals.h"

namespace mindahl::loop {

namespace {

/// Returns the number of samples, at least one, at which the displacement rests from its start.
template <typename Displacements>
std::size_t Resting(const Displacements& displacements, double reach) {
  const double at_rest = *displacements.begin();
  const auto moves = std::ranges::find_if(
      displacements, [&](double displacement) { return std::abs(displacement - at_rest) > reach; });
  return static_cast<std::size_t>(moves - displacements.begin());
}

class Trimming {
 public:
  Trimming(const PreparedRecord& prepared, int force_sense, const TrimRules& rules)
      : rules_(rules),
        displacement_(prepared.displacement()),
        gate_(prepared.reversal_gate),
        points_(TurningPoints(displacement_, prepared.reversals, std::pmr::get_default_resource())),
        cycles_(MeasureFacts(prepared, force_sense).cycles),
        last_(prepared.size()) {}

  Trim Find() {
    trim_.samples = displacement_.size();
    LeaveOutRest();
    FindRamps();
    if (steady_.first > 0) CutBefore(TrimReason::kRamp, steady_.first);
    FindRunningIn();
    if (steady_.second < cycles_.size()) {
      const std::size_t end = points_[2 * steady_.second];
      if (end < last_) {
        at_end_.insert(at_end_.begin(), {.reason = TrimReason::kRamp,
                                         .first = end,
                                         .last = last_,
                                         .cycles = cycles_.size() - steady_.second});
      }
    }
    trim_.parts.insert(trim_.parts.end(), at_end_.begin(), at_end_.end());
    return std::move(trim_);
  }

 private:
  /// Returns the number of samples of a usual stroke; 0 where there is none.
  [[nodiscard]] double UsualStroke() const {
    if (points_.size() < 2) return 0.0;
    std::vector<double> lengths;
    for (std::size_t k = 1; k < points_.size(); ++k) {
      lengths.push_back(static_cast<double>(points_[k] - points_[k - 1]));
    }
    return UpperMedian(lengths);
  }

  void LeaveOutRest() {
    const double usual = UsualStroke();
    if (!(usual > 0)) return;
    const auto [least, greatest] = std::ranges::minmax(displacement_);
    const double reach = std::max(rules_.rest * (greatest / 2 - least / 2), gate_);
    const auto is_rest = [&](std::size_t samples) {
      return static_cast<double>(samples) > rules_.longest_dwell * usual && samples > 1;
    };
    // One sample stays, from which the motion begins and at which it ends.
    const std::size_t before = Resting(displacement_, reach);
    if (is_rest(before)) {
      first_ = before - 1;
      trim_.parts.push_back(
          {.reason = TrimReason::kRest, .first = 0, .last = first_, .at_start = true});
    }
    const std::size_t after = Resting(std::views::reverse(displacement_), reach);
    if (is_rest(after)) {
      at_end_.push_back({.reason = TrimReason::kRest,
                         .first = displacement_.size() - after + 1,
                         .last = displacement_.size()});
      last_ = at_end_.front().first;
    }
  }

  /// Cuts, from the first sample that is left, those before a cycle, counted from 0.
  void CutBefore(TrimReason reason, std::size_t cycle) {
    const std::size_t begin = points_[2 * cycle];
    if (begin <= first_) return;
    trim_.parts.push_back({.reason = reason,
                           .first = first_,
                           .last = begin,
                           .cycles = cycle - cut_cycles_,
                           .at_start = true,
                           .has_first_loading = points_.front() > first_});
    first_ = begin;
    cut_cycles_ = cycle;
  }

  /// True if the amplitude grows (+1) or falls (−1) over these cycles without a step back.
  [[nodiscard]] bool IsMonotone(std::size_t first, std::size_t last, double widest,
                                double sense) const {
    for (std::size_t k = first; k + 1 < last; ++k) {
      const double step = sense * (cycles_[k + 1].amplitude - cycles_[k].amplitude);
      if (step < -rules_.step_back * widest) return false;
    }
    return true;
  }

  /// Finds the cycles of the test, [first, second): all where there are no ramps.
  void FindRamps() {
    steady_ = {0, cycles_.size()};
    const auto is_steady = [](const CycleFacts& cycle) { return cycle.steady; };
    const auto first = std::ranges::find_if(cycles_, is_steady);
    if (first == cycles_.end()) return;
    const auto end =
        std::find_if(cycles_.rbegin(), cycles_.rend(), is_steady).base();  // one past the last
    is_of_one_amplitude_ = std::all_of(first, end, is_steady);
    if (!is_of_one_amplitude_) return;
    const auto begin_cycle = static_cast<std::size_t>(first - cycles_.begin());
    const auto end_cycle = static_cast<std::size_t>(end - cycles_.begin());
    const double widest = std::ranges::max(cycles_, {}, &CycleFacts::amplitude).amplitude;
    const bool is_test = static_cast<double>(end_cycle - begin_cycle) >=
                         rules_.share * static_cast<double>(cycles_.size());
    is_of_one_amplitude_ = is_test && IsMonotone(0, begin_cycle + 1, widest, 1.0) &&
                           IsMonotone(end_cycle - 1, cycles_.size(), widest, -1.0);
    if (is_of_one_amplitude_) steady_ = {begin_cycle, end_cycle};
  }

  /// Returns a fact of each cycle of the test; empty where one does not have it.
  template <typename Get>
  [[nodiscard]] std::vector<double> FactOf(Get get) const {
    std::vector<double> values;
    for (std::size_t k = steady_.first; k < steady_.second; ++k) {
      const std::optional<double> value = get(cycles_[k]);
      if (!value) return {};
      values.push_back(*value);
    }
    return values;
  }

  /// Cycles at the beginning whose fact is not what it settles to; empty where it does not settle.
  [[nodiscard]] std::optional<std::size_t> Unsettled(const std::vector<double>& values) const {
    const std::span<const double> last = std::span(values).subspan(values.size() / 2);
    std::vector<double> numbers(last.size());
    std::iota(numbers.begin(), numbers.end(), 0.0);
    const Line line = LineThrough(numbers, last);
    const auto count = static_cast<double>(last.size());
    const double level = line.mean;
    const double settled = rules_.settled * std::abs(level);
    const double slope = std::abs(line.slope);
    const bool is_trend =
        slope >
        StudentQuantile(line.degrees_of_freedom, 1 - rules_.trend_chance) * line.slope_error;
    if (is_trend && slope * (count - 1) > settled) return std::nullopt;
    const double scatter = StudentQuantile(line.degrees_of_freedom, 1 - rules_.chance) *
                           line.deviation * std::sqrt(1 + 1 / count);
    const double band = std::max(settled, scatter);
    const double sense = values.front() < level ? -1.0 : 1.0;
    std::size_t off = 0;
    while (off < values.size() && sense * (values[off] - level) > band) ++off;
    return off <= values.size() / 2 ? std::optional(off) : std::nullopt;
  }

  void FindRunningIn() {
    if (!is_of_one_amplitude_ || steady_.second - steady_.first < rules_.fewest) return;
    std::size_t off = 0;
    for (const std::vector<double>& values :
         {FactOf([](const CycleFacts& cycle) { return cycle.half_gap; }),
          FactOf([](const CycleFacts& cycle) { return std::optional(cycle.energy); })}) {
      if (values.empty()) continue;
      const std::optional<std::size_t> of_this = Unsettled(values);
      if (!of_this) {
        trim_.settling = Settling::kUnsettled;
        return;
      }
      off = std::max(off, *of_this);
    }
    trim_.settling = Settling::kSettled;
    if (off > 0) CutBefore(TrimReason::kRunningIn, steady_.first + off);
  }

  TrimRules rules_;
  std::span<const double> displacement_;  // [m]
  double gate_;                           // [m]
  std::pmr::vector<std::size_t> points_;
  std::vector<CycleFacts> cycles_;  // from every other point to the next but one
  std::pair<std::size_t, std::size_t> steady_{0, 0};
  bool is_of_one_amplitude_ = false;
  // The remaining samples [first_, last_), as far as they are known, without cut_cycles_.
  std::size_t first_ = 0;
  std::size_t last_ = 0;
  std::size_t cut_cycles_ = 0;
  Trim trim_;
  std::vector<TrimmedPart> at_end_;
};

}  // namespace

bool Trim::begins_later() const {
  return std::ranges::any_of(parts, [](const TrimmedPart& part) {
    return part.at_start && part.reason != TrimReason::kRest;
  });
}

bool Trim::has_first_loading() const {
  return std::ranges::any_of(parts, &TrimmedPart::has_first_loading);
}

std::string_view NameOf(TrimReason reason) {
  switch (reason) {
    case TrimReason::kRest:
      return "rest";
    case TrimReason::kRamp:
      return "ramp";
    case TrimReason::kRunningIn:
      break;
  }
  return "running_in";
}

Trim FindTrim(const RecordView& record, const PreparationOptions& options) {
  PreparationOptions whole = options;
  whole.load_window.reset();
  whole.skip_cycles = 0;
  whole.cycles.reset();
  whole.samples.reset();
  whole.held_out.clear();
  const PreparedRecords prepared = Prepare({&record, 1}, whole, std::pmr::get_default_resource());
  return Trimming(prepared.records.front(), prepared.force_sense, {}).Find();
}

namespace {

/// Returns the standard deviation of white noise, from the median of the steps between readings.
double NoiseOf(std::span<const double> load) {
  if (load.size() < 2) return 0.0;
  std::vector<double> steps(load.size() - 1);
  for (std::size_t i = 0; i < steps.size(); ++i) steps[i] = std::abs(load[i + 1] - load[i]);
  constexpr double kOfNormal = 1.4826;
  return kOfNormal / std::sqrt(2.0) * UpperMedian(steps);
}

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
  LoadSteps(const RecordView& record, const LoadStepRules& rules)
      : rules_(rules),
        noise_(NoiseOf(record.normal_load)),
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
    if (is_whole || samples < rules_.share * static_cast<double>(load_.size())) return std::nullopt;
    return piece;
  }

 private:
  [[nodiscard]] ConstantLoad PieceOf(const LoadRun& run) const {
    const std::size_t first = run.first == 0 ? 0 : *std::next(NextTurn(run.first));
    return {.first = first, .last = run.last, .normal_load = run.load};
  }
  [[nodiscard]] double Tolerance(double load) const {
    return std::max(rules_.constant * load, rules_.noise * noise_);
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
    run.spread = std::max(high - low - 2 * rules_.noise * noise_, 0.0);
  }

  [[nodiscard]] std::vector<LoadRun> ConstantRuns() const {
    std::vector<LoadRun> runs;
    for (std::size_t i = 0; i < load_.size();) {
      LoadRun run = RunFrom(i);
      i = run.last;
      Settle(run);
      const auto turns = static_cast<std::size_t>(NextTurn(run.last) - NextTurn(run.first));
      if (run.load > 0 && turns >= rules_.turns) runs.push_back(run);
    }
    return runs;
  }

  [[nodiscard]] bool AreSteps(std::span<const LoadRun> runs) const {
    std::size_t samples = runs.front().last - runs.front().first;
    for (std::size_t r = 1; r < runs.size(); ++r) {
      samples += runs[r].last - runs[r].first;
      const double step = std::abs(runs[r].load - runs[r - 1].load);
      const double smaller = std::min(runs[r].load, runs[r - 1].load);
      if (!(step > std::max(rules_.step * smaller, 4 * Tolerance(smaller)))) return false;
      if (std::max(runs[r].spread, runs[r - 1].spread) > rules_.flat * step) return false;
    }
    return static_cast<double>(samples) >= rules_.share * static_cast<double>(load_.size());
  }

  LoadStepRules rules_;
  double noise_;
  std::vector<double> load_;
  std::vector<std::size_t> reversals_;
};

}  // namespace

std::optional<ConstantLoad> FindSettledLoad(const RecordView& record) {
  if (record.normal_load.empty()) return std::nullopt;
  return LoadSteps(record, {}).FindSettled();
}

std::vector<ConstantLoad> FindLoadSteps(const RecordView& record) {
  if (record.normal_load.empty()) return {};
  return LoadSteps(record, {}).Find();
}

}  // namespace mindahl::loop
