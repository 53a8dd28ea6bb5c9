#include "identification/inference/places.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>

#include "mindahl/models/friction_model.h"
#include "models/normalized_response.h"

namespace mindahl::identification {
namespace {

/// The samples of a record that were measured, and when: derivatives by time look at no others.
struct Sampling {
  std::vector<std::size_t> samples;
  std::vector<unsigned char> turns_after;  // of each: the motion turns there or before the next one
  std::vector<unsigned char> turned;       // of each: it turned between it and the one before
  std::vector<double> time;                // of all samples of the record
};

Sampling SamplesOf(const ScaledRecord& record) {
  Sampling sampling;
  std::size_t next = 0;
  bool turned = false;
  for (std::size_t i = 0; i < record.size(); ++i) {
    const bool turns = next < record.reversals.size() && record.reversals[next] == i;
    if (turns) ++next;
    if (!record.inserted.empty() && record.inserted[i] != 0) {
      turned = turns;
      if (turns && !sampling.samples.empty()) sampling.turns_after.back() = 1;
      continue;
    }
    sampling.samples.push_back(i);
    sampling.turned.push_back(turned ? 1 : 0);
    sampling.turns_after.push_back(turns ? 1 : 0);
    turned = false;
  }
  return sampling;
}

/// Returns the samplings of all records, by the number of the sample where time does not go on.
std::vector<Sampling> SamplingsOf(const ScaledRecords& data) {
  std::vector<Sampling> samplings;
  samplings.reserve(data.records.size());
  bool is_timed = true;
  for (const ScaledRecord& record : data.records) {
    const auto& samples = samplings.emplace_back(SamplesOf(record)).samples;
    const auto grows = [&](std::size_t one, std::size_t next) {
      return record.time[next] > record.time[one];
    };
    is_timed = is_timed && !record.velocity.empty() &&
               std::ranges::adjacent_find(samples, std::not_fn(grows)) == samples.end();
  }
  const double first = static_cast<double>(samplings[0].samples.size()) - 1;
  const double unit = is_timed ? data.records[0].units.half_duration : std::max(first, 1.0) / 2;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    const ScaledRecord& record = data.records[r];
    const auto& samples = samplings[r].samples;
    samplings[r].time.resize(record.size());
    const double middle = (static_cast<double>(samples.size()) - 1) / 2;
    for (std::size_t k = 0; k < samples.size(); ++k) {
      const std::size_t i = samples[k];
      samplings[r].time[i] = is_timed ? record.time[i] * record.units.half_duration / unit
                                      : (static_cast<double>(k) - middle) / unit;
    }
  }
  return samplings;
}

/// Derivative by time, by differences to both sides.
/// @param within_strokes  never beyond a turn; a turn is the stroke's that ends there
std::vector<double> Derive(std::span<const double> values, const Sampling& sampling,
                           bool within_strokes) {
  const auto& samples = sampling.samples;
  std::vector<double> rate(values.size());
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const bool looks_back = k > 0 && !(within_strokes && sampling.turned[k] != 0);
    const bool looks_on =
        k + 1 < samples.size() && !(within_strokes && sampling.turns_after[k] != 0 && k > 0);
    const std::size_t before = samples[looks_back ? k - 1 : k];
    const std::size_t after = samples[looks_on ? k + 1 : k];
    const double step = sampling.time[after] - sampling.time[before];
    rate[samples[k]] = step > 0 ? (values[after] - values[before]) / step : 0.0;
  }
  return rate;
}

/// Second derivative by time, of the parabola through every other sample: one between neighbours
/// would see four times as much of the displacement's noise.
std::vector<double> DeriveTwice(std::span<const double> values, const Sampling& sampling) {
  constexpr std::size_t kStep = 2;
  const auto& [samples, turns_after, turned, time] = sampling;
  std::vector<double> second(values.size());
  if (samples.size() < 2 * kStep + 1) return second;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const std::size_t middle = std::clamp(k, kStep, samples.size() - 1 - kStep);
    const std::size_t i = samples[middle];
    const std::size_t before = samples[middle - kStep];
    const std::size_t after = samples[middle + kStep];
    const double back = time[i] - time[before];
    const double on = time[after] - time[i];
    second[samples[k]] =
        2 * ((values[after] - values[i]) / on - (values[i] - values[before]) / back) / (back + on);
  }
  return second;
}

