#include "identification/problem/moved_samples.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identification/problem/parameters.h"
#include "mindahl/core/error.h"
#include "mindahl/identification/terms.h"

namespace mindahl::identification {
namespace {

/// Makes times go on: those that stand still or step back lie evenly between the last that went on
/// and the next that does.
void SpreadEvenly(std::span<double> clock) {
  std::size_t begin = 0;
  const auto spread = [&](std::size_t end, double step) {
    for (std::size_t k = begin + 1; k < end; ++k) {
      clock[k] = clock[begin] + step * static_cast<double>(k - begin);
    }
  };
  for (std::size_t k = 1; k < clock.size(); ++k) {
    const double way = clock[k] - clock[begin];
    if (!(way > 0)) continue;
    spread(k, way / static_cast<double>(k - begin));
    begin = k;
  }
  spread(clock.size(), clock[begin] - clock[begin - 1]);
}

bool GoesOn(std::span<const double> time) {
  return std::ranges::any_of(time, [&](double at) { return at > time.front(); });
}

/// Returns the lags that the options allow [s, or samples].
/// @param first  the first record, whose cycles the bounds are of
loop::Interval LagsOf(const FitOptions& options, const loop::PreparedRecord& first) {
  const auto fixed = options.fixed.find("lag");
  if (fixed != options.fixed.end()) return {fixed->second, fixed->second};
  const auto bound = options.bounds.find("lag");
  if (bound != options.bounds.end()) return bound->second;
  const std::size_t reversals = first.reversals.size();
  const double longest = LongestLag(MeanCycleDuration({}, first.size(), reversals)) *
                         MeanCycleDuration(first.record.time, first.size(), reversals);
  return {-longest, longest};
}

}  // namespace

double LongestLag(double samples_a_cycle) {
  constexpr double kSamples = 10.0;
  constexpr double kLongest = 0.2;
  return std::clamp(kSamples / samples_a_cycle, TermOf(TermId::kLag).highest, kLongest);
}

void SetClocks(ScaledRecords& data) {
  for (ScaledRecord& record : data.records) {
    record.clock = record.time;
    SpreadEvenly(record.clock);
  }
}

void LeaveOutBeyondLags(const FitOptions& options, loop::PreparedRecords& records) {
  if (!HasTerm(options, TermId::kLag)) return;
  const loop::PreparedRecord& first = records.records.front();
  for (const loop::PreparedRecord& record : records.records) {
    const std::span<const double> time = record.record.time;
    if (time.empty() == first.record.time.empty() && (time.empty() || GoesOn(time))) continue;
    throw InvalidArgument(
        "lag needs a time that increases in every record, or records without a time");
  }
  const loop::Interval lags = LagsOf(options, first);
  for (std::size_t r = 0; r < records.records.size(); ++r) {
    loop::PreparedRecord& record = records.records[r];
    const auto time = [&](std::size_t i) {
      return record.record.time.empty() ? static_cast<double>(i) : record.record.time[i];
    };
    const double begin = time(0);
    const double end = time(record.size() - 1);
    for (std::size_t i = 0; i < record.size(); ++i) {
      if (time(i) - lags.upper < begin || time(i) - lags.lower > end) record.counts[i] = 0;
    }
    record.left_out = static_cast<std::size_t>(std::ranges::count(record.counts, 0));
    if (record.left_out < record.size()) continue;
    throw InvalidArgument(
        fmt::format("nothing is left of record {}: with lags of {:.6g} to {:.6g} every sample that "
                    "counts is moved beyond one of its ends: give smaller ones, --bound lag=LO:HI",
                    r + 1, lags.lower, lags.upper));
  }
}

void MovedSamples::MoveTo(const ScaledRecord& record, double amount, models::Memory memory,
                          const models::InitialContact& initial) {
  if (amount_ == amount && initial.unloaded_displacement == unloaded_ &&
      initial.asymmetry == path_.asymmetry) {
    return;
  }
  Fill(record, amount, initial);
  models::MakeLoadingPath(displacement_, reversals_, memory, initial, path_);
  amount_ = amount;
  unloaded_ = initial.unloaded_displacement;
}

void MovedSamples::Clear(std::size_t most) {
  displacement_.clear();
  displacement_.reserve(most);
  rates_.clear();
  rates_.reserve(most);
  reversals_.clear();
}

void MovedSamples::Gather(std::span<const double> at_places, std::span<double> at_samples) const {
  for (std::size_t i = 0; i < at_samples.size(); ++i) {
    at_samples[i] = bears_.empty() || bears_[i] != 0 ? at_places[places_[i]] : 0.0;
  }
}

void MovedSamples::CopyPathOfSamples(models::LoadingPath& path) const {
  path.branches = path_.branches;
  path.open = path_.open;
  path.asymmetry = path_.asymmetry;
  path.runs.clear();
  std::size_t next = 0;
  for (const models::BranchRun& run : path_.runs) {
    const std::size_t begin = next;
    while (next < places_.size() && places_[next] < run.end) ++next;
    if (next == begin) continue;
    path.runs.push_back(
        {static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(next), run.branch});
  }
}

void LaggedSamples::Fill(const ScaledRecord& record, double lag,
                         const models::InitialContact& /*initial*/) {
  const ScaledRecord& motion = record.whole != nullptr ? *record.whole : record;
  const std::span<const double> x = motion.displacement;
  const std::span<const double> clock = motion.clock;
  const std::size_t last = motion.size() - 1;
  Clear(record.size() + motion.reversals.size() + 2);
  places_.resize(record.size());
  Append(x.front(), 0.0);
  std::size_t segment = 0;  // from this sample to the next, its end included
  std::size_t turn = 0;
  const auto turn_before = [&](std::size_t end) {
    for (; turn < motion.reversals.size() && motion.reversals[turn] < end; ++turn) {
      reversals_.push_back(displacement_.size());
      Append(x[motion.reversals[turn]], 0.0);
    }
  };
  for (std::size_t i = 0; i < record.size(); ++i) {
    const double wanted = record.clock[i] - lag;
    const double time = std::clamp(wanted, clock.front(), clock.back());
    while (segment + 1 < last && clock[segment + 1] < time) ++segment;
    turn_before(segment + 1);
    const double duration = clock[segment + 1] - clock[segment];
    const double travel = x[segment + 1] - x[segment];
    places_[i] = displacement_.size();
    // So close that they are one: the later.
    const double fraction = duration > 0 ? (time - clock[segment]) / duration : 1.0;
    Append(std::lerp(x[segment], x[segment + 1], fraction),
           time == wanted && duration > 0 ? -travel / duration : 0.0);
  }
  turn_before(motion.size());
  Append(x.back(), 0.0);
}

void LaggedSamples::DifferentiateByAmount(const models::OriginSensitivity& sensitivity,
                                          std::span<double> at_places) const {
  for (std::size_t k = 0; k < at_places.size(); ++k) {
    at_places[k] = sensitivity.sample_slope[k] * rates_[k];
  }
}

void SamplesBehindGap::Fill(const ScaledRecord& record, double gap,
                            const models::InitialContact& initial) {
  const std::span<const double> x = record.displacement;
  const double half = gap / 2;
  gap_ = gap;
  Clear(2 * record.size());
  for (auto* places : {&places_, &unloading_, &loading_}) places->resize(record.size());
  direction_.resize(record.size());
  bears_.assign(record.size(), 1);
  const std::vector<Stroke> strokes = StrokesOf(x, record.reversals);
  std::vector<Place> ends;
  ends.reserve(strokes.size());
  for (const auto& [begin, end, direction] : strokes) {
    const double side = record.force[end] == 0 ? direction : std::copysign(1.0, record.force[end]);
    ends.push_back({x[end] - side * half, -side / 2});
  }
  Place from;
  if (initial.state == models::InitialState::kVirgin) {
    // The contact is unloaded in the middle of the gap.
    const double travel = x.front() - initial.unloaded_displacement;
    const double side = std::copysign(1.0, travel);
    from = std::abs(travel) <= half ? Place{initial.unloaded_displacement, 0.0}
                                    : Place{x.front() - side * half, -side / 2};
  } else {
    const double direction = strokes.front().direction;
    from = {x.front() + direction * half, direction / 2};
    for (const Place& end : ends) {
      if (direction * (end.displacement - from.displacement) < 0) from = end;
    }
  }
  for (std::size_t s = 0; s < strokes.size(); ++s) {
    const Stroke& stroke = strokes[s];
    // The contact does not move in a stroke that is shorter than the gap.
    const bool moves = stroke.direction * (ends[s].displacement - from.displacement) >= 0;
    const Place to = moves ? ends[s] : from;
    FillStroke(stroke, s == 0 ? 0 : stroke.begin + 1, x, from, to);
    if (s < record.reversals.size()) reversals_.push_back(displacement_.size() - 1);
    from = to;
  }
}

void SamplesBehindGap::FillStroke(const Stroke& stroke, std::size_t first,
                                  std::span<const double> x, Place from, Place to) {
  const auto place = [&](std::size_t i, double side) {
    const Place at{x[i] + side * gap_ / 2, side / 2};
    if (stroke.direction * (at.displacement - from.displacement) < 0) return from;
    return stroke.direction * (to.displacement - at.displacement) < 0 ? to : at;
  };
  const auto append = [&](const Place& at) {
    Append(at.displacement, at.rate);
    return displacement_.size() - 1;
  };
  std::fill(direction_.begin() + static_cast<std::ptrdiff_t>(first),
            direction_.begin() + static_cast<std::ptrdiff_t>(stroke.end) + 1, stroke.direction);
  std::size_t next = first;  // of those that bear the force of the stroke
  for (std::size_t i = first; i <= stroke.end; ++i) {
    const Place unloading = place(i, stroke.direction);
    for (; next <= stroke.end; ++next) {
      const Place loading = place(next, -stroke.direction);
      const double ahead = loading.displacement - unloading.displacement;
      if (stroke.direction * ahead > 0) break;
      loading_[next] = append(loading);
    }
    unloading_[i] = append(unloading);
  }
  for (; next <= stroke.end; ++next) loading_[next] = append(place(next, -stroke.direction));
}

void SamplesBehindGap::TakeForces(std::span<const double> t) {
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const double direction = direction_[i];
    bears_[i] = 1;
    if (direction * t[unloading_[i]] < 0) {
      places_[i] = unloading_[i];
    } else if (direction * t[loading_[i]] > 0 || gap_ == 0) {
      places_[i] = loading_[i];
    } else {
      places_[i] = i > 0 ? places_[i - 1] : loading_[i];
      bears_[i] = 0;
    }
  }
}

