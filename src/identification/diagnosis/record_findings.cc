#include "identification/diagnosis/record_findings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include "identification/diagnosis/grade.h"
#include "identification/intervals.h"
#include "mindahl/identification/fit_result.h"
#include "mindahl/identification/terms.h"
#include "mindahl/identification/thresholds.h"
#include "mindahl/models/steady_loop.h"

namespace mindahl::identification {
namespace {

/// Counted as the report does, after smoothing.
Finding UncertainReversals(const RecordFit& record) {
  const loop::ReversalGate& gate = record.gate;
  return {.code = "reversals_uncertain",
          .numbers = {{"count", static_cast<double>(record.reversals.size())},
                      {"gate", gate.gate},
                      {"other_count", static_cast<double>(gate.other_count)},
                      {"other_gate", gate.other_gate}}};
}

Finding GlitchesLeftOut(const loop::GlitchCount& glitches) {
  Finding finding{.code = "glitches_left_out",
                  .numbers = {{"spikes", static_cast<double>(glitches.spikes)},
                              {"dropouts", static_cast<double>(glitches.dropouts)},
                              {"held", static_cast<double>(glitches.held)}}};
  const std::size_t examples = std::min(glitches.total(), glitches.examples.size());
  for (std::size_t i = 0; i < examples; ++i) {
    finding.numbers.emplace_back("row", static_cast<double>(glitches.examples[i] + 1));
  }
  return finding;
}

/// True if a cycle of two strokes ends elsewhere than it began and so is no loop of its amplitude.
/// A long stroke with a short one is no such cycle: its reversals are doubtful.
/// @param widest  amplitude of the record's widest swings [m]
bool RunsOn(const loop::CycleFacts& cycle, double widest) {
  constexpr double kTwoStrokes = 0.6;  // half of it is one stroke's
  return !cycle.returns && cycle.amplitude > kTwoStrokes * widest;
}

struct CycleEnergies {
  double measured = 0.0;  // [J]
  double of_law = 0.0;
};

/// Mean energies of the widest steady cycles, of those most of whose samples count.
/// @param of_steady_loop  what the law loses in a cycle where that is the same in all
std::optional<CycleEnergies> EnergiesThatCount(const RecordFit& record, double of_steady_loop) {
  const std::vector<loop::CycleFacts>& cycles = record.facts.cycles;
  CycleEnergies sum;
  double count = 0.0;
  for (std::size_t k = 0; k < cycles.size(); ++k) {
    if (!cycles[k].steady || RunsOn(cycles[k], record.measures.amplitude)) continue;
    const std::size_t end = k + 1 < cycles.size() ? cycles[k + 1].start : record.counts.size();
    const auto samples = std::span(record.counts).subspan(cycles[k].start, end - cycles[k].start);
    if (2 * static_cast<std::size_t>(std::ranges::count(samples, 0)) > samples.size()) continue;
    sum.measured += cycles[k].energy;
    if (!record.law_energy.empty()) sum.of_law += record.law_energy[k];
    ++count;
  }
  if (count == 0) return std::nullopt;
  return CycleEnergies{.measured = sum.measured / count,
                       .of_law = record.law_energy.empty() ? of_steady_loop : sum.of_law / count};
}

}  // namespace

std::vector<Finding> FindInRecords(std::span<const RecordFit> records, const Thresholds& thresholds,
                                   loop::Channel excitation) {
  std::vector<Finding> findings;
  for (std::size_t r = 0; r < records.size(); ++r) {
    const RecordFit& record = records[r];
    const auto append = [&](Finding finding) {
      if (records.size() > 1) {
        finding.numbers.emplace_back("record", static_cast<double>(r + 1));
      }
      findings.push_back(std::move(finding));
    };
    if (!record.gate.certain) append(UncertainReversals(record));
    // Noise of a displacement that responds is no part of the path.
    const bool is_driven = excitation == loop::Channel::kDisplacement;
    if (is_driven && record.facts.closed && record.facts.path_ratio > 1 + thresholds.path_excess) {
      append({.code = "path_too_long", .numbers = {{"path_ratio", record.facts.path_ratio}}});
    }
    if (record.glitches.total() > 0) append(GlitchesLeftOut(record.glitches));
    if (!record.facts.closed) append({.code = "no_closed_cycle"});
  }
  return findings;
}

std::vector<Finding> FindVaryingLoads(const ScaledRecords& data) {
  std::vector<Finding> findings;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    const ScaledRecord& record = data.records[r];
    const bool is_followed = !record.load_ratio.empty();
    if (!is_followed && record.load_change.empty()) continue;
    double sum = 0.0;
    double squares = 0.0;
    double count = 0.0;
    for (std::size_t i = 0; i < record.size(); ++i) {
      if (record.counts[i] == 0) continue;
      const double change = is_followed ? record.load_ratio[i] - 1 : record.load_change[i];
      sum += change;
      squares += change * change;
      ++count;
    }
    // The mean of a load of either sign differs from that of its magnitude.
    const double mean = sum / std::max(count, 1.0);
    Finding& finding = findings.emplace_back(Finding{
        .code = is_followed ? FindingCode("load_followed") : FindingCode("load_not_followed"),
        .numbers = {{"variation",
                     std::sqrt(2 * std::max(squares / std::max(count, 1.0) - mean * mean, 0.0))}}});
    if (data.records.size() > 1) {
      finding.numbers.emplace_back("record", static_cast<double>(r + 1));
    }
  }
  return findings;
}

std::optional<Finding> FindEnergyContradiction(const FitResult& result,
                                               const Thresholds& thresholds) {
  const RecordFit& record = result.WidestRecord();
  // The measured energy includes the readings that a robust loss weighs down.
  if (result.outliers > 0) return std::nullopt;
  // Its energy depends on the load's time history too.
  if (record.load_varies) return std::nullopt;
  // These lose, or shift, energy that is not the contact's.
  const bool has_other = std::ranges::any_of(result.parameters, [](const ParameterEstimate& other) {
    return TurnsWithMotion(other) && other.value != 0;
  });
  if (has_other) return std::nullopt;
  const double amplitude = record.facts.amplitude;
  const models::BranchLaw law = result.LawOf(record);
  const std::optional<CycleEnergies> energies = EnergiesThatCount(
      record,
      models::SteadyLoopEnergy(*result.model, law, ContactAmplitude(result, law, amplitude)));
  if (!energies) return std::nullopt;
  const auto [measured, model] = *energies;
  const double difference = std::abs(measured - model);
  if (!(difference > thresholds.energy_difference * std::max(std::abs(measured), model))) {
    return std::nullopt;
  }
  // ∮ T dδ sums forces over a way of 4X, or displacements over one of 4T*.
  const double way = result.response == loop::Channel::kForce ? amplitude : record.facts.peak_force;
  const double error = 4 * way * result.ResponseNoise() /
                       std::sqrt(std::max(1.0, result.residuals.effective_samples));
  if (!(difference > thresholds.energy_errors * error)) return std::nullopt;
  return Finding{.code = "energy_contradiction",
                 .parameters = WithoutEffective(result, {"sigma", "alpha", "slip_force"}),
                 .numbers = {{"measured", measured}, {"model", model}, {"amplitude", amplitude}}};
}

}  // namespace mindahl::identification
