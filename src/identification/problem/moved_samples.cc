#include "identification/problem/moved_samples.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identification/problem/parameters.h"
#include "mindahl/core/error.h"
#include "mindahl/identification/terms.h"

namespace mindahl::identification {
namespace {

/// Times of samples that were measured, made to go on.
/// @param samples  places of the measured among all
void SpreadEvenly(std::span<const std::size_t> samples, std::span<double> clock) {
  std::size_t begin = 0;
  const auto spread = [&](std::size_t end, double step) {
    for (std::size_t k = begin + 1; k < end; ++k) {
      clock[samples[k]] = clock[samples[begin]] + step * static_cast<double>(k - begin);
    }
  };
  for (std::size_t k = 1; k < samples.size(); ++k) {
    const double way = clock[samples[k]] - clock[samples[begin]];
    if (!(way > 0)) continue;
    spread(k, way / static_cast<double>(k - begin));
    begin = k;
  }
  spread(samples.size(), clock[samples[begin]] - clock[samples[begin - 1]]);
}

bool GoesOn(std::span<const double> time) {
  return std::ranges::any_of(time, [&](double at) { return at > time.front(); });
}

struct Lags {
  double least = 0.0;  // [s], or samples
  double most = 0.0;
};

/// Returns the lags that the options allow.
/// @param first  the first record, whose cycles the bounds are of
Lags LagsOf(const FitOptions& options, const loop::PreparedRecord& first) {
  const auto fixed = options.fixed.find("lag");
  if (fixed != options.fixed.end()) return {fixed->second, fixed->second};
  const auto bound = options.bounds.find("lag");
  if (bound != options.bounds.end()) return {bound->second.lower, bound->second.upper};
  const std::size_t reversals = first.reversals.size();
  const double longest = LongestLag(MeanCycleDuration({}, first.size(), reversals)) *
                         MeanCycleDuration(first.record.time, first.size(), reversals);
  return {-longest, longest};
}

}  // namespace

double LongestLag(double samples_a_cycle) {
  constexpr double kSamples = 10.0;
  constexpr double kLongest = 0.2;
  return std::clamp(kSamples / samples_a_cycle, FindTerm("lag")->highest, kLongest);
}

bool MayHaveClocks(const ScaledRecords& data) {
  const bool timed = !data.records.front().velocity.empty();
  return std::ranges::all_of(data.records, [&](const ScaledRecord& record) {
    return record.velocity.empty() != timed && GoesOn(record.time);
  });
}

void SetClocks(ScaledRecords& data) {
  std::vector<std::size_t> samples;
  for (ScaledRecord& record : data.records) {
    const auto is_inserted = [&](std::size_t i) {
      return !record.inserted.empty() && record.inserted[i] != 0;
    };
    record.clock.assign(record.time.begin(), record.time.end());
    samples.clear();
    for (std::size_t i = 0; i < record.size(); ++i) {
      if (!is_inserted(i)) samples.push_back(i);
    }
    SpreadEvenly(samples, record.clock);
    // A turning point between two samples, which has a neighbour on either side.
    for (std::size_t i = 1; i + 1 < record.size(); ++i) {
      if (is_inserted(i)) record.clock[i] = (record.clock[i - 1] + record.clock[i + 1]) / 2;
    }
  }
}

void LeaveOutBeyondLags(const FitOptions& options, loop::PreparedRecords& records) {
  if (!HasTerm(options, "lag")) return;
  const loop::PreparedRecord& first = records.records.front();
  for (const loop::PreparedRecord& record : records.records) {
    const std::span<const double> time = record.record.time;
    if (time.empty() == first.record.time.empty() && (time.empty() || GoesOn(time))) continue;
    throw InvalidArgument("lag needs a time that goes on in every record, or in none a time");
  }
  const Lags lags = LagsOf(options, first);
  for (std::size_t r = 0; r < records.records.size(); ++r) {
    loop::PreparedRecord& record = records.records[r];
    const auto time = [&](std::size_t i) {
      return record.record.time.empty() ? static_cast<double>(i) : record.record.time[i];
    };
    const double begin = time(0);
    const double end = time(record.size() - 1);
    for (std::size_t i = 0; i < record.size(); ++i) {
      if (time(i) - lags.most < begin || time(i) - lags.least > end) record.counts[i] = 0;
    }
    record.left_out = static_cast<std::size_t>(std::ranges::count(record.counts, 0));
    if (record.left_out < record.size()) continue;
    throw InvalidArgument(
        fmt::format("nothing is left of record {}: under lags of {:.6g} to {:.6g} every sample "
                    "that counts lies "
                    "beyond one of its ends: give smaller ones, --bound lag=LO:HI",
                    r + 1, lags.least, lags.most));
  }
}

ContactMotion ContactMotionOf(const Term& term) {
  if (term.name == "lag") return ContactMotion::kLate;
  return ContactMotion::kMeasured;
}

void MovedSamples::MoveTo(const ScaledRecord& record, double amount, models::Memory memory,
                          const models::InitialContact& initial) {
  if (valid_ && amount == amount_ && initial.unloaded_displacement == unloaded_ &&
      initial.asymmetry == path_.asymmetry) {
    return;
  }
  Fill(record, amount, initial);
  models::MakeLoadingPath(displacement_, reversals_, memory, initial, path_);
  amount_ = amount;
  unloaded_ = initial.unloaded_displacement;
  valid_ = true;
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

std::unique_ptr<MovedSamples> MakeMovedSamples(ContactMotion /*motion*/) {
  return std::make_unique<LaggedSamples>();
}

}  // namespace mindahl::identification
