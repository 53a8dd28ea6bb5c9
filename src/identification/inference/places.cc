#include "identification/inference/places.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>

#include "mindahl/models/friction_model.h"

namespace mindahl::identification {
namespace {

/// Returns the times of all samples, by their number where time does not go on.
std::vector<std::vector<double>> TimesOf(const ScaledRecords& data) {
  const bool is_timed = std::ranges::all_of(data.records, [](const ScaledRecord& record) {
    return !record.velocity.empty() &&
           std::ranges::adjacent_find(record.time, std::greater_equal()) == record.time.end();
  });
  const double first = std::max(static_cast<double>(data.records[0].size()) - 1, 1.0) / 2;
  const double unit = is_timed ? data.records[0].units.half_duration : first;
  std::vector<std::vector<double>> times;
  for (const ScaledRecord& record : data.records) {
    std::vector<double>& time = times.emplace_back(record.size());
    const double middle = (static_cast<double>(record.size()) - 1) / 2;
    for (std::size_t i = 0; i < time.size(); ++i) {
      time[i] = is_timed ? record.time[i] * record.units.half_duration / unit
                         : (static_cast<double>(i) - middle) / unit;
    }
  }
  return times;
}

/// Derivative by time, by differences to both sides.
/// @param turns  none looks beyond; one is the stroke's that ends there
std::vector<double> Derive(std::span<const double> values, std::span<const double> time,
                           std::span<const std::size_t> turns = {}) {
  std::vector<double> rate(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const bool turns_here = !turns.empty() && turns.front() == i;
    if (turns_here) turns = turns.subspan(1);
    const std::size_t before = i > 0 ? i - 1 : i;
    const std::size_t after = i + 1 < values.size() && !(turns_here && i > 0) ? i + 1 : i;
    const double step = time[after] - time[before];
    rate[i] = step > 0 ? (values[after] - values[before]) / step : 0.0;
  }
  return rate;
}

/// Second derivative by time, of the parabola through every other sample: one between neighbours
/// would see four times as much of the displacement's noise.
std::vector<double> DeriveTwice(std::span<const double> values, std::span<const double> time) {
  constexpr std::size_t kStep = 2;
  std::vector<double> second(values.size());
  if (values.size() < 2 * kStep + 1) return second;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const std::size_t i = std::clamp(k, kStep, values.size() - 1 - kStep);
    const double back = time[i] - time[i - kStep];
    const double on = time[i + kStep] - time[i];
    second[k] = 2 *
                ((values[i + kStep] - values[i]) / on - (values[i] - values[i - kStep]) / back) /
                (back + on);
  }
  return second;
}

/// True if many readings of the displacement repeat the one before: it may be read less often than
/// the force, and what is missing of the motion is no white noise.
bool IsDisplacementHeld(const ScaledRecords& data, double often) {
  std::size_t repeated = 0;
  std::size_t all = 0;
  for (const ScaledRecord& record : data.records) {
    const std::vector<double>& displacement = record.displacement;
    for (std::size_t i = 1; i < displacement.size(); ++i, ++all) {
      if (displacement[i] == displacement[i - 1]) ++repeated;
    }
  }
  return static_cast<double>(repeated) > often * static_cast<double>(all);
}

/// Sets the travel since the displacement was last read anew: what is repeated was read at the
/// first of the repeats, and went straight on to the next reading.
void SetMissedWay(std::span<Place> places) {
  for (std::size_t first = 0; first < places.size();) {
    std::size_t next = first + 1;
    while (next < places.size() && places[next].displacement == places[first].displacement) ++next;
    if (next == places.size()) break;
    const double step = places[next].displacement - places[first].displacement;
    const double duration = places[next].time - places[first].time;
    for (std::size_t i = first + 1; i < next; ++i) {
      places[i].missed = step * (places[i].time - places[first].time) / duration;
    }
    first = next;
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
                                    Response& response,
                                    std::span<const std::vector<double>> times) {
  const ScaledRecords& data = *problem.data;
  std::vector<double> displacement(problem.size());
  response.Bind(problem);
  response.Evaluate(theta, displacement);
  const double scale = std::exp(LogScaleAt(problem, theta));
  for (double& value : displacement) value *= scale;
  std::vector<Place> places(problem.size());
  std::size_t begin = 0;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    const ScaledRecord& record = data.records[r];
    const std::span<const double> own = std::span(displacement).subspan(begin, record.size());
    const std::span<Place> of = std::span(places).subspan(begin, record.size());
    const std::vector<double> rate = Derive(own, times[r], record.reversals);
    for (std::size_t i = 0; i < record.size(); ++i) {
      of[i] = {
          .displacement = own[i], .time = times[r][i], .rate = rate[i], .force = record.force[i]};
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
  const std::vector<std::vector<double>> times = TimesOf(data);
  if (data.is_forced()) return PlacesUnderForce(problem, theta, response, times);
  const bool tells_asymmetry = AnyIsVirgin(problem.states) &&
                               problem.model->memory == models::Memory::kReturnPoint &&
                               !data.load_varies;
  std::vector<double> force(problem.size());
  std::vector<double> complete(problem.size());
  std::vector<double> by_asymmetry(tells_asymmetry ? problem.size() : 0);
  ResponseColumns wanted;
  wanted[TermId::kAsymmetry] = by_asymmetry;
  response.Bind(problem);
  response.Differentiate(theta, force, wanted);
  Predict(problem, theta, response, complete);
  double peak = 0.0;
  for (const double value : force) peak = std::max(peak, std::abs(value));
  const bool is_held = IsDisplacementHeld(data, held_readings);
  std::vector<Place> places(problem.size());
  std::size_t begin = 0;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    const ScaledRecord& record = data.records[r];
    const std::span<const double> whole = std::span(complete).subspan(begin, record.size());
    const std::span<const double> of_contact = std::span(force).subspan(begin, record.size());
    const std::span<Place> of = std::span(places).subspan(begin, record.size());
    const std::vector<double> velocity = Derive(record.displacement, times[r]);
    const std::vector<double> acceleration = DeriveTwice(record.displacement, times[r]);
    const std::vector<double> rate = Derive(whole, times[r], record.reversals);
    const std::vector<double> curvature = DeriveTwice(whole, times[r]);
    for (std::size_t i = 0; i < record.size(); ++i) {
      of[i] = {.displacement = record.displacement[i],
               .time = times[r][i],
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
    if (is_held) SetMissedWay(of);
    begin += record.size();
  }
  return places;
}

}  // namespace mindahl::identification
