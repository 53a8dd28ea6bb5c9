#include "identification/inference/departures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <ranges>

namespace mindahl::identification {
namespace {

/// A sample as the departures see it, in units of the data.
struct Place {
  double displacement = 0.0;
  double time = 0.0;          // −1 … 1
  double velocity = 0.0;      // by sample, or by time
  double acceleration = 0.0;  // likewise
  double force = 0.0;         // of the contact, over the slip force
  double force_rate = 0.0;    // its derivative by time
  double slope = 0.0;         // its derivative by displacement
  double peak = 0.0;          // largest |force|
  double direction = 1.0;     // of the branch
  double span = 1.0;          // 1 on the virgin curve, 2 on others
  // Where the branch starts:
  double origin = 0.0;
  double origin_force = 0.0;
};

/// How a column follows from its values.
enum class Along {
  kForce,   // the value is a force
  kBranch,  // the value is what changes since the branch started, where the force was the parent's
};

using Value = double (*)(const Place&);

struct Column {
  std::size_t departure;
  Along along;
  Value value;
};

enum Row : std::size_t {
  kLag,
  kViscous,
  kPlateauSlope,
  kDrift,
  kShapeOfLaw,
  kGuide,
  kRig,
  kBacklash,
  kSensor,
  kInertia,
  kUnequal,
  kRunningIn,
  kSaturation,
  kLoad,
  kPosition,
};

constexpr std::array<Departure, 15> kDepartures = {{
    {"channel_lag", "s", ""},
    {"viscous_force", "N s/m", "--viscous fit", "viscous"},
    {"plateau_slope", "N/m", "--plateau-slope", "plateau_slope"},
    {"force_drift", "N/s", "--drift", "force_drift"},
    {"shape_of_law", "", ""},
    {"guide_friction", "N", ""},
    {"rig_in_series", "m/N", "--rig-stiffness fit", "rig_stiffness"},
    {"backlash", "m", ""},
    {"displacement_sensor", "", ""},
    {"inertia", "kg", ""},
    {"unequal_directions", "-", ""},
    {"running_in", "-", ""},
    {"force_saturates", "-", ""},
    {"load_varies", "-", ""},
    {"force_of_position", "", ""},
}};

/// How far the branch has come, of the way to slip.
double Mobilised(const Place& at) {
  return std::clamp(std::abs(at.force - at.origin_force) / at.span, 0.0, 1.0);
}

template <int kHalfWaves>
double Bulge(const Place& at) {
  return at.direction * at.span * std::sin(kHalfWaves * std::numbers::pi * Mobilised(at));
}

constexpr std::array<Column, 22> kColumns = {{
    {kLag, Along::kForce, [](const Place& at) { return -at.force_rate; }},
    {kViscous, Along::kForce, [](const Place& at) { return at.velocity; }},
    {kPlateauSlope, Along::kForce, [](const Place& at) { return at.displacement; }},
    {kDrift, Along::kForce, [](const Place& at) { return at.time; }},
    {kShapeOfLaw, Along::kBranch, Bulge<1>},
    {kShapeOfLaw, Along::kBranch, Bulge<2>},
    {kShapeOfLaw, Along::kBranch, Bulge<3>},
    {kGuide, Along::kForce, [](const Place& at) { return at.direction; }},
    {kRig, Along::kBranch,
     [](const Place& at) { return -at.slope * (at.force - at.origin_force); }},
    {kBacklash, Along::kBranch,
     [](const Place& at) { return at.span > 1 ? -at.slope * at.direction : 0.0; }},
    {kSensor, Along::kBranch,
     [](const Place& at) {
       return at.slope * (at.displacement * at.displacement - at.origin * at.origin);
     }},
    {kSensor, Along::kBranch,
     [](const Place& at) {
       return at.slope * (std::pow(at.displacement, 3) - std::pow(at.origin, 3));
     }},
    {kInertia, Along::kForce, [](const Place& at) { return at.acceleration; }},
    {kUnequal, Along::kForce, [](const Place& at) { return std::abs(at.force); }},
    {kRunningIn, Along::kForce, [](const Place& at) { return at.force * at.time; }},
    {kSaturation, Along::kForce,
     [](const Place& at) {
       constexpr double kFrom = 0.9;  // of the largest force
       return -std::copysign(std::max(0.0, std::abs(at.force) - kFrom * at.peak), at.force);
     }},
    {kSaturation, Along::kForce, [](const Place& at) { return std::pow(at.force, 3); }},
    {kLoad, Along::kForce, [](const Place& at) { return at.force * at.displacement; }},
    {kLoad, Along::kForce,
     [](const Place& at) { return at.force * at.displacement * at.displacement; }},
    {kLoad, Along::kForce, [](const Place& at) { return std::abs(at.force) * at.displacement; }},
    {kPosition, Along::kForce, [](const Place& at) { return at.displacement * at.displacement; }},
    {kPosition, Along::kForce, [](const Place& at) { return std::pow(at.displacement, 3); }},
}};

/// Derivative by `time` of values at it, by differences to both sides within a stroke.
void Derive(std::span<const double> values, std::span<const double> time,
            std::span<const unsigned char> turns, std::span<double> rate) {
  const std::size_t count = values.size();
  for (std::size_t i = 0; i < count; ++i) {
    // At a turn the motion's derivative is that of the stroke that ends there.
    const std::size_t before = i > 0 ? i - 1 : 0;
    const std::size_t after = i + 1 < count && (turns[i] == 0 || i == 0) ? i + 1 : i;
    const double step = time[after] - time[before];
    rate[i] = step > 0 ? (values[after] - values[before]) / step : 0.0;
  }
}

/// Time that grows from sample to sample: by sample where the record's does not.
std::vector<double> GrowingTime(const ScaledRecord& record) {
  std::vector<double> time(record.time.begin(), record.time.end());
  if (std::ranges::adjacent_find(time, std::ranges::greater_equal()) != time.end()) {
    const double step = 2 / std::max(1.0, static_cast<double>(time.size()) - 1);
    for (std::size_t i = 0; i < time.size(); ++i) time[i] = -1 + step * static_cast<double>(i);
  }
  return time;
}

std::vector<Place> PlacesOf(const ScaledRecord& record, std::span<const double> force,
                            std::span<const double> slope) {
  const std::size_t count = record.size();
  const std::vector<double> time = GrowingTime(record);
  std::vector<unsigned char> turns(count, 0);
  for (const std::size_t reversal : record.reversals) turns[reversal] = 1;
  std::vector<double> velocity(count);
  std::vector<double> rate(count);
  std::vector<double> acceleration(count);
  const std::vector<unsigned char> none(count, 0);
  Derive(record.displacement, time, none, velocity);
  Derive(velocity, time, none, acceleration);
  Derive(force, time, turns, rate);
  double peak = 0.0;
  for (const double value : force) peak = std::max(peak, std::abs(value));
  std::vector<Place> places(count);
  for (std::size_t i = 0; i < count; ++i) {
    places[i] = {.displacement = record.displacement[i],
                 .time = time[i],
                 .velocity = velocity[i],
                 .acceleration = acceleration[i],
                 .force = force[i],
                 .force_rate = rate[i],
                 .slope = slope[i],
                 .peak = peak};
  }
  return places;
}

/// Gives each sample its branch, and returns the place of each branch's origin on its parent.
std::vector<Place> FollowBranches(const ScaledRecord& record, const models::LoadingPath& path,
                                  std::span<const double> origin_slope,
                                  std::vector<Place>& places) {
  const std::size_t count = path.branches.size();
  std::vector<Place> origins(count);
  // Branches beyond those that are open at the start follow the reversals.
  const std::size_t initial = count - std::min(count, record.reversals.size());
  const double peak = places.empty() ? 0.0 : places.front().peak;
  for (std::size_t b = 0; b < count; ++b) {
    const models::Branch& branch = path.branches[b];
    Place& origin = origins[b];
    if (b >= initial) {
      origin = places[record.reversals[b - initial]];
    } else if (branch.start != models::BranchStart::kUnloaded &&
               branch.start != models::BranchStart::kSteadyCentre) {
      origin.force = -branch.direction * peak;
      origin.peak = peak;
    }
    origin.displacement = branch.origin;
    origin.slope = origin_slope[b];
    if (branch.parent >= 0) {
      const auto parent = static_cast<std::size_t>(branch.parent);
      origin.direction = path.branches[parent].direction;
      origin.span = models::IsVirgin(path.branches[parent].start) ? 1.0 : 2.0;
      origin.origin = origins[parent].displacement;
      origin.origin_force = origins[parent].force;
    }
  }
  for (const models::BranchRun& run : path.runs) {
    const auto b = static_cast<std::size_t>(run.branch);
    const models::Branch& branch = path.branches[b];
    const bool virgin = models::IsVirgin(branch.start);
    for (std::size_t i = run.begin; i < run.end; ++i) {
      Place& at = places[i];
      at.span = virgin ? 1.0 : 2.0;
      at.origin = branch.origin;
      at.origin_force = origins[b].force;
      at.direction = virgin ? std::copysign(1.0, at.displacement - branch.origin)
                            : static_cast<double>(branch.direction);
    }
  }
  return origins;
}

void FillColumn(const Column& column, const models::LoadingPath& path,
                std::span<const Place> places, std::span<const Place> origins,
                std::span<double> values) {
  if (column.along == Along::kForce) {
    for (std::size_t i = 0; i < places.size(); ++i) values[i] = column.value(places[i]);
    return;
  }
  std::vector<double> start(origins.size(), 0.0);
  for (std::size_t b = 0; b < origins.size(); ++b) {
    const std::int32_t parent = path.branches[b].parent;
    if (parent < 0) continue;
    start[b] = start[static_cast<std::size_t>(parent)] + column.value(origins[b]);
  }
  for (const models::BranchRun& run : path.runs) {
    for (std::size_t i = run.begin; i < run.end; ++i) {
      values[i] = start[static_cast<std::size_t>(run.branch)] + column.value(places[i]);
    }
  }
}

/// What a factor of one is, forces being in units of the data and the contact's over Tc.
double UnitOfSize(std::size_t departure, const ScaledRecords& data, double slip_force) {
  const TermUnits& units = data.records.front().units;
  const double newton = data.force;
  switch (departure) {
    case kLag:
      return units.half_duration / slip_force;
    case kViscous:
      return newton / data.length * units.half_duration;
    case kPlateauSlope:
      return newton / data.length;
    case kDrift:
      return newton / units.half_duration;
    case kGuide:
      return newton;
    case kRig:
      return data.length / (newton * slip_force * slip_force);
    case kBacklash:
      return data.length / slip_force;
    case kInertia:
      return newton / data.length * units.half_duration * units.half_duration;
    default:
      return 1 / slip_force;
  }
}

}  // namespace

std::span<const Departure> Departures() { return kDepartures; }

DepartureColumns ColumnsOfDepartures(const Problem& problem, std::span<const double> theta,
                                     Response& response, std::size_t most) {
  const double slip_force = std::exp(theta[kSlipForce]);
  DepartureColumns result;
  std::vector<const Column*> wanted;
  for (std::size_t d = 0; d < kDepartures.size(); ++d) {
    const bool is_fitted = std::ranges::any_of(problem.parameters.free(), [&](std::size_t p) {
      return problem.parameters[p].term->name == kDepartures[d].term;
    });
    if (is_fitted) continue;
    const auto is_of = [&](const Column& column) { return column.departure == d; };
    const auto count = static_cast<std::size_t>(std::ranges::count_if(kColumns, is_of));
    if (wanted.size() + count > most) break;
    for (const Column& column : kColumns | std::views::filter(is_of)) {
      wanted.push_back(&column);
      result.of.push_back(d);
      result.unit_of_size.push_back(UnitOfSize(d, *problem.data, slip_force));
    }
  }
  const LawPoint point = PointAt(problem, theta);
  std::vector<double> force(problem.size());
  response.Bind(problem);
  response.Evaluate(point, force);
  result.columns.resize(static_cast<Eigen::Index>(problem.size()),
                        static_cast<Eigen::Index>(wanted.size()));
  std::size_t begin = 0;
  for (std::size_t r = 0; r < problem.data->records.size(); ++r) {
    const ScaledRecord& record = problem.data->records[r];
    models::OriginSensitivity sensitivity;
    response.DifferentiateByOrigins(point, r, sensitivity);
    std::vector<Place> places =
        PlacesOf(record, std::span(force).subspan(begin, record.size()), sensitivity.sample_slope);
    const models::LoadingPath& path = response.PathOf(r, theta);
    const std::vector<Place> origins = FollowBranches(record, path, sensitivity.slope, places);
    for (std::size_t c = 0; c < wanted.size(); ++c) {
      const std::span<double> values(
          result.columns.col(static_cast<Eigen::Index>(c)).data() + begin, record.size());
      FillColumn(*wanted[c], path, places, origins, values);
      for (std::size_t i = 0; i < record.size(); ++i) values[i] *= record.root_weight[i];
    }
    begin += record.size();
  }
  return result;
}

}  // namespace mindahl::identification
