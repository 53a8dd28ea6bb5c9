#include "identification/inference/departures.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "identification/dense.h"
#include "identification/problem/scaled_records.h"

namespace mindahl::identification {
namespace {

double Cube(double x) { return x * x * x; }

double Position(const Place& at) { return at.force * at.displacement; }
double PositionOfSize(const Place& at) { return std::abs(at.force) * at.displacement; }
double Lag(const Place& at) { return -at.rate; }

/// A branch of another shape between the same ends.
template <int kHalfWaves>
double Bulge(const Place& at) {
  return at.change * std::sin(kHalfWaves * std::numbers::pi * at.progress);
}

constexpr auto kDepartures = std::to_array<Departure>({
    {.code = "channel_lag",
     .group = "lag",
     .columns = {{{Lag}}},
     // A force that is read late meets the displacement of later.
     .of_displacement = {{{[](const Place& at) { return at.rate; }}}}},
    {.code = "viscous_force", .group = "viscous", .columns = {{{[](const Place& at) {
                                                    return at.velocity;
                                                  }}}}},
    {.code = "plateau_slope", .group = "plateau_slope", .columns = {{{[](const Place& at) {
                                                          return at.displacement;
                                                        }}}}},
    {.code = "force_drift", .group = "force_drift", .columns = {{{[](const Place& at) {
                                                      return at.time;
                                                    }}}}},
    {.code = "normal_load",
     .columns = {{{[](const Place& at) { return at.force * at.load_change; }}}}},
    {.code = "shape_of_law",
     .columns = {{{Bulge<1>}, {Bulge<2>}, {Bulge<3>}}},
     .of_displacement = {{{Bulge<1>}, {Bulge<2>}, {Bulge<3>}}}},
    {.code = "guide_friction", .columns = {{{[](const Place& at) { return at.direction; }}}}},
    {.code = "rig_in_series",
     .group = "rig_stiffness",
     .columns = {{{[](const Place& at) { return -at.force; }, true}}},
     .of_displacement = {{{[](const Place& at) { return at.force; }}}}},
    {.code = "backlash",
     .group = "backlash",
     .columns = {{{[](const Place& at) { return -at.direction; }, true}}},
     .of_displacement = {{{[](const Place& at) { return at.direction; }}}}},
    {.code = "displacement_sensor",
     .columns = {{{[](const Place& at) { return at.displacement * at.displacement; }, true},
                  {[](const Place& at) { return Cube(at.displacement); }, true}}},
     .of_displacement = {{{[](const Place& at) { return -at.displacement * at.displacement; }},
                          {[](const Place& at) { return -Cube(at.displacement); }}}}},
    {.code = "inertia", .group = "inertia", .columns = {{{[](const Place& at) {
                                              return at.acceleration;
                                            }}}}},
    {.code = "unequal_directions",
     .group = "asymmetry",
     .columns = {{{[](const Place& at) { return std::abs(at.force); }},
                  {[](const Place& at) { return at.asymmetry; }}}}},
    {.code = "running_in", .group = "slip_trend", .columns = {{{[](const Place& at) {
                                                    return at.force * at.time;
                                                  }}}}},
    {.code = "force_saturates",
     .columns = {{{[](const Place& at) {
                    constexpr double kFrom = 0.9;  // of the largest force
                    return -std::copysign(std::max(0.0, std::abs(at.force) - kFrom * at.peak),
                                          at.force);
                  }},
                  {[](const Place& at) { return Cube(at.force); }}}}},
    {.code = "slip_position",
     .group = "slip_position",
     .term = "slip_slope",
     .columns = {{{Position}, {PositionOfSize}}}},
    {.code = "force_of_position",
     .columns = {{{[](const Place& at) { return at.displacement * at.displacement; }},
                  {[](const Place& at) { return Cube(at.displacement); }}}}},
    // Its columns are those of the file.
    {.code = "covariate", .group = "covariate"},
    {.code = "smoothing", .columns = {{{[](const Place& at) { return at.curvature / 2; }}}}},
    // A turn is the first of its repeats, where nothing is missed.
    {.code = "held_displacement", .columns = {{{[](const Place& at) { return at.missed; }, true}}}},
    {.code = "displacement_drift",
     .group = "displacement_drift",
     .of_displacement = {{{[](const Place& at) { return at.time; }}}}},
    {.code = "speed_power",
     .group = "slip_speed",
     .term = "speed_exponent",
     .columns = {{{[](const Place& at) {
                    return std::copysign(std::sqrt(std::abs(at.velocity)), at.velocity);
                  }},
                  {[](const Place& at) { return at.velocity; }}}}},
    {.code = "slip_position_quadratic",
     .group = "slip_position_quadratic",
     .term = "slip_slope",
     .columns = {{{Position},
                  {[](const Place& at) { return Position(at) * at.displacement; }},
                  {PositionOfSize},
                  {[](const Place& at) { return PositionOfSize(at) * at.displacement; }}}}},
    {.code = "clock_drift",
     .columns = {{{[](const Place& at) { return Lag(at) * at.time; }}, {Lag}}}},
});

/// True if a column is, but for its own part, a linear function of time, displacement, force and
/// load: it adds nothing, or is the force in another unit or as it was commanded.
bool RepeatsTheOthers(const ScaledRecords& data, std::size_t covariate, double own_part) {
  return std::ranges::all_of(data.records, [&](const ScaledRecord& record) {
    const auto rows = static_cast<Eigen::Index>(record.size());
    Eigen::MatrixXd others = Eigen::MatrixXd::Zero(rows, 5);
    Eigen::VectorXd own = Eigen::VectorXd::Zero(rows);
    for (std::size_t i = 0; i < record.size(); ++i) {
      if (record.counts[i] == 0) continue;
      const auto row = static_cast<Eigen::Index>(i);
      const double load = record.load_change.empty() ? 0.0 : record.load_change[i];
      others.row(row) << 1.0, record.time[i], record.displacement[i], record.force[i], load;
      own[row] = record.covariates[covariate][i];
    }
    const double deviation = LeftOver(others.leftCols(1), own).squaredNorm();
    return LeftOver(others, own).squaredNorm() <= own_part * own_part * deviation;
  });
}

/// Returns the covariates that are not fitted and repeat no other channel: neither one that is
/// fitted nor a later one, as an acquisition's readings come before the columns that are computed
/// from them.
std::vector<std::size_t> NewCovariates(const Problem& problem, double own_part) {
  const ScaledRecords& data = *problem.data;
  std::vector<std::size_t> covariates;
  if (data.is_forced()) return covariates;
  const auto fitted = static_cast<std::size_t>(std::ranges::count_if(
      problem.parameters, [](const Parameter& parameter) { return parameter.term->of_column; }));
  for (std::size_t c = fitted; c < data.covariates.size(); ++c) {
    bool is_new = !RepeatsTheOthers(data, c, own_part);
    for (std::size_t other = 0; is_new && other < data.covariates.size(); ++other) {
      if (other < fitted || other > c) is_new = !AreOneChannel(data, c, other);
    }
    if (is_new) covariates.push_back(c);
  }
  return covariates;
}

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
        places_(PlacesOf(problem, theta, thresholds.held_readings, response)) {}