/// True if many readings of the displacement repeat the one before: it may be read less often than
/// the force, and what is missing of the motion is no white noise.
bool IsDisplacementHeld(const ScaledRecords& data, std::span<const Sampling> samplings,
                        double often) {
  std::size_t repeated = 0;
  std::size_t all = 0;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    const auto& samples = samplings[r].samples;
    for (std::size_t k = 1; k < samples.size(); ++k, ++all) {
      const auto& displacement = data.records[r].displacement;
      if (displacement[samples[k]] == displacement[samples[k - 1]]) ++repeated;
    }
  }
  return static_cast<double>(repeated) > often * static_cast<double>(all);
}

/// Sets the travel since the displacement was last read anew: what is repeated was read at the
/// first of the repeats, and went straight on to the next reading.
void SetMissedWay(const ScaledRecord& record, const Sampling& sampling, std::span<Place> places) {
  const auto& samples = sampling.samples;
  for (std::size_t k = 0; k < samples.size();) {
    const double reading = record.displacement[samples[k]];
    std::size_t next = k + 1;
    while (next < samples.size() && record.displacement[samples[next]] == reading) ++next;
    if (next == samples.size()) break;
    const double step = record.displacement[samples[next]] - reading;
    const double duration = sampling.time[samples[next]] - sampling.time[samples[k]];
    for (std::size_t j = k + 1; j < next; ++j) {
      places[samples[j]].missed =
          step * (sampling.time[samples[j]] - sampling.time[samples[k]]) / duration;
    }
    k = next;
  }
}

/// Sets what a place has of a branch that starts at `origin`.
void PutOn(const models::LoadingPath& path, std::size_t b, const Place& origin,
           const models::FrictionModel& model, Place& at) {
  const models::Branch& branch = path.branches[b];
  at.virgin = models::IsVirgin(branch.start);
  at.direction = at.virgin ? std::copysign(1.0, at.imposed - branch.origin)
                           : static_cast<double>(branch.direction);
  at.sets_out = at.virgin && at.direction * branch.direction > 0;
  const models::BranchScale scale = model.scale(at.direction * origin.carried, at.virgin);
  at.span = scale.span;
  at.reach = scale.span * scale.remaining;
  at.origin = branch.origin;
  at.origin_carried = origin.carried;
}

/// Puts samples and origins on their branches.
void FollowBranches(const models::FrictionModel& model, RecordPlaces& record) {
  const models::LoadingPath& path = *record.path;
  const auto put_on = [&](std::int32_t branch, Place& at) {
    const auto b = static_cast<std::size_t>(branch);
    PutOn(path, b, record.origins[b], model, at);
    at.reach *= models::VirginLimit(path, path.branches[b]);
  };
  for (std::size_t b = 0; b < path.branches.size(); ++b) {
    if (path.branches[b].parent >= 0) put_on(path.branches[b].parent, record.origins[b]);
  }
  for (const models::BranchRun& run : path.runs) {
    for (std::size_t i = run.begin; i < run.end; ++i) put_on(run.branch, record.samples[i]);
  }
}

