#include "mindahl/campaign/cycle_fit.h"

#include <fmt/compile.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "core/refuse.h"
#include "core/text.h"
#include "mindahl/identification/fit_result.h"
#include "mindahl/loop/disturbances.h"
#include "mindahl/report/units.h"

namespace mindahl::campaign {
namespace {

using identification::FitOptions;
using identification::FitResult;

FitOptions OfSteadyCycles(FitOptions options) {
  options.preparation.begins_at_turn = true;
  if (!options.initial_state) options.initial_state = models::InitialState::kSteady;
  return options;
}

/// Takes over the facts, with the ends as turning points where the gate has not found them.
void FillFacts(const Cycle& cycle, const FitResult& result, CycleFit& fit) {
  constexpr double kReturns = 0.05;  // of the width
  const loop::Record& record = cycle.record;
  const identification::RecordFit& fitted = result.records.front();
  loop::LoopFacts facts = fitted.facts;
  if (facts.cycles.size() != cycle.cycles) {
    std::vector<std::size_t> turns = {0};
    turns.insert(turns.end(), fitted.reversals.begin(), fitted.reversals.end());
    turns.push_back(record.size() - 1);
    facts = loop::MeasureFacts(record, turns, result.force_sense);
  }
  const double way = record.displacement.back() - record.displacement.front();
  if (!(std::abs(way) <= kReturns * 2 * facts.amplitude)) fit.flags.emplace_back("not_closed");
  if (!facts.closed || !(facts.energy_per_cycle > 0)) {
    fit.flags.emplace_back("no_loop");
    return;
  }
  fit["amplitude"] = facts.amplitude;
  fit["peak_force"] = facts.peak_force;
  fit["sliding_amplitude"] = facts.sliding_amplitude;
  fit["half_gap"] = facts.half_gap;
  double energy = 0.0;
  for (const loop::CycleFacts& each : facts.cycles) energy += each.energy;
  fit["energy"] = energy / static_cast<double>(facts.cycles.size());
  fit["energy_ratio"] = facts.energy_ratio;
  // µ_W = W/(4·N·sliding amplitude)
  const double rectangle =
      4 * fit["normal_load"].value_or(0.0) * facts.sliding_amplitude.value_or(0.0);
  if (rectangle > 0) fit["energy_friction_coefficient"] = facts.energy_per_cycle / rectangle;
}

// A torque about the contact has no contact radius, the last of them.
static_assert(kCycleNumbers.back().name == "contact_radius");

std::size_t CountOfNumbers(bool is_torsional) {
  return kCycleNumbers.size() - (is_torsional ? 1 : 0);
}

template <typename Value>
Value CellValue(std::string_view cell) {
  if (const auto value = NumberIn<Value>(cell)) return *value;
  Refuse("'{}' is not a number", cell);
}

/// Interpolates glitches in the first and last two samples of a cycle, where FindAndInterpolate()
/// looks for none: the halves are exchanged, so that the ends meet in the middle.
/// @returns true if there was one
bool RepairEnds(loop::Record& cycle) {
  constexpr std::size_t kNearEnd = 2;  // samples
  const std::size_t half = cycle.size() / 2;
  loop::Record exchanged{.displacement = cycle.displacement, .force = cycle.force};
  for (auto* const values : {&exchanged.displacement, &exchanged.force}) {
    std::ranges::rotate(*values, values->begin() + static_cast<std::ptrdiff_t>(half));
  }
  const loop::Interpolated found = loop::FindAndInterpolate(exchanged);
  const std::size_t seam = cycle.size() - half;
  bool is_repaired = false;
  for (const std::size_t i : found.glitches) {
    if (i + kNearEnd < seam || i >= seam + kNearEnd) continue;
    const std::size_t place = (i + half) % cycle.size();
    if (!found.displacement.empty()) cycle.displacement[place] = found.displacement[i];
    if (!found.force.empty()) cycle.force[place] = found.force[i];
    is_repaired = true;
  }
  return is_repaired;
}

}  // namespace

void RequireFit(const loop::RecordView& head, const FitOptions& options) {
  const auto [least, greatest] = std::ranges::minmax(head.force);
  if (least == greatest) return;
  FitOptions looked_at = OfSteadyCycles(options);
  looked_at.max_iterations = 1;  // options are refused before the search, or after any
  identification::Fitter(looked_at).Fit(head, identification::Depth::kEstimate);
}

CycleFitter::CycleFitter(FitOptions options, std::optional<double> compliance)
    : fitter_(OfSteadyCycles(std::move(options))), compliance_(compliance) {}

CycleFit CycleFitter::Fit(const Cycle& read) {
  Cycle cycle = read;
  const bool is_repaired = RepairEnds(cycle.record);
  const loop::Record& record = cycle.record;
  CycleFit fit{.number = cycle.number,
               .first_line = cycle.first_line,
               .samples = record.size(),
               .cycles = cycle.cycles};
  if (!record.time.empty()) fit["start_time"] = record.time.front();
  const std::vector<double>& given = fitter_.options().normal_loads;
  if (!given.empty()) {
    fit["normal_load"] = given.front();
  } else if (!record.normal_load.empty()) {
    fit["normal_load"] =
        std::accumulate(record.normal_load.begin(), record.normal_load.end(), 0.0) /
        static_cast<double>(record.normal_load.size());
  }
  const FitResult* result = nullptr;
  try {
    result = &fitter_.Continue(record, identification::Depth::kErrors);
  } catch (const InvalidArgument&) {
    // Too few samples, a displacement that stands still: no record to fit, as the flag says.
    fit.flags.emplace_back("not_converged");
    return fit;
  }
  if (!result->converged) fit.flags.emplace_back("not_converged");
  const identification::RecordFit& fitted = result->records.front();
  if (is_repaired || !fitted.glitches.empty()) fit.flags.emplace_back("glitches");
  if (result->FindFinding("rows_missing") != nullptr) fit.flags.emplace_back("rows_missing");
  FillFacts(cycle, *result, fit);
  if (result->parameters.empty()) return fit;  // no start had the force's sign
  for (const std::string name : {"sigma", "alpha", "slip_force", "force_offset"}) {
    const identification::ParameterEstimate* estimate = result->Find(name);
    if (estimate == nullptr) continue;
    const bool is_own = estimate->is_known() && !estimate->is_at_given_bound();
    if (name != "force_offset" && !is_own) fit.flags.push_back(name + "_open");
    fit[name] = estimate->value;
    const double error = result->ErrorOf(*estimate);
    if (estimate->standard_error && std::isfinite(error)) fit[name + "_error"] = error;
  }
  fit["rms"] = result->rms;
  if (compliance_ && !fit.HasFlag("sigma_open")) {
    fit["contact_radius"] = *fit["sigma"] * *compliance_ / 8;
  }
  if (fit["normal_load"] > 0.0 && !fit.HasFlag("slip_force_open")) {
    fit["friction_coefficient"] = *fit["slip_force"] / *fit["normal_load"];
  }
  return fit;
}

std::string CycleTableHeader(bool is_torsional) {
  std::string header = "cycle,first_line,samples,cycles";
  for (const CycleNumber& column : std::span(kCycleNumbers).first(CountOfNumbers(is_torsional))) {
    header += ',' + report::WithUnit(column.name, is_torsional ? report::UnitOfTorque(column.unit)
                                                               : std::string(column.unit));
  }
  return header + ",accumulated_energy [J],flags\n";
}

std::string CycleTableRow(const CycleFit& fit, double accumulated_energy, bool is_torsional) {
  fmt::memory_buffer row;
  const auto end = std::back_inserter(row);
  fmt::format_to(end, "{},{},{},{}", fit.number, fit.first_line, fit.samples, fit.cycles);
  for (const auto& number : std::span(fit.numbers).first(CountOfNumbers(is_torsional))) {
    row.push_back(',');
    if (number) fmt::format_to(end, FMT_COMPILE("{}"), *number);
  }
  fmt::format_to(end, ",{},{}\n", accumulated_energy, fmt::join(fit.flags, " "));
  return fmt::to_string(row);
}

CycleFit ReadCycleTableRow(std::string_view line, bool is_torsional) {
  const std::vector<std::string_view> cells = PartsOf(line, ',');
  CycleFit fit;
  const std::array counts = {&fit.number, &fit.first_line, &fit.samples, &fit.cycles};
  const auto numbers = std::span(fit.numbers).first(CountOfNumbers(is_torsional));
  const std::size_t columns = counts.size() + numbers.size() + 2;  // accumulated_energy and flags
  if (cells.size() != columns) Refuse("has {} cells of {}", cells.size(), columns);
  auto cell = cells.begin();
  for (std::size_t* const count : counts) *count = CellValue<std::size_t>(*cell++);
  for (std::optional<double>& number : numbers) {
    if (!cell->empty()) number = CellValue<double>(*cell);
    ++cell;
  }
  for (const std::string_view flag : PartsOf(cells.back(), ' ')) {
    if (!flag.empty()) fit.flags.emplace_back(flag);
  }
  return fit;
}

}  // namespace mindahl::campaign