  void Fill(const DepartureColumn& column, std::span<double> values) {
    std::ranges::transform(places_, values.begin(), column.value);
    if (column.is_motion) FollowMotion(column, values);
    Weigh(values);
  }

  void FillWithCovariate(std::size_t covariate, std::span<double> values) const {
    auto to = values.begin();
    for (const ScaledRecord& record : problem_.data->records) {
      to = std::ranges::copy(record.covariates[covariate], to).out;
    }
    Weigh(values);
  }

 private:
  void FollowMotion(const DepartureColumn& column, std::span<double> motion);
  void Weigh(std::span<double> values) const {
    auto value = values.begin();
    for (const ScaledRecord& record : problem_.data->records) {
      for (const double root_weight : record.root_weight) *value++ *= root_weight;
    }
  }

  const Problem& problem_;
  std::span<const double> theta_;
  std::vector<Place> places_;
  std::vector<double> unmoved_;  // response of the contact
  std::optional<ScaledRecords> moved_;
};

/// Replaces a motion of the contact beside its displacement by what it changes in the response.
void ColumnMaker::FollowMotion(const DepartureColumn& column, std::span<double> motion) {
  constexpr double kSmall = 1e-6;  // of the half range of the displacement
  Response response;
  const auto evaluate = [&](const Problem& problem, std::span<const double> theta,
                            std::span<double> to) {
    response.Bind(problem);
    response.Evaluate(theta, to);
  };
  if (!moved_) {
    moved_ = *problem_.data;
    unmoved_.resize(problem_.size());
    evaluate(problem_, theta_, unmoved_);
  }
  double largest = 0.0;
  for (const double way : motion) largest = std::max(largest, std::abs(way));
  if (largest == 0) return;
  const double step = kSmall / largest;
  std::vector<double> theta(theta_.begin(), theta_.end());
  std::size_t k = 0;
  for (std::size_t r = 0; r < moved_->records.size(); ++r) {
    const std::vector<double>& measured = problem_.data->records[r].displacement;
    if (problem_.states[r] == models::InitialState::kVirgin) {
      double& unloaded = theta[problem_.parameters.PositionOfOrigin(r)];
      Place first = places_[k];
      if (measured[0] != unloaded) first.direction = std::copysign(1.0, measured[0] - unloaded);
      motion[k] = column.value(first);
      unloaded += step * column.value({.displacement = unloaded, .direction = first.direction});
    }
    std::ranges::transform(measured, moved_->records[r].displacement.begin(),
                           [&](double displacement) { return displacement + step * motion[k++]; });
  }
  Problem problem = problem_;
  problem.data = &*moved_;
  evaluate(problem, theta, motion);
  for (std::size_t i = 0; i < motion.size(); ++i) motion[i] = (motion[i] - unmoved_[i]) / step;
}

}  // namespace