/// The upper extreme of the steady loop, on the branch from the lower one.
Place SteadyExtreme(const Problem& problem, const LawPoint& point, const ScaledRecord& record) {
  const std::span<const double> displacement = record.displacement;
  const auto [lowest, highest] = std::ranges::minmax(displacement);
  const std::array<double, 2> stroke = {lowest, highest};
  const bool is_masing = problem.model->memory == models::Memory::kReturnPoint;
  const models::LoadingPath path = models::MakeLoadingPath(
      stroke, {}, problem.model->memory,
      {.state = models::InitialState::kSteady,
       .asymmetry = is_masing ? problem.parameters.AsymmetryAt(point.theta) : 0.0});
  const models::NormalizedLaw law = LawUnder(problem, point, record);
  models::NormalizedResponse response;
  std::array<double, 2> t{};
  response.Evaluate(*problem.model, law, path, stroke, t);
  models::OriginSensitivity sensitivity;
  response.DifferentiateByOrigins(*problem.model, law, path, stroke, sensitivity);
  Place at{.displacement = highest,
           .imposed = highest,
           .carried = t[1],
           .slope = sensitivity.sample_slope[1],
           .gain = sensitivity.sample_gain[1]};
  PutOn(path, static_cast<std::size_t>(path.runs.back().branch), {.carried = t[0]}, *problem.model,
        at);
  return at;
}

/// Places under an imposed force, which a column of displacements adds to as it goes.
std::vector<RecordPlaces> PlacesUnderForce(const Problem& problem, std::span<const double> theta,
                                           Response& response,
                                           std::span<const Sampling> samplings) {
  const ScaledRecords& data = *problem.data;
  std::vector<double> displacement(problem.size());
  response.Bind(problem);
  response.Evaluate(PointAt(problem, theta), displacement);
  const double slip_force = std::exp(theta[kSlipForce]);
  const double scale = std::exp(LogScaleAt(problem, theta));
  for (double& value : displacement) value *= scale;
  std::vector<RecordPlaces> places(data.records.size());
  std::size_t begin = 0;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    const ScaledRecord& record = data.records[r];
    RecordPlaces& of = places[r];
    of.path = &response.PathOf(r, theta);
    of.starts_at_zero = true;
    const double unloaded = models::UnloadedAt(*of.path);
    const std::span<const double> own = std::span(displacement).subspan(begin, record.size());
    const std::vector<double> rate = Derive(own, samplings[r], true);
    of.samples.reserve(record.size());
    for (std::size_t i = 0; i < record.size(); ++i) {
      of.samples.push_back({.displacement = own[i],
                            .time = samplings[r].time[i],
                            .rate = rate[i],
                            .force = record.force[i],
                            .imposed = record.force[i],
                            .carried = (record.force[i] - unloaded) / slip_force});
    }
    for (const models::Branch& branch : of.path->branches) {
      of.origins.push_back(
          {.imposed = branch.origin, .carried = (branch.origin - unloaded) / slip_force});
    }
    FollowBranches(*problem.model, of);
    begin += record.size();
  }
  return places;
}

/// Returns what is added to a column where branches start, from what it is on the first of them.
std::vector<double> StartsOf(double (*value)(const Place&), const RecordPlaces& record,
                             double first) {
  std::vector<double> start(record.origins.size(), first);
  for (std::size_t b = 0; b < record.origins.size(); ++b) {
    const std::int32_t parent = record.path->branches[b].parent;
    if (parent < 0) continue;
    start[b] =
        record.origins[b].gain * start[static_cast<std::size_t>(parent)] + value(record.origins[b]);
  }
  return start;
}

/// On the first branch: nothing where the contact was unloaded; a steady loop stays symmetric.
double FirstStart(double (*value)(const Place&), const RecordPlaces& record) {
  if (record.starts_at_zero) return 0.0;
  const models::Branch& first = record.path->branches.front();
  switch (first.start) {
    case models::BranchStart::kSteadyCentre: {
      const std::vector<double> start = StartsOf(value, record, 0.0);
      return -(start[1] + start[2]) / 2;
    }
    case models::BranchStart::kSteadyExtreme:
      return -first.direction * value(record.extreme) / (1 + record.extreme.gain);
    default:
      return 0.0;
  }
}

}  // namespace

double Place::Mobilised() const {
  if (!(reach > 0)) return 1.0;
  return std::clamp(std::abs(carried - origin_carried) / reach, 0.0, 1.0);
}

