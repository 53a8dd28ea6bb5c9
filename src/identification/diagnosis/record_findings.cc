#include "identification/diagnosis/record_findings.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include "mindahl/identification/fit_result.h"
#include "mindahl/identification/thresholds.h"

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

}  // namespace mindahl::identification