std::span<const Departure> Departures() { return kDepartures; }

DepartureColumns ColumnsOfDepartures(const Problem& problem, std::span<const double> theta,
                                     const Thresholds& thresholds, Response& response,
                                     std::size_t most) {
  const ScaledRecords& data = *problem.data;
  ColumnMaker maker(problem, theta, thresholds, response);
  std::vector<std::size_t> covariates = NewCovariates(problem, thresholds.own_covariate);
  std::size_t room = 0;
  for (const Departure& departure : kDepartures) room += departure.columns.size();
  DepartureColumns result;
  result.columns.resize(static_cast<Eigen::Index>(problem.size()),
                        static_cast<Eigen::Index>(room + covariates.size()));
  Eigen::Index count = 0;
  const auto column_at = [&](Eigen::Index place) {
    return std::span(result.columns.col(place).data(), problem.size());
  };
  std::size_t taken = 0;  // of the covariates
  for (const Departure& departure : kDepartures) {
    if (departure.group == "covariate") {
      taken = std::min(covariates.size(), most - static_cast<std::size_t>(count));
      continue;
    }
    if (HasTermOf(problem, departure)) continue;
    OmittedTerm term{.departure = &departure};
    for (const DepartureColumn& column : departure.ColumnsOf(data.excitation)) {
      if (column.value == nullptr) continue;
      const Eigen::Index place = count + std::ssize(term.places);
      maker.Fill(column, column_at(place));
      if (!result.columns.col(place).isZero(0.0)) term.places.push_back(place);
    }
    count += std::ssize(term.places);
    if (static_cast<std::size_t>(count) + taken > most) {
      count -= std::ssize(term.places);
      break;
    }
    if (!term.places.empty()) result.terms.push_back(std::move(term));
  }
  const auto& covariate = *std::ranges::find(kDepartures, "covariate", &Departure::group);
  covariates.resize(taken);
  for (const std::size_t c : covariates) {
    maker.FillWithCovariate(c, column_at(count));
    result.terms.push_back({.departure = &covariate, .covariate = c, .places = {count++}});
  }
  result.columns.conservativeResize(Eigen::NoChange, count);
  return result;
}

}  // namespace mindahl::identification
