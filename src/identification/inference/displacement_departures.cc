#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>
#include <vector>

#include "identification/inference/departures.h"
#include "identification/inference/sampled_time.h"

namespace mindahl::identification {
namespace {

/// Describes a sample for the omitted terms, in units of the data; time in that of the clock.
struct DisplacementPlace {
  double time = 0.0;  // from the record's middle
  double force = 0.0;
  double displacement = 0.0;  // of the contact, from where it is unloaded
  double rate = 0.0;          // of the displacement
  double gap = 0.0;           // ½ in the direction of the branch, 0 before the first turn
  std::array<double, 3> bulges{};
};

using DisplacementDeparture = double (*)(const DisplacementPlace&);

struct DisplacementColumn {
  std::string_view departure;
  DisplacementDeparture value;
};

constexpr std::array<DisplacementColumn, 9> kDisplacementColumns = {{
    // A force that is read late meets the displacement of later.
    {"channel_lag", [](const DisplacementPlace& at) { return at.rate; }},
    {"shape_of_law", [](const DisplacementPlace& at) { return at.bulges[0]; }},
    {"shape_of_law", [](const DisplacementPlace& at) { return at.bulges[1]; }},
    {"shape_of_law", [](const DisplacementPlace& at) { return at.bulges[2]; }},
    {"rig_in_series", [](const DisplacementPlace& at) { return at.force; }},
    {"backlash", [](const DisplacementPlace& at) { return at.gap; }},
    {"displacement_sensor",
     [](const DisplacementPlace& at) { return -at.displacement * at.displacement; }},
    {"displacement_sensor",
     [](const DisplacementPlace& at) {
       return -at.displacement * at.displacement * at.displacement;
     }},
    {"displacement_drift", [](const DisplacementPlace& at) { return at.time; }},
}};

std::size_t IndexOfDeparture(std::string_view code) {
  return static_cast<std::size_t>(std::ranges::find(Departures(), code, &Departure::code) -
                                  Departures().begin());
}

/// A branch as the force runs along it.
struct Run {
  double origin = 0.0;
  double height = 1.0;  // to slip
  double span = 1.0;    // of the bulges, as of the displacement
  bool is_virgin = false;
  std::array<double, 3> at_origin{};

  [[nodiscard]] std::array<double, 3> BulgesAt(double force, double unit) const {
    const double way = force - origin;
    const double mobilised = std::clamp(std::abs(way) / height, 0.0, 1.0);
    std::array<double, 3> bulges = at_origin;
    for (std::size_t k = 0; k < bulges.size(); ++k) {
      const double half_waves = static_cast<double>(k + 1) * std::numbers::pi;
      bulges[k] += std::copysign(unit * span, way) * std::sin(half_waves * mobilised);
    }
    return bulges;
  }
};

/// Each half wave along each branch, which goes on from what it was where the branch starts.
void FillBulges(const Problem& problem, const models::LoadingPath& path, double slip_force,
                double unit, std::span<const double> force, std::span<DisplacementPlace> places) {
  const double unloaded = models::UnloadedAt(path);
  std::vector<Run> runs;
  for (const models::Branch& branch : path.branches) {
    const bool is_virgin = models::IsVirgin(branch.start);
    const double t = branch.direction * (branch.origin - unloaded) / slip_force;
    const models::BranchScale scale = problem.model->scale(t, 0.0, is_virgin);
    Run run{.origin = branch.origin,
            .height = scale.span * scale.remaining * slip_force,
            .span = scale.span,
            .is_virgin = is_virgin};
    if (branch.parent >= 0) {
      run.at_origin = runs[static_cast<std::size_t>(branch.parent)].BulgesAt(branch.origin, unit);
    }
    runs.push_back(run);
  }
  for (const models::BranchRun& run : path.runs) {
    const auto b = static_cast<std::size_t>(run.branch);
    for (std::size_t i = run.begin; i < run.end; ++i) {
      places[i].bulges = runs[b].BulgesAt(force[i], unit);
      const bool sets_out = runs[b].is_virgin;
      places[i].gap = sets_out ? 0.0 : 0.5 * path.branches[b].direction;
    }
  }
}

std::vector<const DisplacementColumn*> Wanted(const Problem& problem, std::size_t most) {
  std::vector<const DisplacementColumn*> wanted;
  for (auto begin = kDisplacementColumns.begin(); begin != kDisplacementColumns.end();) {
    const auto end = std::find_if(
        begin, kDisplacementColumns.end(),
        [&](const DisplacementColumn& column) { return column.departure != begin->departure; });
    const bool is_fitted = std::ranges::any_of(problem.parameters.free(), [&](std::size_t p) {
      return problem.parameters[p].term->name ==
             Departures()[IndexOfDeparture(begin->departure)].term;
    });
    if (!is_fitted) {
      if (wanted.size() + static_cast<std::size_t>(end - begin) > most) break;
      for (auto column = begin; column != end; ++column) wanted.push_back(column);
    }
    begin = end;
  }
  return wanted;
}

}  // namespace

DepartureColumns ColumnsOfDisplacementDepartures(const Problem& problem,
                                                 std::span<const double> theta, Response& response,
                                                 std::size_t most) {
  const ScaledRecords& data = *problem.data;
  std::vector<Neighbours> neighbours;
  for (const ScaledRecord& record : data.records) neighbours.push_back(NeighboursOf(record));
  const Clock clock = ClockOf(data, neighbours);
  DepartureColumns result;
  const std::vector<const DisplacementColumn*> wanted = Wanted(problem, most);
  for (const DisplacementColumn* const column : wanted) {
    const std::size_t departure = IndexOfDeparture(column->departure);
    if (result.of.empty() || result.of.back() != departure) ++result.groups;
    result.of.push_back(departure);
    result.group.push_back(result.groups - 1);
  }
  result.columns.resize(static_cast<Eigen::Index>(problem.size()),
                        static_cast<Eigen::Index>(wanted.size()));
  std::vector<double> reduced(problem.size());
  response.Bind(problem);
  response.Evaluate(PointAt(problem, theta), reduced);
  const double slip_force = std::exp(theta[kSlipForce]);
  const double scale = std::exp(LogScaleAt(problem, theta));
  std::size_t begin = 0;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    const ScaledRecord& record = data.records[r];
    const std::span<double> displacement = std::span(reduced).subspan(begin, record.size());
    for (double& value : displacement) value *= scale;
    std::vector<double> rate(record.size());
    Derive(displacement, clock.time[r], neighbours[r], true, rate);
    std::vector<DisplacementPlace> places(record.size());
    for (std::size_t i = 0; i < record.size(); ++i) {
      places[i].time = clock.time[r][i];
      places[i].force = record.force[i];
      places[i].displacement = displacement[i];
      places[i].rate = rate[i];
    }
    FillBulges(problem, response.PathOf(r, theta), slip_force, scale, record.excitation(), places);
    for (std::size_t c = 0; c < wanted.size(); ++c) {
      double* const values = result.columns.col(static_cast<Eigen::Index>(c)).data() + begin;
      for (std::size_t i = 0; i < record.size(); ++i) {
        values[i] = record.root_weight[i] * wanted[c]->value(places[i]);
      }
    }
    begin += record.size();
  }
  return result;
}

}  // namespace mindahl::identification
