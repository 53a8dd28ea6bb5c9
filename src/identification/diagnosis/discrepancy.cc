#include "identification/diagnosis/discrepancy.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "core/probability.h"
#include "identification/diagnosis/residuals.h"

namespace mindahl::identification {
namespace {

/// Half the width of the interval in which a further cycle of the same loop has its half gap:
/// Student's for so few cycles.
double ScatterOfCycles(const loop::LoopFacts& facts, double confidence) {
  const auto cycles = static_cast<double>(facts.steady_cycles);
  if (!facts.half_gap_standard_deviation || cycles < 3) return 0.0;
  return StudentQuantile(cycles - 1, confidence) * *facts.half_gap_standard_deviation *
         std::sqrt(1 + 1 / cycles);
}

/// The stiffness of the record after its reversals over that of the model: slopes of least squares,
/// each stroke with an intercept of its own, where the model's force has changed by less than a
/// fraction of what it changes by in the stroke.
/// @returns nothing where the strokes have fewer than two samples there
std::optional<double> RatioOfStiffness(const Estimates& estimates, const Thresholds& thresholds,
                                       double window) {
  constexpr double kFewestOfAStroke = 2;  // samples, for a chord
  const ScaledRecords& data = *estimates.problem().data;
  double measured = 0.0;
  double model = 0.0;
  double strokes = 0.0;
  double samples = 0.0;
  std::size_t begin = 0;
  for (const ScaledRecord& record : data.records) {
    const auto force_of_model = [&](std::size_t i) {
      return record.force[i] +
             estimates.residual()(static_cast<Eigen::Index>(begin + i)) / record.root_weight[i];
    };
    for (const Stroke& stroke : MainStrokes(record, thresholds)) {
      std::vector<std::size_t> counted;
      for (std::size_t i = stroke.begin; i < stroke.end; ++i) {
        if (record.root_weight[i] > 0) counted.push_back(i);
      }
      if (counted.empty()) continue;
      const double first = force_of_model(counted.front());
      const double limit = window * std::abs(force_of_model(counted.back()) - first);
      std::vector<double> near;  // displacement, force and the model's of a sample
      for (const std::size_t i : counted) {
        const double force = force_of_model(i);
        if (std::abs(force - first) > limit) break;
        // The motion turned anywhere about its outermost sample.
        if (i == stroke.begin) continue;
        near.insert(near.end(), {record.displacement[i], record.force[i], force});
      }
      ++strokes;
      if (near.empty()) continue;
      const Eigen::Map<const Eigen::Array3Xd> at(near.data(), 3, std::ssize(near) / 3);
      const Eigen::ArrayXd places = at.row(0).transpose() - at.row(0).mean();
      measured += (places * at.row(1).transpose()).sum();
      model += (places * at.row(2).transpose()).sum();
      samples += static_cast<double>(at.cols());
    }
    begin += record.size();
  }
  const double ratio = measured / model;  // of slopes at the same points
  const bool is_known = samples >= kFewestOfAStroke * strokes && ratio > 0 && std::isfinite(ratio);
  return is_known ? std::optional(ratio) : std::nullopt;
}

/// The same over an eighth, a quarter and a half of the change, and at the reversal itself: by the
/// parabola through these, and as much again within the narrowest as is seen of it.
std::vector<double> RatiosOfStiffness(const Estimates& estimates, const Thresholds& thresholds) {
  std::vector<double> ratios;
  if (estimates.problem().data->is_forced()) return ratios;
  for (const double window : {0.125, 0.25, 0.5}) {
    const std::optional<double> ratio = RatioOfStiffness(estimates, thresholds, window);
    if (ratio) ratios.push_back(*ratio);
  }
  if (ratios.empty()) return ratios;
  const double parabola =
      ratios.size() > 2 ? 8.0 / 3 * ratios[0] - 2 * ratios[1] + ratios[2] / 3 : 0.0;
  ratios.push_back(ratios[0] * ratios[0]);
  if (parabola > 0) ratios.push_back(parabola);
  return ratios;
}

}  // namespace

ParameterEstimates CoverDiscrepancy(const Estimates& fitted, const Thresholds& thresholds,
                                    const FitResult& result) {
  ParameterEstimates parameters = result.parameters;
  ParameterEstimate& slip_force = parameters[kSlipForce];
  IncludeRatios(parameters[kStiffness], RatiosOfStiffness(fitted, thresholds));
  for (ParameterEstimate& estimate : parameters) {
    const bool is_closed = estimate.lower95 && estimate.upper95;
    estimate.includes_discrepancy = estimate.status != ParameterStatus::kFixed && is_closed &&
                                    result.adequacy.use != Use::kNone;
  }
  const loop::LoopFacts& facts = result.WidestRecord().facts;
  const double load_ratio = result.WidestRecord().load_ratio;
  const std::optional<double> half_gap = result.MeasuredHalfGap();
  const bool is_free = slip_force.status != ParameterStatus::kFixed;
  const bool has_slipped = loop::Slides(facts) || loop::ReachesSlip(facts);
  if (!is_free || !half_gap || !has_slipped) return parameters;

  const double margin =
      std::hypot(ScatterOfCycles(facts, result.confidence) / load_ratio, result.adequacy.misfit);
  // The value itself is no better known than the gap.
  const double least = std::min(*half_gap, slip_force.value) - margin;
  const double most =
      std::max({*half_gap, facts.peak_force / load_ratio, slip_force.value}) + margin;
  const auto [lower, upper] =
      std::minmax({slip_force.value, *half_gap - margin, *half_gap + margin,
                   std::clamp(slip_force.lower95.value_or(0.0), least, most),
                   std::clamp(slip_force.upper95.value_or(most), least, most)});
  SetInterval(slip_force, {.lower = std::max(lower, 0.0), .upper = upper});
  slip_force.includes_discrepancy = true;
  return parameters;
}

}  // namespace mindahl::identification
