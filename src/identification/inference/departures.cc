#include "identification/inference/departures.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "identification/problem/scaled_records.h"

namespace mindahl::identification {
namespace {

double Square(double x) { return x * x; }
double Cube(double x) { return x * x * x; }

template <double Place::*kMember>
double Of(const Place& at) {
  return at.*kMember;
}
double Lag(const Place& at) { return -at.rate; }
double ForceOfContact(const Place& at) { return -at.force; }
double Gap(const Place& at) { return -at.direction; }
double Curvature(const Place& at) { return Square(at.displacement); }
double CubicCurvature(const Place& at) { return Cube(at.displacement); }
double Position(const Place& at) { return at.force * at.displacement; }
double PositionSquared(const Place& at) { return at.force * Square(at.displacement); }
double PositionOfSize(const Place& at) { return std::abs(at.force) * at.displacement; }
double PositionSquaredOfSize(const Place& at) {
  return std::abs(at.force) * Square(at.displacement);
}

/// A branch of another shape between the same ends.
template <int kHalfWaves>
double Bulge(const Place& at) {
  return at.change * std::sin(kHalfWaves * std::numbers::pi * at.progress);
}
constexpr std::array kBulges = {&Bulge<1>, &Bulge<2>, &Bulge<3>};

/// Returns what a sensor loses that is limited beyond nine tenths of the largest force.
double BeyondLimit(const Place& at) {
  constexpr double kFrom = 0.9;
  return -std::copysign(std::max(0.0, std::abs(at.force) - kFrom * at.peak), at.force);
}

constexpr auto kDepartures = std::to_array<Departure>({
    // A force that is read late meets the displacement of later.
    {.code = "channel_lag",
     .group = "lag",
     .columns = {Lag},
     .of_displacement = {Of<&Place::rate>}},
    {.code = "viscous_force", .group = "viscous", .columns = {Of<&Place::velocity>}},
    {.code = "plateau_slope", .group = "plateau_slope", .columns = {Of<&Place::displacement>}},
    {.code = "force_drift", .group = "force_drift", .columns = {Of<&Place::time>}},
    {.code = "normal_load", .columns = {[](const Place& at) { return at.force * at.load_change; }}},
    {.code = "shape_of_law",
     .columns = {kBulges[0], kBulges[1], kBulges[2]},
     .of_displacement = kBulges},
    {.code = "guide_friction", .columns = {Of<&Place::direction>}},
    {.code = "rig_in_series",
     .group = "rig_stiffness",
     .columns = {ForceOfContact},
     .of_displacement = {Of<&Place::force>},
     .moves = true},
    {.code = "backlash",
     .group = "backlash",
     .columns = {Gap},
     .of_displacement = {Of<&Place::direction>},
     .moves = true},
    {.code = "displacement_sensor",
     .columns = {Curvature, CubicCurvature},
     .of_displacement = {Curvature, CubicCurvature},
     .moves = true},
    {.code = "inertia", .group = "inertia", .columns = {Of<&Place::acceleration>}},
    {.code = "unequal_directions",
     .group = "asymmetry",
     .columns = {[](const Place& at) { return std::abs(at.force); }, Of<&Place::asymmetry>}},
    {.code = "running_in", .group = "slip_trend", .columns = {[](const Place& at) {
                                                    return at.force * at.time;
                                                  }}},
    {.code = "force_saturates",
     .columns = {BeyondLimit, [](const Place& at) { return Cube(at.force); }}},
    {.code = "slip_position",
     .group = "slip_position",
     .term = "slip_slope",
     .columns = {Position, PositionOfSize}},
    {.code = "force_of_position", .columns = {Curvature, CubicCurvature}},
    {.code = "smoothing", .columns = {Of<&Place::curvature>}},
    // A turn is the first of its repeats, where nothing is missed.
    {.code = "held_displacement", .columns = {Of<&Place::missed>}, .moves = true},
    {.code = "displacement_drift",
     .group = "displacement_drift",
     .of_displacement = {Of<&Place::time>}},
    {.code = "speed_power",
     .group = "slip_speed",
     .term = "speed_exponent",
     .columns = {[](const Place& at) {
                   return std::copysign(std::sqrt(std::abs(at.velocity)), at.velocity);
                 },
                 Of<&Place::velocity>}},
    {.code = "slip_position_quadratic",
     .group = "slip_position_quadratic",
     .term = "slip_slope",
     .columns = {Position, PositionSquared, PositionOfSize, PositionSquaredOfSize}},
    {.code = "clock_drift", .columns = {[](const Place& at) { return Lag(at) * at.time; }, Lag}},
});

bool HasTermOf(const Problem& problem, const Departure& departure) {
  const std::string_view name = departure.term.empty() ? departure.group : departure.term;
  return std::ranges::any_of(problem.parameters.free(), [&](std::size_t p) {
    return problem.parameters[p].term->name == name;
  });
}

/// Makes columns of all records' samples, weighted.
class ColumnMaker {
 public:
  ColumnMaker(const Problem& problem, std::span<const double> theta, const Thresholds& thresholds,
              Response& response)
      : problem_(problem),
        theta_(theta),
        places_(PlacesOf(problem, theta, thresholds.held_readings, response)),
        moved_(*problem.data) {}

