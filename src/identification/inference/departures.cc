#include "identification/inference/departures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <ranges>

#include "identification/dense.h"
#include "identification/inference/branch_places.h"
#include "identification/inference/sampled_time.h"
#include "identification/problem/scaled_records.h"

namespace mindahl::identification {
namespace {

/// Describes a sample for the omitted terms, in units of the data; time in that of the clock.
struct ForcePlace {
  double displacement = 0.0;
  double time = 0.0;  // from the record's middle
  double velocity = 0.0;
  double speed = 0.0;  // velocity over a fiftieth of a stroke to either side, with its sign
  double acceleration = 0.0;
  double force_rate = 0.0;  // of the whole force
  double force = 0.0;       // of the contact, over the slip force
  double peak = 0.0;        // largest |force| of all records
  double direction = 1.0;   // of the branch
  // Without the load that a force may follow:
  double response = 0.0;     // the contact's force over the slip force
  double slope = 0.0;        // its derivative by displacement
  double load_change = 0.0;  // of the measured load, over its mean
  double curvature = 0.0;    // of the whole force, its second derivative by time
  double missed = 0.0;       // way since the displacement was last read anew, where it is repeated
  double amplitude = 0.0;    // of the stroke, −½ of the narrowest to ½ of the widest
  double asymmetry = 0.0;    // of the force over the slip force, its derivative by an asymmetry
  double gain = 1.0;         // and by that at the origin of the branch
  // The branch:
  bool sets_out = false;  // on the virgin curve, in its first direction
  bool virgin = false;    // on the virgin curve
  double reach = 1.0;     // what it has to go from its origin to slip
  double origin = 0.0;
  double origin_response = 0.0;
};

/// How a column follows from its values.
enum class Along {
  kForce,   // the value is a force
  kBranch,  // the value is what changes since the branch started, where the force was the parent's
};

using ForceDeparture = double (*)(const ForcePlace&);

struct ForceColumn {
  std::size_t departure;
  Along along;
  ForceDeparture value;
};

enum DepartureRow : std::size_t {
  kLag,
  kViscous,
  kPlateauSlope,
  kDrift,
  kMeasuredLoad,
  kShapeOfLaw,
  kGuide,
  kCompliantRig,
  kBacklash,
  kSensor,
  kInertia,
  kUnequal,
  kRunningIn,
  kSaturation,
  kSlipPosition,
  kPosition,
  kCovariate,
  kSmoothing,
  kHeld,
  kAmplitude,
  kDisplacementDrift,
  kSpeedPower,
  kSlipPositionQuadratic,
  kClockDrift,
};

constexpr std::array<Departure, 24> kDepartures = {{
    {.code = "channel_lag",
     .meaning = "delay of the force's channel",
     .group = "lag",
     .term = "lag"},
    {.code = "viscous_force",
     .meaning = "C of a force C·dδ/dt; it dissipates where positive",
     .group = "viscous",
     .term = "viscous"},
    {.code = "plateau_slope",
     .meaning = "stiffness of a spring parallel to the contact",
     .group = "plateau_slope",
     .term = "plateau_slope"},
    {.code = "force_drift",
     .meaning = "rate of drift of the force, with the sign that it has in the file",
     .group = "force_drift",
     .term = "force_drift"},
    {.code = "normal_load",
     .meaning = "relative change of the contact's force over that of the measured load: 1 in "
                "proportion"},
    {.code = "shape_of_law", .meaning = "bulge of each branch, halfway to slip"},
    {.code = "guide_friction",
     .meaning = "Coulomb friction parallel to the contact; it dissipates where positive"},
    {.code = "rig_in_series",
     .meaning = "compliance of a spring in series",
     .group = "rig_stiffness",
     .term = "rig_stiffness"},
    {.code = "backlash",
     .meaning = "the whole travel that is lost at a reversal",
     .group = "backlash",
     .term = "backlash"},
    {.code = "displacement_sensor",
     .meaning = "the contact sees x + size·x²/L, x from the record's middle; and x³"},
    {.code = "inertia",
     .meaning = "mass in front of the sensor of the force, m·d²δ/dt²",
     .group = "inertia",
     .term = "inertia"},
    {.code = "unequal_directions",
     .meaning = "force (1 ± size)·T, + where it acts along positive displacement; for a virgin "
                "contact also slip forces Tc(1 ± A)",
     .group = "asymmetry",
     .term = "asymmetry"},
    {.code = "running_in",
     .meaning = "growth of the contact's force from the first record's beginning to its end",
     .group = "slip_trend",
     .term = "slip_trend"},
    {.code = "force_saturates",
     .meaning = "fraction lost of the excess over nine tenths of the largest force; and T³"},
    {.code = "slip_position",
     .meaning = "growth of the contact's force over L from the record's middle; and of |T|, which "
                "differs by direction",
     .group = "slip_position",
     .term = "slip_slope"},
    {.code = "force_of_position", .meaning = "force size·Tc·(x/L)²; and x³"},
    {.code = "covariate",
     .meaning = "C of a force C·column; each of up to 8 columns that no option names",
     .group = "covariate",
     .term = "covariate"},
    {.code = "smoothing",
     .meaning =
         "standard deviation of the time window over which the force is averaged; of that of "
         "the displacement where negative"},
    {.code = "held_displacement",
     .meaning = "fraction of the motion between two readings of the displacement that is not read"},
    {.code = "amplitude_dependence",
     .meaning = "growth of the contact's force from the narrowest stroke to the widest"},
    {.code = "displacement_drift",
     .meaning = "rate of drift of a fitted displacement, with the sign that it has in the file",
     .group = "displacement_drift",
     .term = "displacement_drift"},
    {.code = "speed_power",
     .meaning = "forces in proportion to the square root of the speed, along the motion, and to "
                "the velocity",
     .group = "slip_speed",
     .term = "speed_exponent"},
    {.code = "slip_position_quadratic",
     .meaning = "growth of the contact's force over L from the record's middle; and over x², each "
                "also of |T|, which differs by direction",
     .group = "slip_position_quadratic",
     .term = "slip_slope"},
    {.code = "clock_drift",
     .meaning = "delay of the force that builds up from the first record's beginning to its end; "
                "and a lag from there on"},
}};

/// Fraction of the travel to slip that the branch has covered.
double Mobilised(const ForcePlace& at) {
  if (!(at.reach > 0)) return 1.0;
  return std::clamp(std::abs(at.response - at.origin_response) / at.reach, 0.0, 1.0);
}

double Cube(double x) { return x * x * x; }

template <int kHalfWaves>
double Bulge(const ForcePlace& at) {
  return at.direction * at.reach * std::sin(kHalfWaves * std::numbers::pi * Mobilised(at));
}

/// Column of unequal slip forces; of a contact that had slipped only an offset of the force.
double ByAsymmetry(const ForcePlace& at) { return at.asymmetry; }

constexpr std::array<ForceColumn, 34> kForceColumns = {{
    {kLag, Along::kForce, [](const ForcePlace& at) { return -at.force_rate; }},
    {kViscous, Along::kForce, [](const ForcePlace& at) { return at.velocity; }},
    {kPlateauSlope, Along::kForce, [](const ForcePlace& at) { return at.displacement; }},
    {kDrift, Along::kForce, [](const ForcePlace& at) { return at.time; }},
    {kMeasuredLoad, Along::kForce, [](const ForcePlace& at) { return at.force * at.load_change; }},
    {kShapeOfLaw, Along::kBranch, Bulge<1>},
    {kShapeOfLaw, Along::kBranch, Bulge<2>},
    {kShapeOfLaw, Along::kBranch, Bulge<3>},
    {kGuide, Along::kForce, [](const ForcePlace& at) { return at.direction; }},
    {kCompliantRig, Along::kBranch,
     [](const ForcePlace& at) { return -at.slope * (at.response - at.origin_response); }},
    {kBacklash, Along::kBranch,
     [](const ForcePlace& at) { return at.sets_out ? 0.0 : -at.slope * at.direction; }},
    {kSensor, Along::kBranch,
     [](const ForcePlace& at) {
       return at.slope * (at.displacement * at.displacement - at.origin * at.origin);
     }},
    {kSensor, Along::kBranch,
     [](const ForcePlace& at) { return at.slope * (Cube(at.displacement) - Cube(at.origin)); }},
    {kInertia, Along::kForce, [](const ForcePlace& at) { return at.acceleration; }},
    {kUnequal, Along::kForce, [](const ForcePlace& at) { return std::abs(at.force); }},
    {kUnequal, Along::kForce, ByAsymmetry},
    {kRunningIn, Along::kForce, [](const ForcePlace& at) { return at.force * at.time; }},
    {kSaturation, Along::kForce,
     [](const ForcePlace& at) {
       constexpr double kFrom = 0.9;  // of the largest force
       return -std::copysign(std::max(0.0, std::abs(at.force) - kFrom * at.peak), at.force);
     }},
    {kSaturation, Along::kForce, [](const ForcePlace& at) { return Cube(at.force); }},
    {kSlipPosition, Along::kForce, [](const ForcePlace& at) { return at.force * at.displacement; }},
    {kSlipPosition, Along::kForce,
     [](const ForcePlace& at) { return std::abs(at.force) * at.displacement; }},
    {kPosition, Along::kForce,
     [](const ForcePlace& at) { return at.displacement * at.displacement; }},
    {kPosition, Along::kForce, [](const ForcePlace& at) { return Cube(at.displacement); }},
    {kSmoothing, Along::kForce, [](const ForcePlace& at) { return at.curvature / 2; }},
    // A turn is the first of its repeats, where nothing is missed.
    {kHeld, Along::kBranch, [](const ForcePlace& at) { return at.slope * at.missed; }},
    {kAmplitude, Along::kForce, [](const ForcePlace& at) { return at.force * at.amplitude; }},
    {kSpeedPower, Along::kForce,
     [](const ForcePlace& at) { return std::copysign(std::sqrt(std::abs(at.speed)), at.speed); }},
    {kSpeedPower, Along::kForce, [](const ForcePlace& at) { return at.speed; }},
    {kSlipPositionQuadratic, Along::kForce,
     [](const ForcePlace& at) { return at.force * at.displacement; }},
    {kSlipPositionQuadratic, Along::kForce,
     [](const ForcePlace& at) { return at.force * at.displacement * at.displacement; }},
    {kSlipPositionQuadratic, Along::kForce,
     [](const ForcePlace& at) { return std::abs(at.force) * at.displacement; }},
    {kSlipPositionQuadratic, Along::kForce,
     [](const ForcePlace& at) { return std::abs(at.force) * at.displacement * at.displacement; }},
    {kClockDrift, Along::kForce, [](const ForcePlace& at) { return -at.force_rate * at.time; }},
    {kClockDrift, Along::kForce, [](const ForcePlace& at) { return -at.force_rate; }},
}};

/// Second derivative by time, of the parabola through every other sample: one between neighbours
/// would see four times as much of the displacement's noise.
void DeriveTwice(std::span<const double> values, std::span<const double> time,
                 std::span<const std::size_t> samples, std::span<double> second) {
  constexpr std::size_t kStep = 2;
  if (samples.size() < 2 * kStep + 1) return;
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
}

/// Velocity by the chord from a fiftieth of a stroke before a sample to as much after it. The root
/// of a speed is largest where it changes its sign: of that between neighbours it would be one of
/// the displacement's noise.
void DeriveSmoothly(const ScaledRecord& record, std::span<const double> time,
                    std::span<const std::size_t> samples, std::span<double> speed) {
  constexpr std::size_t kPartOfStroke = 50;
  if (samples.size() < 2) return;
  const std::size_t reach =
      std::max<std::size_t>(samples.size() / (record.reversals.size() + 1) / kPartOfStroke, 1);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const std::size_t before = samples[k > reach ? k - reach : 0];
    const std::size_t after = samples[std::min(k + reach, samples.size() - 1)];
    speed[samples[k]] =
        (record.displacement[after] - record.displacement[before]) / (time[after] - time[before]);
  }
}

/// Returns the travel since the displacement was last read anew: what is repeated was read at the
/// first of the repeats, and went straight on to the next reading.
std::vector<double> MissedWay(const ScaledRecord& record, std::span<const double> time,
                              std::span<const std::size_t> samples) {
  std::vector<double> missed(record.size());
  for (std::size_t k = 0; k < samples.size();) {
    const double reading = record.displacement[samples[k]];
    std::size_t next = k + 1;
    while (next < samples.size() && record.displacement[samples[next]] == reading) ++next;
    if (next == samples.size()) break;
    const double step = record.displacement[samples[next]] - reading;
    const double duration = time[samples[next]] - time[samples[k]];
    for (std::size_t j = k + 1; j < next; ++j) {
      missed[samples[j]] = step * (time[samples[j]] - time[samples[k]]) / duration;
    }
    k = next;
  }
  return missed;
}

/// Half the way [units of the data] of each sample's stroke; those that the record begins and ends
/// on count as wide as their neighbours, since they may be cut.
std::vector<double> StrokeAmplitudes(const ScaledRecord& record) {
  const auto& reversals = record.reversals;
  const auto [lowest, highest] = std::ranges::minmax(record.displacement);
  std::vector<double> amplitudes(record.size(), (highest - lowest) / 2);
  if (reversals.size() < 2) return amplitudes;
  for (std::size_t k = 0; k + 1 < reversals.size(); ++k) {
    const double way =
        std::abs(record.displacement[reversals[k + 1]] - record.displacement[reversals[k]]);
    const std::size_t begin = k == 0 ? 0 : reversals[k] + 1;
    const std::size_t end = k + 2 < reversals.size() ? reversals[k + 1] + 1 : record.size();
    std::fill(amplitudes.begin() + static_cast<std::ptrdiff_t>(begin),
              amplitudes.begin() + static_cast<std::ptrdiff_t>(end), way / 2);
  }
  return amplitudes;
}

/// Returns the amplitude of every sample's stroke, from −½, the narrowest, to ½, the widest; empty
/// where strokes are nearly equal.
std::vector<std::vector<double>> AmplitudeScale(const ScaledRecords& data) {
  constexpr double kEqual = 0.95;  // of the widest: the same as of steady cycles
  std::vector<std::vector<double>> scale;
  double narrowest = std::numeric_limits<double>::infinity();
  double widest = 0.0;
  for (const ScaledRecord& record : data.records) {
    const std::vector<double>& amplitudes = scale.emplace_back(StrokeAmplitudes(record));
    const auto [least, most] = std::ranges::minmax(amplitudes);
    narrowest = std::min(narrowest, least);
    widest = std::max(widest, most);
  }
  if (narrowest >= kEqual * widest) return {};
  for (std::vector<double>& amplitudes : scale) {
    for (double& a : amplitudes) a = (a - narrowest) / (widest - narrowest) - 0.5;
  }
  return scale;
}

/// Places of a record's samples, branches yet unknown.
/// @param force     of the contact, over the slip force and at its load
/// @param complete  that of the whole model
std::vector<ForcePlace> ForcePlacesOf(const ScaledRecord& record, std::span<const double> time,
                                      const Neighbours& neighbours, std::span<const double> force,
                                      std::span<const double> complete,
                                      const models::OriginSensitivity& sensitivity, double peak) {
  const std::size_t count = record.size();
  std::vector<double> velocity(count);
  std::vector<double> speed(count);
  std::vector<double> acceleration(count);
  std::vector<double> rate(count);
  std::vector<double> curvature(count);
  Derive(record.displacement, time, neighbours, false, velocity);
  DeriveSmoothly(record, time, neighbours.samples, speed);
  DeriveTwice(record.displacement, time, neighbours.samples, acceleration);
  Derive(complete, time, neighbours, true, rate);
  DeriveTwice(complete, time, neighbours.samples, curvature);
  std::vector<ForcePlace> places(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double load = record.LoadAt(i);
    places[i] = {.displacement = record.displacement[i],
                 .time = time[i],
                 .velocity = velocity[i],
                 .speed = speed[i],
                 .acceleration = acceleration[i],
                 .force_rate = rate[i],
                 .force = force[i],
                 .peak = peak,
                 .response = load != 0 ? force[i] / load : 0.0,
                 .slope = sensitivity.sample_slope[i],
                 .load_change = record.load_change.empty() ? 0.0 : record.load_change[i],
                 .curvature = curvature[i],
                 .gain = sensitivity.sample_gain[i]};
  }
  return places;
}

void FillColumn(const ForceColumn& column, const models::LoadingPath& path,
                const ForcePlace& extreme, std::span<const ForcePlace> places,
                std::span<const ForcePlace> origins, const ScaledRecord& record,
                std::span<double> values) {
  if (column.along == Along::kForce) {
    for (std::size_t i = 0; i < places.size(); ++i) values[i] = column.value(places[i]);
    return;
  }
  FillAlongBranches(column.value, path, extreme, places, origins, values);
  for (std::size_t i = 0; i < places.size(); ++i) values[i] *= record.LoadAt(i);
}

std::size_t FittedCovariates(const Problem& problem) {
  return static_cast<std::size_t>(std::ranges::count_if(
      problem.parameters, [](const Parameter& parameter) { return parameter.term->of_column; }));
}

/// True if a column is, within a fifth of its deviation, a linear function of time, displacement,
/// force and load: it adds nothing, or is the force in another unit or as it was commanded.
bool RepeatsTheOthers(const ScaledRecords& data, std::size_t covariate) {
  constexpr double kOwnPart = 0.2;
  for (const ScaledRecord& record : data.records) {
    const auto rows = static_cast<Eigen::Index>(record.size());
    Eigen::MatrixXd others = Eigen::MatrixXd::Zero(rows, 5);
    Eigen::VectorXd own = Eigen::VectorXd::Zero(rows);
    double deviation = 0.0;
    double mean = 0.0;
    double count = 0.0;
    for (std::size_t i = 0; i < record.size(); ++i) {
      if (record.counts[i] == 0) continue;
      const auto row = static_cast<Eigen::Index>(i);
      const double load = record.load_change.empty() ? 0.0 : record.load_change[i];
      others.row(row) << 1.0, record.time[i], record.displacement[i], record.force[i], load;
      own[row] = record.covariates[covariate][i];
      ++count;
      const double off = own[row] - mean;
      mean += off / count;
      deviation += off * (own[row] - mean);
    }
    const Eigen::VectorXd left = LeftOver(others, own);
    if (left.squaredNorm() > kOwnPart * kOwnPart * deviation) return false;
  }
  return true;
}

/// True if a column that nobody asked for is the same channel as one that is fitted, or as a later
/// one: an acquisition's readings come before the columns that are computed from them.
bool IsReadAgain(const ScaledRecords& data, std::size_t covariate, std::size_t fitted) {
  for (std::size_t other = 0; other < data.covariates.size(); ++other) {
    const bool stays = other < fitted || other > covariate;
    if (stays && other != covariate && AreOneChannel(data, covariate, other)) return true;
  }
  return false;
}

}  // namespace

