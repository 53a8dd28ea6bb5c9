#include "identification/inference/places.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>

#include "mindahl/models/friction_model.h"

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

/// Sets how far the response has come in its stroke, and by how much it changes there.
void SetProgress(const ScaledRecord& record, std::span<const double> response,
                 std::span<Place> places) {
  for (const Stroke& stroke : StrokesOf(record.excitation(), record.reversals)) {
    const double change = response[stroke.end] - response[stroke.begin];
    for (std::size_t i = stroke.begin == 0 ? 0 : stroke.begin + 1; i <= stroke.end; ++i) {
      const double way = response[i] - response[stroke.begin];
      places[i].direction = stroke.direction;
      places[i].change = change;
      places[i].progress = change != 0 ? std::clamp(way / change, 0.0, 1.0) : 0.0;
    }
  }
}

/// Places under an imposed force, which a column of displacements adds to as it goes.
std::vector<Place> PlacesUnderForce(const Problem& problem, std::span<const double> theta,
                                    Response& response, std::span<const Sampling> samplings) {
  const ScaledRecords& data = *problem.data;
  std::vector<double> displacement(problem.size());
  response.Bind(problem);
  response.Evaluate(PointAt(problem, theta), displacement);
  const double scale = std::exp(LogScaleAt(problem, theta));
  for (double& value : displacement) value *= scale;
  std::vector<Place> places(problem.size());
  std::size_t begin = 0;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    const ScaledRecord& record = data.records[r];
    const std::span<const double> own = std::span(displacement).subspan(begin, record.size());
    const std::span<Place> of = std::span(places).subspan(begin, record.size());
    const std::vector<double> rate = Derive(own, samplings[r], true);
    for (std::size_t i = 0; i < record.size(); ++i) {
      of[i] = {.displacement = own[i],
               .time = samplings[r].time[i],
               .rate = rate[i],
               .force = record.force[i]};
    }
    SetProgress(record, own, of);
    begin += record.size();
  }
  return places;
}

}  // namespace

std::vector<Place> PlacesOf(const Problem& problem, std::span<const double> theta,
                            double held_readings, Response& response) {
  const ScaledRecords& data = *problem.data;
  const std::vector<Sampling> samplings = SamplingsOf(data);
  if (data.is_forced()) return PlacesUnderForce(problem, theta, response, samplings);
  const bool tells_asymmetry = AnyIsVirgin(problem.states) &&
                               problem.model->memory == models::Memory::kReturnPoint &&
                               !data.load_varies;
  std::vector<double> force(problem.size());
  std::vector<double> complete(problem.size());
  std::vector<double> by_asymmetry(tells_asymmetry ? problem.size() : 0);
  ResponseColumns wanted;
  wanted[TermId::kAsymmetry] = by_asymmetry;
  response.Bind(problem);
  response.Differentiate(PointAt(problem, theta), force, wanted);
  Predict(problem, theta, response, complete);
  double peak = 0.0;
  for (const double value : force) peak = std::max(peak, std::abs(value));
  const bool is_held = IsDisplacementHeld(data, samplings, held_readings);
  std::vector<Place> places(problem.size());
  std::size_t begin = 0;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    const ScaledRecord& record = data.records[r];
    const Sampling& sampling = samplings[r];
    const std::span<const double> whole = std::span(complete).subspan(begin, record.size());
    const std::span<const double> of_contact = std::span(force).subspan(begin, record.size());
    const std::span<Place> of = std::span(places).subspan(begin, record.size());
    const std::vector<double> velocity = Derive(record.displacement, sampling, false);
    const std::vector<double> acceleration = DeriveTwice(record.displacement, sampling);
    const std::vector<double> rate = Derive(whole, sampling, true);
    const std::vector<double> curvature = DeriveTwice(whole, sampling);
    for (std::size_t i = 0; i < record.size(); ++i) {
      of[i] = {.displacement = record.displacement[i],
               .time = sampling.time[i],
               .velocity = velocity[i],
               .acceleration = acceleration[i],
               .rate = rate[i],
               .curvature = curvature[i],
               .force = of_contact[i],
               .peak = peak,
               .load_change = record.load_change.empty() ? 0.0 : record.load_change[i],
               .asymmetry = tells_asymmetry ? by_asymmetry[begin + i] : 0.0};
    }
    SetProgress(record, of_contact, of);
    if (is_held) SetMissedWay(record, sampling, of);
    begin += record.size();
  }
  return places;
}

}  // namespace mindahl::identification
