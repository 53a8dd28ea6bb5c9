#include "identification/problem/scaled_records.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "core/extremes.h"
#include "core/refuse.h"
#include "identification/problem/motion.h"
#include "identification/problem/parameters.h"
#include "loop/statistics.h"

namespace mindahl::identification {

double ColumnCorrelation(std::span<const double> one, std::span<const double> other) {
  using Column = Eigen::Map<const Eigen::VectorXd>;
  Eigen::VectorXd a = Column(one.data(), std::ssize(one));
  Eigen::VectorXd b = Column(other.data(), std::ssize(other));
  a.array() -= a.mean();
  b.array() -= b.mean();
  const double norm = a.norm() * b.norm();
  return norm > 0 ? a.dot(b) / norm : 0.0;
}

bool AreOneChannel(std::span<const double> one, std::span<const double> other) {
  constexpr double kOwnPart = 0.1;  // of the deviation
  const double correlation = ColumnCorrelation(one, other);
  return correlation * correlation >= 1 - kOwnPart * kOwnPart;
}

namespace {

/// Returns (x − reference)/unit of values x.
std::vector<double> Scaled(std::span<const double> values, double reference, double unit) {
  std::vector<double> scaled(values.begin(), values.end());
  for (double& value : scaled) value = (value - reference) / unit;
  return scaled;
}

/// Squares, products and ratios of displacements and forces must neither overflow nor vanish.
void RequireScale(std::string_view quantity, double half_range) {
  if (half_range >= 1e-100 && half_range <= 1e100) return;
  ThrowInvalid(quantity, half_range, "must lie between 1e-100 and 1e100: choose other units");
}

/// Central differences by time in a unit [s], one-sided at the ends and where time stands still.
std::vector<double> DerivativeOf(const std::vector<double>& values, const ScaledRecord& record,
                                 double unit) {
  const double units = record.units.half_duration / unit;
  const std::size_t last = record.size() - 1;
  const std::vector<double>& time = record.time;
  std::vector<double> derivative(record.size());
  for (std::size_t i = 0; i <= last; ++i) {
    std::size_t before = i == 0 ? 0 : i - 1;
    std::size_t after = std::min(i + 1, last);
    while (before > 0 && !(time[after] > time[before])) --before;
    while (after < last && !(time[after] > time[before])) ++after;
    const double duration = units * (time[after] - time[before]);
    derivative[i] = duration > 0 ? (values[after] - values[before]) / duration : 0.0;
  }
  return derivative;
}

/// ln of the speeds with their resolution; far below any speed, and finite, where there is none.
void FillLogSpeed(ScaledRecord& record) {
  const double resolution = loop::NoiseByDifferences(record.velocity, 4);
  constexpr double kStandstill = 1e-12;  // of the largest speed
  const double fastest = ExtremesOf(record.velocity).largest_magnitude();
  const double least = fastest > 0 ? kStandstill * fastest : 1.0;
  for (const double speed : record.velocity) {
    record.log_speed.push_back(std::log(std::max(std::hypot(speed, resolution), least)));
  }
}

/// Mean speed over the path in the middle third of the range of the positions, of all records; 1
/// where there is none. A mean over time would count rests.
double SpeedInTheMiddle(const ScaledRecords& data) {
  constexpr double kMiddle = 1.0 / 3;
  double sum = 0.0;
  double path = 0.0;
  for (const ScaledRecord& record : data.records) {
    for (std::size_t i = 1; i < record.velocity.size(); ++i) {
      if (record.counts[i] == 0 || std::abs(record.displacement[i]) > kMiddle) continue;
      const double step = std::abs(record.displacement[i] - record.displacement[i - 1]);
      sum += step * std::abs(record.velocity[i]);
      path += step;
    }
  }
  return sum > 0 ? sum / path : 1.0;
}

/// Takes the loads within a record, and returns their mean over the samples that count [N].
double TakeVaryingLoad(const loop::PreparedRecord& record, const FitOptions& options,
                       ScaledRecord& target) {
  std::vector<double> counted;
  for (std::size_t i = 0; i < record.size(); ++i) {
    if (record.counts[i] != 0) counted.push_back(record.record.normal_load[i]);
  }
  if (counted.empty()) return 0.0;
  const Eigen::Map<const Eigen::ArrayXd> load(counted.data(), std::ssize(counted));
  const double noise = loop::NoiseByDifferences(counted, 1);
  const double variance = (load - load.mean()).square().mean() - noise * noise;
  const double amplitude = std::sqrt(2 * std::max(variance, 0.0));  // of a sine
  // The force of Dahl's own law follows a load of either sign (models/joint_friction.h).
  const bool is_joint = options.model->memory == models::Memory::kNone;
  // The law models a load that varies if the displacement is that of the contact alone; of Masing's
  // law it is read with the force, and slip is as easy in either direction.
  const auto has = [&](TermId id) { return HasTerm(options, id); };
  const bool is_known = !has(TermId::kRigStiffness) && !has(TermId::kBacklash) &&
                        (is_joint || (!has(TermId::kLag) && !has(TermId::kAsymmetry)));
  const bool has_sign = is_joint && is_known;
  const double mean = has_sign ? load.abs().mean() : load.mean();
  const bool varies =
      (has_sign && load.mean() < 0) || amplitude > options.thresholds.load_change * mean;
  if (!(mean > 0) || !varies) return mean;
  for (const double at : record.record.normal_load) {
    const double ratio = (has_sign ? at : std::max(at, 0.0)) / mean;
    (is_known ? target.load_ratio : target.load_change).push_back(is_known ? ratio : ratio - 1);
  }
  return mean;
}

void TakeLoads(ScaledRecords& data, const loop::PreparedRecords& records,
               const FitOptions& options) {
  const std::vector<double>& given = options.normal_loads;
  for (const double load : given) RequirePositive("normal load [N]", load);
  if (given.size() > 1 && given.size() != data.records.size()) {
    Refuse<InvalidArgument>("{} normal loads for {} records: give one for all, or one a record",
                            given.size(), data.records.size());
  }
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    const loop::PreparedRecord& record = records.records[r];
    const bool is_measured = !record.record.normal_load.empty();
    const double mean = is_measured ? TakeVaryingLoad(record, options, data.records[r]) : 0.0;
    data.load_varies = data.load_varies || !data.records[r].load_ratio.empty();
    data.mean_load.push_back(given.empty() ? mean : given[std::min(r, given.size() - 1)]);
  }
  const auto [least, greatest] = std::ranges::minmax(data.mean_load);
  if (!(least > 0)) {
    data.mean_load.clear();
    return;
  }
  data.reference_load = loop::Mean(data.mean_load);
  data.is_load_series = greatest > (1 + options.thresholds.load_change) * least;
  if (!data.is_load_series) return;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    data.records[r].load = data.mean_load[r] / data.reference_load;
  }
}

