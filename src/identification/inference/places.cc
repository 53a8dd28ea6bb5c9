#include "identification/inference/places.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "mindahl/models/friction_model.h"

namespace mindahl::identification {
namespace {

/// Derivative by time, by differences to both sides; 0 where time does not go on.
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
  for (std::size_t k = 0; k < values.size() && values.size() > 2 * kStep; ++k) {
    const std::size_t i = std::clamp(k, kStep, values.size() - 1 - kStep);
    const double back = time[i] - time[i - kStep];
    const double on = time[i + kStep] - time[i];
    if (!(back > 0 && on > 0)) continue;
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
    for (std::size_t i = first + 1; i < next && duration > 0; ++i) {
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

}  // namespace

std::vector<Place> PlacesOf(const Problem& problem, std::span<const double> theta,
                            double held_readings, Response& response) {
  const ScaledRecords& data = *problem.data;
  const bool is_forced = data.is_forced();
  const bool tells_asymmetry = AnyIsVirgin(problem.states) &&
                               problem.model->memory == models::Memory::kReturnPoint &&
                               !data.load_varies && !is_forced;
  std::vector<double> contact(problem.size());  // its response
  std::vector<double> complete(problem.size());
  std::vector<double> by_asymmetry(problem.size());
  ResponseColumns wanted;
  if (tells_asymmetry) wanted[TermId::kAsymmetry] = by_asymmetry;
  response.Bind(problem);
  response.Evaluate(theta, contact, wanted);
  if (is_forced) {
    const double scale = std::exp(LogScaleAt(problem, theta));
    for (double& value : contact) value *= scale;
    complete = contact;
  } else {
    Predict(problem, theta, response, complete);
  }
  double peak = 0.0;
  for (const double value : contact) peak = std::max(peak, std::abs(value));
  const bool is_held = IsDisplacementHeld(data, held_readings);
  std::vector<Place> places(problem.size());
  std::size_t begin = 0;
  for (const ScaledRecord& record : data.records) {
    const std::span<const double> whole = std::span(complete).subspan(begin, record.size());
    const std::span<const double> own = std::span(contact).subspan(begin, record.size());
    const std::span<Place> of = std::span(places).subspan(begin, record.size());
    std::vector<double> time = record.time;
    for (double& value : time) value *= record.units.half_duration;
    const std::vector<double> velocity = Derive(record.displacement, time);
    const std::vector<double> acceleration = DeriveTwice(record.displacement, time);
    const std::vector<double> rate = Derive(whole, time, record.reversals);
    const std::vector<double> curvature = DeriveTwice(whole, time);
    for (std::size_t i = 0; i < record.size(); ++i) {
      of[i] = {.displacement = is_forced ? own[i] : record.displacement[i],
               .time = time[i],
               .velocity = velocity[i],
               .acceleration = acceleration[i],
               .rate = rate[i],
               .curvature = curvature[i],
               .force = is_forced ? record.force[i] : own[i],
               .peak = peak,
               .load_change = record.load_change.empty() ? 0.0 : record.load_change[i],
               .asymmetry = by_asymmetry[begin + i]};
    }
    SetProgress(record, own, of);
    if (is_held) SetMissedWay(of);
    begin += record.size();
  }
  return places;
}

}  // namespace mindahl::identification
