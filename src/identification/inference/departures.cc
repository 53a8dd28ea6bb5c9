#include "identification/inference/departures.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>

#include "identification/problem/scaled_records.h"

namespace mindahl::identification {

namespace {

/// Derivative by time at a sample, by differences to both sides; 0 where time does not go on.
/// @param turns  ascending; none looks beyond: one is the stroke's that ends there
double RateAt(std::size_t i, std::span<const double> values, std::span<const double> time,
              std::span<const std::size_t> turns = {}) {
  const bool is_turn = i > 0 && std::ranges::binary_search(turns, i);
  const std::size_t before = i > 0 ? i - 1 : i;
  const std::size_t after = i + 1 < values.size() && !is_turn ? i + 1 : i;
  const double step = time[after] - time[before];
  return step > 0 ? (values[after] - values[before]) / step : 0.0;
}

/// Second derivative by time, of the parabola through every other sample: one between neighbours
/// would see four times as much of the displacement's noise.
double CurvatureAt(std::size_t at, std::span<const double> values, std::span<const double> time) {
  constexpr std::size_t kStep = 2;
  if (values.size() <= 2 * kStep) return 0.0;
  const std::size_t i = std::clamp(at, kStep, values.size() - 1 - kStep);
  const double back = time[i] - time[i - kStep];
  const double on = time[i + kStep] - time[i];
  if (!(back > 0 && on > 0)) return 0.0;
  return 2 * ((values[i + kStep] - values[i]) / on - (values[i] - values[i - kStep]) / back) /
         (back + on);
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
  for (const Stroke& stroke : StrokesOf(record)) {
    const double change = response[stroke.end] - response[stroke.begin];
    for (std::size_t i = stroke.begin == 0 ? 0 : stroke.begin + 1; i <= stroke.end; ++i) {
      const double way = response[i] - response[stroke.begin];
      places[i].direction = stroke.direction;
      places[i].change = change;
      places[i].progress = change != 0 ? std::clamp(way / change, 0.0, 1.0) : 0.0;
    }
  }
}

/// Returns the places of every sample at θ.
/// @param held_readings  fraction of the readings that repeat the last one, of a held displacement
std::vector<Place> PlacesOf(const Problem& problem, std::span<const double> theta,
                            double held_readings) {
  const ScaledRecords& data = *problem.data;
  const bool is_forced = data.is_forced();
  const bool tells_asymmetry =
      problem.is_virgin() && problem.is_masing() && !data.load_varies && !is_forced;
  Eigen::VectorXd contact(static_cast<Eigen::Index>(problem.size()));  // its response
  const std::span<double> of_contact(contact.data(), problem.size());
  std::vector<double> by_asymmetry(problem.size());
  ResponseColumns wanted;
  if (tells_asymmetry) wanted[TermId::kAsymmetry] = by_asymmetry;
  Response(problem).Evaluate(theta, of_contact, wanted);
  if (is_forced) contact *= std::exp(LogScaleAt(problem, theta));
  const Eigen::VectorXd complete = is_forced ? contact : Predict(problem, theta);
  const double peak = contact.cwiseAbs().maxCoeff();
  // If many readings repeat the one before, the displacement may be read less often than the force,
  // and what is missing of the motion is no white noise.
  double repeated = 0.0;
  for (const ScaledRecord& record : data.records) {
    const std::vector<double>& read = record.displacement;
    repeated += std::inner_product(read.begin() + 1, read.end(), read.begin(), 0.0, std::plus(),
                                   std::equal_to());
  }
  const auto pairs = static_cast<double>(data.samples() - data.records.size());
  const bool is_held = repeated > held_readings * pairs;
  std::vector<Place> places(problem.size());
  for (const ScaledRecord& record : data.records) {
    const std::span<const double> whole = record.Of(std::span(complete.data(), problem.size()));
    const std::span<const double> own = record.Of(of_contact);
    const std::span<const double> asymmetry = record.Of(std::span(by_asymmetry));
    const std::span<Place> of = record.Of(std::span(places));
    std::vector<double> time = record.time;
    for (double& value : time) value *= record.units.half_duration;
    for (std::size_t i = 0; i < record.size(); ++i) {
      of[i] = {.displacement = is_forced ? own[i] : record.displacement[i],
               .time = time[i],
               .velocity = RateAt(i, record.displacement, time),
               .acceleration = CurvatureAt(i, record.displacement, time),
               .rate = RateAt(i, whole, time, record.reversals),
               .curvature = CurvatureAt(i, whole, time),
               .force = is_forced ? record.force[i] : own[i],
               .peak = peak,
               .load_change = record.load_change.empty() ? 0.0 : record.load_change[i],
               .asymmetry = asymmetry[i]};
    }
    SetProgress(record, own, of);
    if (is_held) SetMissedWay(of);
  }
  return places;
}

double Square(double x) { return x * x; }
double Cube(double x) { return x * x * x; }

template <double Place::*kMember>
double Of(const Place& at) {
  return at.*kMember;
}
double Lag(const Place& at) { return -at.rate; }
double LagByTime(const Place& at) { return Lag(at) * at.time; }
double ForceOfContact(const Place& at) { return -at.force; }
double Gap(const Place& at) { return -at.direction; }
double ForceByLoad(const Place& at) { return at.force * at.load_change; }
double SizeOfForce(const Place& at) { return std::abs(at.force); }
double CubeOfForce(const Place& at) { return Cube(at.force); }
double RootOfSpeed(const Place& at) {
  return std::copysign(std::sqrt(std::abs(at.velocity)), at.velocity);
}
double ForceByTime(const Place& at) { return at.force * at.time; }
double Quadratic(const Place& at) { return Square(at.displacement); }
double Cubic(const Place& at) { return Cube(at.displacement); }
double Position(const Place& at) { return at.force * at.displacement; }
double PositionSquared(const Place& at) { return at.force * Square(at.displacement); }
double PositionOfSize(const Place& at) { return SizeOfForce(at) * at.displacement; }
double PositionSquaredOfSize(const Place& at) { return SizeOfForce(at) * Square(at.displacement); }

/// A branch of another shape between the same ends.
template <int kHalfWaves>
double Bulge(const Place& at) {
  return at.change * std::sin(kHalfWaves * std::numbers::pi * at.progress);
}

/// Returns what a sensor loses that is limited beyond nine tenths of the largest force.
double BeyondLimit(const Place& at) {
  constexpr double kFrom = 0.9;
  return -std::copysign(std::max(0.0, std::abs(at.force) - kFrom * at.peak), at.force);
}

// Code, group, columns of a force and of a displacement that answers, moves, term.
constexpr auto kDepartures = std::to_array<Departure>({
    // A force that is read late meets the displacement of later.
    {"channel_lag", "lag", {Lag}, {Of<&Place::rate>}},
    {"viscous_force", "viscous", {Of<&Place::velocity>}},
    {"plateau_slope", "plateau_slope", {Of<&Place::displacement>}},
    {"force_drift", "force_drift", {Of<&Place::time>}},
    {"normal_load", "", {ForceByLoad}},
    {"shape_of_law", "", {Bulge<1>, Bulge<2>, Bulge<3>}, {Bulge<1>, Bulge<2>, Bulge<3>}},
    {"guide_friction", "", {Of<&Place::direction>}},
    {"rig_in_series", "rig_stiffness", {ForceOfContact}, {Of<&Place::force>}, /*moves=*/true},
    {"backlash", "backlash", {Gap}, {Of<&Place::direction>}, /*moves=*/true},
    {"displacement_sensor", "", {Quadratic, Cubic}, {Quadratic, Cubic}, /*moves=*/true},
    {"inertia", "inertia", {Of<&Place::acceleration>}},
    {"unequal_directions", "asymmetry", {SizeOfForce, Of<&Place::asymmetry>}},
    {"running_in", "slip_trend", {ForceByTime}},
    {"force_saturates", "", {BeyondLimit, CubeOfForce}},
    {.code = "slip_position",
     .group = "slip_position",
     .columns = {Position, PositionOfSize},
     .term = "slip_slope"},
    {"force_of_position", "", {Quadratic, Cubic}},
    {"smoothing", "", {Of<&Place::curvature>}},
    // A turn is the first of its repeats, where nothing is missed.
    {"held_displacement", "", {Of<&Place::missed>}, {}, /*moves=*/true},
    {"displacement_drift", "displacement_drift", {}, {Of<&Place::time>}},
    {"displacement_sensor_drift", "", {Of<&Place::time>}, {}, /*moves=*/true},
    {.code = "speed_power",
     .group = "slip_speed",
     .columns = {RootOfSpeed, Of<&Place::velocity>},
     .term = "speed_exponent"},
    {.code = "slip_position_quadratic",
     .group = "slip_position_quadratic",
     .columns = {Position, PositionSquared, PositionOfSize, PositionSquaredOfSize},
     .term = "slip_slope"},
    {"clock_drift", "", {LagByTime, Lag}},
});

/// Replaces a motion of the contact beside its displacement by what it changes in the response.
/// @param places  of all samples at θ
/// @param data    copy of the problem's records, of which the displacements are overwritten
void FollowMotion(const Problem& problem, std::vector<double> theta, std::span<const Place> places,
                  DepartureColumn column, ScaledRecords& data, std::span<double> motion) {
  constexpr double kSmall = 1e-6;  // of the half range of the displacement
  const auto [least, greatest] = std::ranges::minmax(motion);
  if (least == 0 && greatest == 0) return;
  const double step = kSmall / std::max(-least, greatest);
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    const std::vector<double>& measured = problem.data->records[r].displacement;
    const std::span<double> ways = data.records[r].Of(motion);
    if (problem.is_virgin()) {
      double& unloaded = theta[problem.parameters.PositionOfOrigin(r)];
      Place first = data.records[r].Of(places).front();
      if (measured[0] != unloaded) first.direction = std::copysign(1.0, measured[0] - unloaded);
      ways.front() = column(first);
      unloaded += step * column({.displacement = unloaded, .direction = first.direction});
    }
    std::ranges::transform(
        measured, ways, data.records[r].displacement.begin(),
        [&](double displacement, double way) { return displacement + step * way; });
  }
  Problem moved = problem;
  moved.data = &data;
  Response(moved).Evaluate(theta, motion);
  for (std::size_t i = 0; i < motion.size(); ++i) motion[i] = (motion[i] - places[i].force) / step;
}

}  // namespace