/// Returns the column of a name in a record.
const loop::Covariate& CovariateOf(const loop::PreparedRecords& records, std::size_t r,
                                   std::string_view name) {
  const std::span<const loop::Covariate> all = records.records[r].record.covariates;
  const auto found = std::ranges::find(all, name, &loop::Covariate::name);
  if (found != all.end()) return *found;
  Refuse<InvalidArgument>("record {} has no covariate '{}'", r + 1, name);
}

/// Adds the columns that terms need beyond those of every fit, and covariates.
void AddColumns(const FitOptions& options, const loop::PreparedRecords& records,
                ScaledRecords& data) {
  const bool asks_speed = std::ranges::any_of(
      std::array{TermId::kSpeedExponent, TermId::kSlipSpeedExponent, TermId::kDragExponent},
      [&](TermId id) { return HasTerm(options, id); });
  const double unit = data.records.front().units.half_duration;
  const double reference = asks_speed ? SpeedInTheMiddle(data) : 1.0;
  for (ScaledRecord& record : data.records) {
    record.units.reference_speed = reference;
    if (record.velocity.empty()) continue;
    if (asks_speed) FillLogSpeed(record);
    if (HasTerm(options, TermId::kInertia)) {
      record.acceleration = DerivativeOf(record.velocity, record, unit);
    }
  }
  for (const std::string& name : options.covariates) {
    double scale = 0.0;
    for (std::size_t r = 0; r < data.records.size(); ++r) {
      scale = std::max(scale, ExtremesOf(CovariateOf(records, r, name).values).half_range());
    }
    RequireScale(fmt::format("half range of the covariate '{}'", name), scale);
    const loop::Covariate& first = CovariateOf(records, 0, name);
    data.covariates.push_back({first.name, first.unit, scale});
    bool is_force = !options.fixed.contains(NameOfCovariate(name));
    for (std::size_t r = 0; r < data.records.size(); ++r) {
      ScaledRecord& record = data.records[r];
      const std::span<const double> values = CovariateOf(records, r, name).values;
      const double middle = options.offsets ? ExtremesOf(values).middle() : 0.0;
      const auto& column = record.covariates.emplace_back(Scaled(values, middle, scale));
      is_force = is_force && AreOneChannel(column, record.force);
    }
    if (!is_force) continue;
    Refuse<InvalidArgument>(
        "the covariate '{}' is a linear function of 'force', one channel with it: "
        "leave it out",
        name);
  }
}

