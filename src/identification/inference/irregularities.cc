#include "identification/inference/irregularities.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "identification/inference/evidence.h"
#include "identification/inference/heavy_tails.h"
#include "identification/inference/ripple.h"
#include "identification/inference/stick_slip.h"

namespace mindahl::identification {
namespace {

enum IrregularityRow : std::size_t { kHeavyTails, kStickSlip, kRipple };

constexpr std::array<Irregularity, 3> kIrregularities = {{
    {.code = "heavy_tails",
     .meaning = "fraction of the readings that are far off both their neighbours",
     .unit = "-",
     .option = "--loss huber"},
    {.code = "stick_slip",
     .meaning = "median drop of the force, against the motion, while the contact slides",
     .unit = "N",
     .option = ""},
    {.code = "position_ripple",
     .meaning = "period along the displacement of a force that has one phase in all strokes of a "
                "direction",
     .unit = "m",
     .option = "--ripple PERIOD"},
}};

std::vector<FittedSample> SamplesOf(const Problem& problem, std::span<const double> theta,
                                    std::span<const double> residual, Response& response) {
  std::vector<double> force(problem.size());
  response.Bind(problem);
  response.Evaluate(PointAt(problem, theta), force);
  std::vector<FittedSample> samples;
  samples.reserve(problem.size());
  std::size_t k = 0;
  for (std::size_t r = 0; r < problem.data->records.size(); ++r) {
    const ScaledRecord& record = problem.data->records[r];
    std::size_t next = 0;
    for (std::size_t i = 0; i < record.size(); ++i, ++k) {
      const bool turns = next < record.reversals.size() && record.reversals[next] == i;
      if (turns) ++next;
      if (!record.inserted.empty() && record.inserted[i] != 0) {
        if (turns && !samples.empty()) samples.back().turns = true;
        continue;
      }
      samples.push_back({.record = r,
                         .displacement = record.displacement[i],
                         .response = force[k],
                         .residual = residual[k],
                         .counts = record.counts[i] != 0,
                         .turns = turns});
    }
  }
  return samples;
}

}  // namespace

std::span<const Irregularity> Irregularities() { return kIrregularities; }

std::vector<IrregularityFit> FindIrregularities(const Problem& problem,
                                                std::span<const double> theta,
                                                std::span<const double> residual,
                                                const Noise& noise, bool robust, bool doubtful,
                                                Response& response) {
  std::vector<IrregularityFit> found;
  double squares = 0.0;
  for (const double value : residual) squares += value * value;
  // Rounding errors come in steps of their own.
  const double rms = std::sqrt(squares / static_cast<double>(problem.data->counted));
  if (rms < 10 * kRoundingRms) return found;
  const std::vector<FittedSample> samples = SamplesOf(problem, theta, residual, response);
  const Evidence evidence(noise);
  const auto add = [&](std::size_t row, std::optional<IrregularityFit> fit) {
    if (!fit) return;
    fit->irregularity = row;
    found.push_back(*fit);
  };
  if (!robust) add(kHeavyTails, FindHeavyTails(samples, evidence));
  // A force that is imposed drops by itself.
  if (problem.data->is_forced()) return found;
  // One phase in all strokes is the drive's: stick-slip of a contact has none.
  const std::optional<IrregularityFit> stick_slip = FindStickSlip(samples);
  const bool is_fitted = std::ranges::any_of(problem.parameters.free(), [&](std::size_t p) {
    return problem.parameters[p].term->option == "--ripple";
  });
  std::optional<IrregularityFit> ripple;
  if (!is_fitted && (doubtful || stick_slip)) ripple = FindRipple(samples);
  if (ripple) {
    add(kRipple, ripple);
  } else {
    add(kStickSlip, stick_slip);
  }
  return found;
}

}  // namespace mindahl::identification