void SamplesBehindGap::DifferentiateByAmount(const models::OriginSensitivity& sensitivity,
                                             std::span<double> at_places) const {
  const auto [lowest, highest] = std::ranges::minmax_element(displacement_);
  const double rate_of_lowest = rates_[static_cast<std::size_t>(lowest - displacement_.begin())];
  const double rate_of_highest = rates_[static_cast<std::size_t>(highest - displacement_.begin())];
  const std::size_t initial = path_.branches.size() - reversals_.size();
  std::vector<double> origin(path_.branches.size());  // ∂/∂g of where the branches start
  std::vector<double> force(path_.branches.size());   // and of t there
  for (std::size_t b = 0; b < path_.branches.size(); ++b) {
    const models::Branch& branch = path_.branches[b];
    if (b >= initial) {
      origin[b] = rates_[reversals_[b - initial]];
    } else if (branch.start == models::BranchStart::kSteadyCentre) {
      origin[b] = (rate_of_lowest + rate_of_highest) / 2;
    } else if (path_.branches.front().start == models::BranchStart::kUnloaded) {
      origin[b] = branch.start == models::BranchStart::kUnloaded ? 0.0 : rates_.front();
    } else {
      origin[b] = branch.direction > 0 ? rate_of_lowest : rate_of_highest;
    }
    if (branch.start == models::BranchStart::kSteadyExtreme) {
      force[b] = sensitivity.per_amplitude[b] * (rate_of_highest - rate_of_lowest) / 2;
    } else if (branch.start == models::BranchStart::kReversal) {
      const auto parent = static_cast<std::size_t>(branch.parent);
      force[b] =
          sensitivity.slope[b] * (origin[b] - origin[parent]) + sensitivity.gain[b] * force[parent];
    }
  }
  for (const models::BranchRun& run : path_.runs) {
    const auto b = static_cast<std::size_t>(run.branch);
    for (std::size_t k = run.begin; k < run.end; ++k) {
      at_places[k] = sensitivity.sample_slope[k] * (rates_[k] - origin[b]) +
                     sensitivity.sample_gain[k] * force[b];
    }
  }
}

std::unique_ptr<MovedSamples> MakeMovedSamples(ContactMotion motion) {
  if (motion == ContactMotion::kBehindGap) return std::make_unique<SamplesBehindGap>();
  return std::make_unique<LaggedSamples>();
}

}  // namespace mindahl::identification