/// Returns the record with these of its samples, in all of its columns; `reversals` as they were.
ScaledRecord SomeOf(const ScaledRecord& record, std::span<const std::size_t> samples) {
  ScaledRecord some = record;
  const auto take = [&](auto& column, const auto& all) {
    if (all.empty()) return;
    column.resize(samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i) column[i] = all[samples[i]];
  };
  for (const auto column :
       {&ScaledRecord::displacement, &ScaledRecord::force, &ScaledRecord::time,
        &ScaledRecord::velocity, &ScaledRecord::acceleration, &ScaledRecord::log_speed,
        &ScaledRecord::load_ratio, &ScaledRecord::load_change, &ScaledRecord::root_weight}) {
    take(some.*column, record.*column);
  }
  take(some.counts, record.counts);
  for (std::size_t c = 0; c < record.covariates.size(); ++c) {
    take(some.covariates[c], record.covariates[c]);
  }
  return some;
}

}  // namespace

std::size_t ScaledRecord::CountTurns() const {
  std::size_t end = counts.size();
  while (end > 0 && counts[end - 1] == 0) --end;
  return static_cast<std::size_t>(
      std::ranges::count_if(reversals, [&](std::size_t turn) { return turn + 1 < end; }));
}

bool ScaledRecord::StartsInside(double share) const {
  const auto [lowest, highest] = std::ranges::minmax(excitation());
  const double start = excitation().front();
  return std::min(start - lowest, highest - start) > share * (highest - lowest);
}

bool ScaledRecord::BeginsAtZeros(const Thresholds& thresholds) const {
  return std::abs(displacement.front() * units.length + units.displacement_reference) <=
             thresholds.starts_unloaded * units.length &&
         std::abs(force.front() * units.force + units.force_reference) <=
             thresholds.starts_without_force * units.force;
}

bool ScaledRecord::BeginsOnLoop() const {
  if (reversals.size() < 2) return false;
  constexpr double kBeside = 0.1;        // of half the range of the displacement
  constexpr double kBesideForce = 0.25;  // of half the range of the force
  const auto [lowest, highest] = std::ranges::minmax(displacement);
  const auto [least, greatest] = std::ranges::minmax(force);
  const double x = displacement.front();
  const double f = force.front();
  bool is_on_loop = false;
  for (std::size_t i = reversals[0]; i <= reversals[1]; ++i) {
    const auto is_near = [&](double place, double force_there) {
      return std::abs(displacement[i] - place) < kBeside * (highest - lowest) / 2 &&
             std::abs(force[i] - force_there) < kBesideForce * (greatest - least) / 2;
    };
    if (is_near(x, f)) return false;  // between both sides, as where the contact is unloaded
    is_on_loop = is_on_loop || is_near(lowest + highest - x, least + greatest - f);
  }
  return is_on_loop;
}

ScaledRecords Scale(loop::PreparedRecords& records, const FitOptions& options,
                    const FitOptions* with) {
  LeaveOutBeyondLags(options, records);
  ScaledRecords scaled;
  scaled.excitation = records.excitation;
  scaled.length = scaled.force = 0.0;
  scaled.counted = records.counted();
  for (const loop::PreparedRecord& record : records.records) {
    scaled.length = std::max(scaled.length, ExtremesOf(record.displacement()).half_range());
    scaled.force = std::max(scaled.force, ExtremesOf(record.force()).half_range());
  }
  RequireScale("half range of the displacement [m]", scaled.length);
  RequireScale("half range of the force [N]", scaled.force);
  const double sense = records.force_sense;
  for (const loop::PreparedRecord& prepared : records.records) {
    const std::span<const double> displacement = prepared.displacement();
    const double force_reference = ExtremesOf(prepared.force()).middle();
    std::vector<double> time(prepared.record.time.begin(), prepared.record.time.end());
    const bool is_timed = !time.empty();
    while (time.size() < prepared.size()) time.push_back(static_cast<double>(time.size()));
    const double duration = time.back() - time.front();
    if (is_timed && duration > 0) {
      RequireScale("half duration [s]", time.back() / 2 - time.front() / 2);
    }
    const std::size_t before = scaled.samples();
    ScaledRecord& target = scaled.records.emplace_back();
    target.first = before;
    target.imposed = records.excitation;
    target.is_smoothed = prepared.displacement_noise > 0;
    target.reversals = prepared.reversals;
    target.begins_at_turn = options.preparation.begins_at_turn;
    target.counts = prepared.counts;
    target.units = {.force = scaled.force,
                    .length = scaled.length,
                    .half_duration = duration > 0 ? duration / 2 : 1.0,
                    .cycle = MeanCycleDuration(duration, prepared.reversals.size()),
                    .force_sense = sense,
                    .force_reference = sense * force_reference,
                    .displacement_reference = ExtremesOf(displacement).middle()};
    target.displacement = Scaled(displacement, target.units.displacement_reference, scaled.length);
    target.force = Scaled(prepared.force(), force_reference, sense * scaled.force);
    target.time = Scaled(time, time.front(), target.units.half_duration);
    for (double& value : target.time) value -= 1;
    target.root_weight.assign(prepared.counts.begin(), prepared.counts.end());
    if (!is_timed) continue;
    const double unit = scaled.records.front().units.half_duration;
    target.velocity = DerivativeOf(target.displacement, target, unit);
    target.units.speed = target.units.length / unit;
  }
  TakeLoads(scaled, records, options);
  AddColumns(with != nullptr ? *with : options, records, scaled);
  return scaled;
}