std::span<const Departure> Departures() { return kDepartures; }

DepartureColumns ColumnsOfDepartures(const Problem& problem, std::span<const double> theta,
                                     Response& response, std::size_t most) {
  if (problem.data->is_forced()) {
    return ColumnsOfDisplacementDepartures(problem, theta, response, most);
  }
  const std::vector<ScaledRecord>& records = problem.data->records;
  std::vector<Neighbours> neighbours;
  for (const ScaledRecord& record : records) neighbours.push_back(NeighboursOf(record));
  const Clock clock = ClockOf(*problem.data, neighbours);
  const bool is_repeated = IsDisplacementHeld(*problem.data, neighbours);
  const std::vector<std::vector<double>> amplitudes = AmplitudeScale(*problem.data);
  const bool tells_asymmetry = problem.state.Any(models::InitialState::kVirgin) &&
                               problem.model->memory == models::Memory::kReturnPoint &&
                               !problem.data->load_varies;
  DepartureColumns result;
  std::vector<std::size_t> covariates;
  const std::size_t fitted = FittedCovariates(problem);
  for (std::size_t c = fitted; c < problem.data->covariates.size(); ++c) {
    const bool is_new =
        !IsReadAgain(*problem.data, c, fitted) && !RepeatsTheOthers(*problem.data, c);
    if (is_new) covariates.push_back(c);
  }
  std::size_t room = most;  // for what is before the covariates, then for what is after them
  std::vector<const ForceColumn*> wanted;
  for (std::size_t d = 0; d < kDepartures.size(); ++d) {
    if (d == kCovariate) {
      covariates.resize(std::min(covariates.size(), room - wanted.size()));
      room -= covariates.size();
    }
    const bool is_fitted = std::ranges::any_of(problem.parameters.free(), [&](std::size_t p) {
      return problem.parameters[p].term->name == kDepartures[d].term;
    });
    const bool is_unknown =
        d == kMeasuredLoad && std::ranges::all_of(records, [](const ScaledRecord& record) {
          return record.load_change.empty();
        });
    const bool is_nothing = (d == kHeld && !is_repeated) || (d == kAmplitude && amplitudes.empty());
    if (is_fitted || is_unknown || is_nothing) continue;
    const auto is_of = [&](const ForceColumn& column) {
      return column.departure == d && (column.value != ByAsymmetry || tells_asymmetry);
    };
    const auto count = static_cast<std::size_t>(std::ranges::count_if(kForceColumns, is_of));
    if (wanted.size() + count > room) {
      if (d < kCovariate) covariates.clear();
      break;
    }
    if (count > 0) ++result.groups;
    for (const ForceColumn& column : kForceColumns | std::views::filter(is_of)) {
      wanted.push_back(&column);
      result.of.push_back(d);
      result.group.push_back(result.groups - 1);
    }
  }
  for (const std::size_t c : covariates) {
    result.covariates.push_back(c);
    result.of.push_back(kCovariate);
    result.group.push_back(result.groups++);
  }
  const LawPoint point = PointAt(problem, theta);
  std::vector<double> force(problem.size());
  std::vector<double> complete(problem.size());
  response.Bind(problem);
  std::vector<double> by_asymmetry(tells_asymmetry ? problem.size() : 0);
  ResponseColumns wanted_of_response;
  wanted_of_response[TermId::kAsymmetry] = by_asymmetry;
  response.Differentiate(point, force, wanted_of_response);
  Predict(problem, theta, response, complete);
  double peak = 0.0;
  for (const double value : force) peak = std::max(peak, std::abs(value));
  result.columns.resize(static_cast<Eigen::Index>(problem.size()),
                        static_cast<Eigen::Index>(result.of.size()));
  std::size_t begin = 0;
  for (std::size_t r = 0; r < records.size(); ++r) {
    const ScaledRecord& record = records[r];
    models::OriginSensitivity sensitivity;
    response.DifferentiateByOrigins(point, r, sensitivity);
    std::vector<ForcePlace> places = ForcePlacesOf(
        record, clock.time[r], neighbours[r], std::span(force).subspan(begin, record.size()),
        std::span(complete).subspan(begin, record.size()), sensitivity, peak);
    if (is_repeated) {
      const std::vector<double> missed = MissedWay(record, clock.time[r], neighbours[r].samples);
      for (std::size_t i = 0; i < record.size(); ++i) places[i].missed = missed[i];
    }
    if (!amplitudes.empty()) {
      for (std::size_t i = 0; i < record.size(); ++i) places[i].amplitude = amplitudes[r][i];
    }
    for (std::size_t i = 0; i < record.size() && tells_asymmetry; ++i) {
      places[i].asymmetry = by_asymmetry[begin + i];
    }
    const models::LoadingPath& path = response.PathOf(r, theta);
    const ForcePlace extreme = problem.state.Of(r) == models::InitialState::kSteady
                                   ? SteadyExtreme<ForcePlace>(problem, point, record)
                                   : ForcePlace{};
    const std::vector<ForcePlace> origins =
        FollowBranches(*problem.model, path, sensitivity, std::span(places));
    for (std::size_t c = 0; c < wanted.size(); ++c) {
      const std::span<double> values(
          result.columns.col(static_cast<Eigen::Index>(c)).data() + begin, record.size());
      FillColumn(*wanted[c], path, extreme, places, origins, record, values);
      for (std::size_t i = 0; i < record.size(); ++i) values[i] *= record.root_weight[i];
    }
    for (std::size_t c = 0; c < result.covariates.size(); ++c) {
      const std::vector<double>& column = record.covariates[result.covariates[c]];
      double* const values =
          result.columns.col(static_cast<Eigen::Index>(wanted.size() + c)).data() + begin;
      for (std::size_t i = 0; i < record.size(); ++i) {
        values[i] = record.root_weight[i] * column[i];
      }
    }
    begin += record.size();
  }
  return result;
}

}  // namespace mindahl::identification