std::span<const Departure> Departures() { return kDepartures; }

DepartureColumns ColumnsOfDepartures(const Problem& problem, std::span<const double> theta,
                                     const Thresholds& thresholds, std::size_t most) {
  const std::vector<Place> places = PlacesOf(problem, theta, thresholds.held_readings);
  const Eigen::ArrayXd weight = problem.data->All(&ScaledRecord::root_weight);
  ScaledRecords moved = *problem.data;
  const bool is_forced = problem.data->is_forced();
  constexpr std::size_t kRoom =
      std::tuple_size_v<decltype(Departure::columns)> * kDepartures.size();
  DepartureColumns result;
  result.columns.resize(static_cast<Eigen::Index>(problem.size()), kRoom);
  Eigen::Index count = 0;
  for (const Departure& departure : kDepartures) {
    const std::string_view name = departure.term.empty() ? departure.group : departure.term;
    const bool is_fitted = std::ranges::any_of(problem.parameters.free(), [&](std::size_t p) {
      return problem.parameters[p].term->name == name;
    });
    if (is_fitted) continue;
    OmittedTerm term{{.code = departure.code, .term = departure.group}};
    const std::span<const DepartureColumn> columns =
        is_forced ? std::span<const DepartureColumn>(departure.of_displacement) : departure.columns;
    for (const DepartureColumn column : columns) {
      if (column == nullptr) continue;
      const Eigen::Index place = count + std::ssize(term.places);
      const std::span<double> values = SpanOf(result.columns.col(place));
      std::ranges::transform(places, values.begin(), column);
      if (departure.moves && !is_forced) {
        FollowMotion(problem, {theta.begin(), theta.end()}, places, column, moved, values);
      }
      result.columns.col(place).array() *= weight;
      if (!result.columns.col(place).isZero(0.0)) term.places.push_back(place);
    }
    if (static_cast<std::size_t>(count + std::ssize(term.places)) > most) break;
    count += std::ssize(term.places);
    if (!term.places.empty()) result.terms.push_back(std::move(term));
  }
  result.columns.conservativeResize(Eigen::NoChange, count);
  return result;
}

}  // namespace mindahl::identification