std::vector<Stroke> StrokesOf(const ScaledRecord& record) {
  const std::span<const double> excitation = record.excitation();
  std::vector<Stroke> strokes(record.reversals.size() + 1);
  for (std::size_t s = 0; s < strokes.size(); ++s) {
    Stroke& stroke = strokes[s];
    stroke.begin = s > 0 ? strokes[s - 1].end : 0;
    stroke.end = s < record.reversals.size() ? record.reversals[s] : record.size() - 1;
    const double travel = excitation[stroke.end] - excitation[stroke.begin];
    stroke.direction = travel >= 0 ? 1.0 : -1.0;
    stroke.length = std::abs(travel);
  }
  return strokes;
}

std::vector<Stroke> MainStrokes(const ScaledRecord& record, const Thresholds& thresholds) {
  std::vector<Stroke> strokes = StrokesOf(record);
  const double longest = std::ranges::max(strokes, {}, &Stroke::length).length;
  std::erase_if(strokes, [&](const Stroke& stroke) {
    return !(stroke.length > 0) || stroke.length < thresholds.main_stroke * longest;
  });
  return strokes;
}

std::vector<double> DirectionsOf(const ScaledRecord& record) {
  std::vector<double> directions;
  for (const Stroke& stroke : StrokesOf(record)) {
    directions.resize(stroke.end + 1, stroke.direction);
  }
  return directions;
}

ScaledRecords Thinned(const ScaledRecords& data) {
  constexpr double kKeptOfAStroke = 10.0;  // samples, at growing fractions of its travel: (k/n)³
  // Cycles of which so many are kept, spread over the record; of others the ends and one between.
  constexpr std::size_t kDenseCycles = 8;
  ScaledRecords thinned = data;
  thinned.counted = 0;
  std::size_t first = 0;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    const ScaledRecord& record = data.records[r];
    const std::vector<Stroke> strokes = StrokesOf(record);
    const std::size_t cycles = (strokes.size() + 1) / 2;
    std::vector<std::size_t> samples = {0};
    std::vector<std::size_t> turns;
    for (std::size_t s = 0; s < strokes.size(); ++s) {
      const std::size_t begin = strokes[s].begin;
      const std::size_t end = strokes[s].end;
      // Under a load that varies the path between samples is part of the history.
      const bool is_dense =
          s / 2 * kDenseCycles % cycles < kDenseCycles || !record.load_ratio.empty();
      const double kept = is_dense ? kKeptOfAStroke : 2.0;
      const double way = record.displacement[end] - record.displacement[begin];
      double next = 1.0;
      for (std::size_t i = begin + 1; way != 0 && i < end && next < kept; ++i) {
        const double share = (record.displacement[i] - record.displacement[begin]) / way;
        const double passed = kept * std::cbrt(share);
        if (passed < next) continue;
        samples.push_back(i);
        next = std::floor(passed) + 1;
      }
      if (end > begin) samples.push_back(end);
      if (turns.size() < record.reversals.size()) turns.push_back(samples.size() - 1);
    }
    ScaledRecord& thin = thinned.records[r] = SomeOf(record, samples);
    thin.reversals = std::move(turns);
    thin.whole = &record;
    thin.first = std::exchange(first, first + thin.size());
    for (const unsigned char counts : thin.counts) thinned.counted += counts;
  }
  return thinned;
}

}  // namespace mindahl::identification
