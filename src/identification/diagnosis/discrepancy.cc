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

/// Returns Σ(x − x̄)(y − ȳ): of the same x, slopes are in proportion to it.
double CrossProduct(const std::vector<double>& x, const std::vector<double>& y) {
  if (x.empty()) return 0.0;
  const Eigen::Map<const Eigen::ArrayXd> of_x(x.data(), std::ssize(x));
  const Eigen::Map<const Eigen::ArrayXd> of_y(y.data(), std::ssize(y));
  return ((of_x - of_x.mean()) * (of_y - of_y.mean())).sum();
}

/// Half the width of the interval in which a further cycle of the same loop has its half gap:
/// Student's for so few cycles.
double ScatterOfCycles(const loop::LoopFacts& facts, double confidence) {
  const auto cycles = static_cast<double>(facts.steady_cycles);
  if (!facts.half_gap_standard_deviation || cycles < 3) return 0.0;
  return StudentQuantile(cycles - 1, confidence) * *facts.half_gap_standard_deviation *
         std::sqrt(1 + 1 / cycles);
}

/// The stiffness of the record after its reversals over that of the model: slopes of least squares,
/// each stroke with an intercept of its own, over the places where the model's force has changed by
/// less than an eighth, a quarter and a half of what it changes by in the stroke, and, at the
/// reversal itself, the parabola through these and the square of the narrowest window's.
/// @returns those of windows that have two samples a stroke or more
std::vector<double> StiffnessOfWindows(const Estimates& estimates, const Thresholds& thresholds) {
  std::vector<double> ratios;
  const ScaledRecords& data = *estimates.problem().data;
  if (data.is_forced()) return ratios;
  for (const double window : {0.125, 0.25, 0.5}) {
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
        std::vector<double> places;
        std::vector<double> measured_forces;
        std::vector<double> model_forces;
        std::optional<double> first;
        double last = 0.0;
        for (std::size_t i = stroke.begin; i < stroke.end; ++i) {
          if (!(record.root_weight[i] > 0)) continue;
          if (!first) first = force_of_model(i);
          last = force_of_model(i);
        }
        if (!first) continue;
        // The motion turned anywhere about its outermost sample.
        for (std::size_t i = stroke.begin + 1; i < stroke.end; ++i) {
          if (!(record.root_weight[i] > 0)) continue;
          const double force = force_of_model(i);
          if (std::abs(force - *first) > window * std::abs(last - *first)) break;
          places.push_back(record.displacement[i]);
          measured_forces.push_back(record.force[i]);
          model_forces.push_back(force);
        }
        measured += CrossProduct(places, measured_forces);
        model += CrossProduct(places, model_forces);
        samples += static_cast<double>(places.size());
        ++strokes;
      }
      begin += record.size();
    }
    constexpr double kFewestOfAStroke = 2;  // samples a stroke, for a chord
    if (samples < kFewestOfAStroke * strokes || model == 0) continue;
    const double ratio = measured / model;  // of slopes at the same points
    if (!(ratio > 0) || !std::isfinite(ratio)) continue;
    ratios.push_back(ratio);
  }
  // Each window is twice the one before: the parabola through three, at a window of nothing; and as
  // much again within the narrowest as is seen of it.
  const std::size_t windows = ratios.size();
  if (windows > 0) ratios.push_back(ratios[0] * ratios[0]);
  if (windows > 2) ratios.push_back(8.0 / 3 * ratios[0] - 2 * ratios[1] + ratios[2] / 3);
  std::erase_if(ratios, [](double ratio) { return !(ratio > 0); });
  return ratios;
}

}  // namespace

ParameterEstimates CoverDiscrepancy(const Estimates& fitted, const Thresholds& thresholds,
                                    const FitResult& result) {
  ParameterEstimates parameters = result.parameters;
  ParameterEstimate& slip_force = parameters[kSlipForce];
  IncludeRatios(parameters[kStiffness], StiffnessOfWindows(fitted, thresholds));
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