  void Fill(DepartureColumn column, bool moves, std::span<double> values) {
    std::ranges::transform(places_, values.begin(), column);
    if (moves) FollowMotion(column, values);
    auto value = values.begin();
    for (const ScaledRecord& record : problem_.data->records) {
      for (const double root_weight : record.root_weight) *value++ *= root_weight;
    }
  }

 private:
  void FollowMotion(DepartureColumn column, std::span<double> motion);

  const Problem& problem_;
  std::span<const double> theta_;
  std::vector<Place> places_;
  ScaledRecords moved_;
};

/// Replaces a motion of the contact beside its displacement by what it changes in the response.
void ColumnMaker::FollowMotion(DepartureColumn column, std::span<double> motion) {
  constexpr double kSmall = 1e-6;  // of the half range of the displacement
  double largest = 0.0;
  for (const double way : motion) largest = std::max(largest, std::abs(way));
  if (largest == 0) return;
  const double step = kSmall / largest;
  std::vector<double> theta(theta_.begin(), theta_.end());
  std::size_t k = 0;
  for (std::size_t r = 0; r < moved_.records.size(); ++r) {
    const std::vector<double>& measured = problem_.data->records[r].displacement;
    if (problem_.states[r] == models::InitialState::kVirgin) {
      double& unloaded = theta[problem_.parameters.PositionOfOrigin(r)];
      Place first = places_[k];
      if (measured[0] != unloaded) first.direction = std::copysign(1.0, measured[0] - unloaded);
      motion[k] = column(first);
      unloaded += step * column({.displacement = unloaded, .direction = first.direction});
    }
    std::ranges::transform(measured, moved_.records[r].displacement.begin(),
                           [&](double displacement) { return displacement + step * motion[k++]; });
  }
  Problem problem = problem_;
  problem.data = &moved_;
  Response response;
  response.Bind(problem);
  response.Evaluate(theta, motion);
  for (std::size_t i = 0; i < motion.size(); ++i) motion[i] = (motion[i] - places_[i].force) / step;
}

}  // namespace

std::span<const Departure> Departures() { return kDepartures; }

DepartureColumns ColumnsOfDepartures(const Problem& problem, std::span<const double> theta,
                                     const Thresholds& thresholds, Response& response,
                                     std::size_t most) {
  ColumnMaker maker(problem, theta, thresholds, response);
  const bool is_forced = problem.data->is_forced();
  std::size_t room = 0;
  for (const Departure& departure : kDepartures) room += departure.columns.size();
  DepartureColumns result;
  result.columns.resize(static_cast<Eigen::Index>(problem.size()), static_cast<Eigen::Index>(room));
  Eigen::Index count = 0;
  for (const Departure& departure : kDepartures) {
    if (HasTermOf(problem, departure)) continue;
    OmittedTerm term{{.code = departure.code, .term = departure.group}};
    const std::span<const DepartureColumn> columns =
        is_forced ? std::span<const DepartureColumn>(departure.of_displacement) : departure.columns;
    for (const DepartureColumn column : columns) {
      if (column == nullptr) continue;
      const Eigen::Index place = count + std::ssize(term.places);
      auto values = result.columns.col(place);
      maker.Fill(column, departure.moves && !is_forced, {values.data(), problem.size()});
      if (!values.isZero(0.0)) term.places.push_back(place);
    }
    if (static_cast<std::size_t>(count + std::ssize(term.places)) > most) break;
    count += std::ssize(term.places);
    if (!term.places.empty()) result.terms.push_back(std::move(term));
  }
  result.columns.conservativeResize(Eigen::NoChange, count);
  return result;
}

}  // namespace mindahl::identification
