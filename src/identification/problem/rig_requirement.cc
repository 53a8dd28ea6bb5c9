#include "identification/problem/rig_requirement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "mindahl/core/error.h"

namespace mindahl::identification {
namespace {

constexpr std::size_t kChords = 10;

/// Stiffness [N/m] of a record's chords, as documented; 0 where it has no whole stroke.
double StiffnessOfLoop(const loop::PreparedRecord& record, double sense) {
  const std::span<const double> displacement = record.displacement();
  const std::span<const double> force = record.record.force;
  std::vector<double> rise(kChords, 0.0);
  std::vector<double> way(kChords, 0.0);
  for (std::size_t k = 0; k + 1 < record.reversals.size(); ++k) {
    const std::size_t begin = record.reversals[k];
    const std::size_t end = record.reversals[k + 1];
    const double stroke = displacement[end] - displacement[begin];
    constexpr double kMainStroke = 0.75;  // of the widest, 2X
    if (!(std::abs(stroke) >= kMainStroke * 2 * record.measures.amplitude)) continue;
    std::size_t chord = 0;
    for (std::size_t i = begin + 1; i <= end && chord < kChords; ++i) {
      const double share = (displacement[i] - displacement[begin]) / stroke;
      if (share * kChords < static_cast<double>(chord + 1)) continue;
      const double direction = std::copysign(1.0, stroke);
      rise[chord] += direction * sense * (force[i] - force[begin]);
      way[chord] += direction * (displacement[i] - displacement[begin]);
      ++chord;
    }
  }
  double stiffness = 0.0;
  for (std::size_t chord = 0; chord < kChords; ++chord) {
    if (way[chord] > 0) stiffness = std::max(stiffness, rise[chord] / way[chord]);
  }
  return stiffness;
}

}  // namespace

void RequireRigStifferThanLoop(const FitOptions& options, const loop::PreparedRecords& records) {
  const auto rig = options.fixed.find("rig_stiffness");
  if (rig == options.fixed.end() || !(rig->second > 0)) return;  // one that is stated is fitted
  for (const loop::PreparedRecord& record : records.records) {
    const double stiffness = StiffnessOfLoop(record, records.force_sense);
    if (rig->second > stiffness) continue;
    ThrowInvalid("rig_stiffness [N/m]", rig->second,
                 fmt::format("must be > {:.4g}, the stiffness that the loop itself has after its "
                             "reversals: with a softer rig the contact would move backwards; "
                             "measure the rig again, or fit it",
                             stiffness));
  }
}

}  // namespace mindahl::identification