std::vector<RecordPlaces> PlacesOf(const Problem& problem, std::span<const double> theta,
                                   double held_readings, Response& response) {
  const ScaledRecords& data = *problem.data;
  const std::vector<Sampling> samplings = SamplingsOf(data);
  if (data.is_forced()) return PlacesUnderForce(problem, theta, response, samplings);
  const LawPoint point = PointAt(problem, theta);
  const bool tells_asymmetry = AnyIsVirgin(problem.states) &&
                               problem.model->memory == models::Memory::kReturnPoint &&
                               !data.load_varies;
  std::vector<double> force(problem.size());
  std::vector<double> complete(problem.size());
  std::vector<double> by_asymmetry(tells_asymmetry ? problem.size() : 0);
  ResponseColumns wanted;
  wanted[TermId::kAsymmetry] = by_asymmetry;
  response.Bind(problem);
  response.Differentiate(point, force, wanted);
  Predict(problem, theta, response, complete);
  double peak = 0.0;
  for (const double value : force) peak = std::max(peak, std::abs(value));
  const bool is_held = IsDisplacementHeld(data, samplings, held_readings);
  std::vector<RecordPlaces> places(data.records.size());
  std::size_t begin = 0;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    const ScaledRecord& record = data.records[r];
    const Sampling& sampling = samplings[r];
    const std::span<const double> whole = std::span(complete).subspan(begin, record.size());
    const std::vector<double> velocity = Derive(record.displacement, sampling, false);
    const std::vector<double> acceleration = DeriveTwice(record.displacement, sampling);
    const std::vector<double> rate = Derive(whole, sampling, true);
    const std::vector<double> curvature = DeriveTwice(whole, sampling);
    models::OriginSensitivity sensitivity;
    response.DifferentiateByOrigins(point, r, sensitivity);
    RecordPlaces& of = places[r];
    of.samples.reserve(record.size());
    for (std::size_t i = 0; i < record.size(); ++i) {
      const double load = record.LoadAt(i);
      const double of_contact = force[begin + i];
      of.samples.push_back({.displacement = record.displacement[i],
                            .time = sampling.time[i],
                            .velocity = velocity[i],
                            .acceleration = acceleration[i],
                            .rate = rate[i],
                            .curvature = curvature[i],
                            .force = of_contact,
                            .peak = peak,
                            .load_change = record.load_change.empty() ? 0.0 : record.load_change[i],
                            .asymmetry = tells_asymmetry ? by_asymmetry[begin + i] : 0.0,
                            .imposed = record.displacement[i],
                            .carried = load != 0 ? of_contact / load : 0.0,
                            .slope = sensitivity.sample_slope[i],
                            .gain = sensitivity.sample_gain[i]});
    }
    if (is_held) SetMissedWay(record, sampling, of.samples);
    of.path = &response.PathOf(r, theta);
    for (std::size_t b = 0; b < of.path->branches.size(); ++b) {
      const models::Branch& branch = of.path->branches[b];
      const bool is_unloaded = branch.start == models::BranchStart::kUnloaded;
      of.origins.push_back({.displacement = branch.origin,
                            .imposed = branch.origin,
                            .carried = is_unloaded ? 0.0 : sensitivity.origin_force[b],
                            .slope = sensitivity.slope[b],
                            .gain = sensitivity.gain[b]});
    }
    FollowBranches(*problem.model, of);
    if (problem.states[r] == models::InitialState::kSteady) {
      of.extreme = SteadyExtreme(problem, point, record);
    }
    begin += record.size();
  }
  return places;
}

void FillAlongBranches(double (*value)(const Place&), const RecordPlaces& record,
                       std::span<double> column) {
  const std::vector<double> start = StartsOf(value, record, FirstStart(value, record));
  for (const models::BranchRun& run : record.path->runs) {
    for (std::size_t i = run.begin; i < run.end; ++i) {
      column[i] = record.samples[i].gain * start[static_cast<std::size_t>(run.branch)] +
                  value(record.samples[i]);
    }
  }
}

}  // namespace mindahl::identification
