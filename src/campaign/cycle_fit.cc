#include "mindahl/campaign/cycle_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "mindahl/campaign/cycle_table.h"
#include "mindahl/core/error.h"
#include "mindahl/identification/contact_amplitude.h"
#include "mindahl/models/steady_loop.h"
#include "mindahl/report/loop_description.h"

namespace mindahl::campaign {
namespace {

using identification::Depth;
using identification::FitOptions;
using identification::FitResult;
using identification::ParameterEstimate;

constexpr std::array kFlags = {
    CycleFlag{"not_converged", "the fit failed or did not converge; its values are not to be used"},
    CycleFlag{"sigma_open", "the cycle does not determine sigma"},
    CycleFlag{"alpha_open", "the cycle does not determine alpha"},
    CycleFlag{"slip_force_open", "the cycle does not determine Tc"},
    CycleFlag{"not_closed", "the cycle does not end where it began, to 5 % of its width"},
    CycleFlag{"no_loop", "the cycle has no facts: it dissipates nothing"},
    CycleFlag{"glitches", "spikes, dropouts or held values were left out"},
};

FitOptions OfSteadyCycles(FitOptions options) {
  if (!options.initial_state) options.initial_state = models::InitialState::kSteady;
  return options;
}

/// Measures the facts, with the ends as turning points where the gate has not found them.
loop::LoopFacts FactsOf(const loop::Record& record, const FitResult& result) {
  const identification::RecordFit& fitted = result.records.front();
  if (fitted.facts.closed) return fitted.facts;
  std::vector<std::size_t> turns = {0};
  turns.insert(turns.end(), fitted.reversals.begin(), fitted.reversals.end());
  turns.push_back(record.size() - 1);
  return loop::MeasureFacts(record, turns, result.force_sense);
}

void FillFacts(const loop::LoopFacts& facts, CycleFit& fit) {
  if (!std::ranges::all_of(facts.cycles, &loop::CycleFacts::returns)) {
    fit.flags.emplace_back("not_closed");
  }
  if (!facts.closed || !(facts.energy_per_cycle > 0)) {
    fit.flags.emplace_back("no_loop");
    return;
  }
  fit.amplitude = facts.amplitude;
  fit.peak_force = facts.peak_force;
  fit.sliding_amplitude = facts.sliding_amplitude;
  fit.half_gap = facts.half_gap;
  fit.energy = facts.energy_per_cycle;
  fit.energy_ratio = facts.energy_ratio;
  fit.slope_after_reversal = facts.slope_after_reversal;
  if (fit.normal_load) {
    fit.energy_friction_coefficient = loop::EnergyFrictionCoefficient(facts, *fit.normal_load);
  }
}

FittedValue FittedValueOf(const FitResult& result, std::string_view name, const char* open_flag,
                          CycleFit& fit) {
  const ParameterEstimate* estimate = result.Find(name);
  if (estimate == nullptr) return {};
  if (open_flag != nullptr && !estimate->is_known()) fit.flags.emplace_back(open_flag);
  if (!estimate->standard_error) return {estimate->value, {}};
  const double error = result.ErrorOf(*estimate);
  return {estimate->value, std::isfinite(error) ? std::optional(error) : std::nullopt};
}

/// Forces near the largest double overflow in squares and products: what is not finite then is not
/// known, and a fit whose residuals overflow is none.
void DropWhatOverflows(CycleFit& fit) {
  const bool has_residuals = !fit.rms || std::isfinite(*fit.rms);
  for (const CycleNumber& column : CycleNumbers()) {
    std::optional<double>& number = column.of(fit);
    if (number && !std::isfinite(*number)) number.reset();
  }
  if (!has_residuals && !fit.HasFlag("not_converged")) fit.flags.emplace_back("not_converged");
}

}  // namespace

std::span<const CycleFlag> CycleFlags() { return kFlags; }

CycleFitter::CycleFitter(FitOptions options) : fitter_(OfSteadyCycles(std::move(options))) {}

CycleFit CycleFitter::Fit(const Cycle& cycle) {
  CycleFit fit = FitAlone(cycle);
  DropWhatOverflows(fit);
  return fit;
}

CycleFit CycleFitter::FitAlone(const Cycle& cycle) {
  CycleFit fit;
  fit.number = cycle.number;
  fit.first_line = cycle.first_line;
  fit.checksum = cycle.checksum;
  fit.samples = cycle.record.size();
  const loop::Record& record = cycle.record;
  if (!record.time.empty()) fit.start_time = record.time.front();
  const std::vector<double>& given = fitter_.options().normal_loads;
  if (!given.empty()) {
    fit.normal_load = given.front();
  } else if (!record.normal_load.empty()) {
    fit.normal_load = std::accumulate(record.normal_load.begin(), record.normal_load.end(), 0.0) /
                      static_cast<double>(record.normal_load.size());
  }
  const FitResult* result = nullptr;
  try {
    result = &fitter_.Continue(record, Depth::kErrors);
  } catch (const InvalidArgument&) {
    // Too few samples, a displacement that stands still: no record to fit, as the flag says.
    fit.flags.emplace_back("not_converged");
    return fit;
  }
  if (!result->converged) fit.flags.emplace_back("not_converged");
  const identification::RecordFit& fitted = result->records.front();
  if (fitted.glitches.total() > 0) fit.flags.emplace_back("glitches");
  FillFacts(FactsOf(record, *result), fit);
  if (result->parameters.empty()) return fit;  // no start had the force's sign
  fit.sigma = FittedValueOf(*result, "sigma", "sigma_open", fit);
  fit.alpha = FittedValueOf(*result, "alpha", "alpha_open", fit);
  fit.slip_force = FittedValueOf(*result, "slip_force", "slip_force_open", fit);
  fit.force_offset = FittedValueOf(*result, "force_offset", nullptr, fit);
  fit.rms = result->rms;
  const bool is_known = result->Find("slip_force")->is_known();
  if (is_known && fit.slip_force.value && fit.normal_load && *fit.normal_load > 0) {
    fit.friction_coefficient = *fit.slip_force.value / *fit.normal_load;
  }
  if (result->converged) {
    fit.slips_grossly = report::SlipsGrossly(
        *result->model, result->law,
        identification::ContactAmplitude(*result, result->law, fitted.measures.amplitude));
  }
  return fit;
}

}  // namespace mindahl::campaign
