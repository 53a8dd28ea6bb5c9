#include "identification/diagnosis/discrepancy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>

#include "identification/diagnosis/grade.h"
#include "identification/diagnosis/main_strokes.h"
#include "identification/inference/evidence.h"
#include "identification/intervals.h"

namespace mindahl::identification {
namespace {

/// Place of a parameter among those that are free, their number where it is not.
std::size_t PlaceOf(const Problem& problem, std::size_t parameter) {
  const auto& free = problem.parameters.free();
  return static_cast<std::size_t>(std::ranges::find(free, parameter) - free.begin());
}

/// Sums of a regression of one column.
struct Sums {
  double product = 0.0;
  double squares = 0.0;
};

/// A closed interval that grows.
struct GrowingRange {
  double lower;
  double upper;
  void Include(double value) {
    lower = std::min(lower, value);
    upper = std::max(upper, value);
  }
};

/// Half the width of the interval in which a further cycle of the same loop has its half gap:
/// Student's for so few cycles.
double ScatterOfCycles(const loop::LoopFacts& facts) {
  const auto cycles = static_cast<double>(facts.steady_cycles);
  if (!facts.half_gap_standard_deviation || cycles < 3) return 0.0;
  return StudentQuantile95(cycles - 1) * *facts.half_gap_standard_deviation *
         std::sqrt(1 + 1 / cycles);
}

/// Half the width of the interval in which a further part of the strokes has its step: Student's
/// for so few parts.
double SpreadOf(std::span<const double> steps) {
  const auto count = static_cast<double>(steps.size());
  if (count < 2) return 0.0;
  const double mean = std::accumulate(steps.begin(), steps.end(), 0.0) / count;
  double squares = 0.0;
  for (const double step : steps) squares += (step - mean) * (step - mean);
  return StudentQuantile95(count - 1) * std::sqrt(squares / (count - 1));
}

}  // namespace

std::vector<double> SlipForceOfParts(const Problem& problem, const Solution&,
                                     const Estimates& estimates, const Thresholds& thresholds) {
  constexpr std::size_t kParts = 3;
  std::vector<double> steps;
  const std::size_t place = PlaceOf(problem, kSlipForce);
  if (place == problem.parameters.free().size() || problem.data->is_forced()) return steps;
  const auto& column = estimates.jacobian().col(static_cast<Eigen::Index>(place));
  const Eigen::VectorXd& residual = estimates.residual();
  std::array<Sums, 2 * kParts> sums{};
  std::size_t begin = 0;
  for (const ScaledRecord& record : problem.data->records) {
    for (const MainStroke& stroke :
         MainStrokes(record.excitation(), record.reversals, thresholds.main_stroke)) {
      const double from = record.excitation()[stroke.begin];
      const double width = record.excitation()[stroke.end] - from;
      for (std::size_t i = stroke.begin; i < stroke.end; ++i) {
        const double way = std::clamp((record.excitation()[i] - from) / width, 0.0, 1.0);
        const std::size_t part =
            std::min(kParts - 1, static_cast<std::size_t>(way * static_cast<double>(kParts)));
        Sums& sum = sums[part + (stroke.rises ? 0 : kParts)];
        const auto row = static_cast<Eigen::Index>(begin + i);
        sum.product -= column(row) * residual(row);
        sum.squares += column(row) * column(row);
      }
    }
    begin += record.size();
  }
  double most = 0.0;
  for (const Sums& sum : sums) most = std::max(most, sum.squares);
  constexpr double kLeast = 0.25;  // of the part that depends most on Tc
  for (const Sums& sum : sums) {
    if (sum.squares > kLeast * most) steps.push_back(sum.product / sum.squares);
  }
  return steps;
}

void CoverDiscrepancy(const Problem& problem, const Solution& solution, const Estimates& estimates,
                      std::span<const ParameterEstimate> plain, const Thresholds& thresholds,
                      FitResult& result) {
  ParameterEstimate& slip_force = result.parameters[kSlipForce];
  for (ParameterEstimate& estimate : result.parameters) {
    const bool is_closed = estimate.lower95 && estimate.upper95;
    estimate.includes_discrepancy = estimate.status != ParameterStatus::kFixed && is_closed &&
                                    result.adequacy.use != Use::kNone;
  }
  const loop::LoopFacts& facts = result.WidestRecord().facts;
  const double load_ratio = result.WidestRecord().load_ratio;
  const bool is_open = slip_force.lower95 && !slip_force.upper95;
  if (is_open && facts.closed && plain[kSlipForce].lower95) {
    const double carried = std::min(facts.peak_force / load_ratio, *plain[kSlipForce].lower95);
    RaiseLowerEnd(slip_force, IntervalSource::kCarriedForce, carried);
  }
  const std::optional<double> half_gap = MeasuredHalfGap(result);
  const bool is_free = slip_force.status != ParameterStatus::kFixed;
  if (!is_free || !half_gap || !SlidesOverMostOfStroke(facts, thresholds)) return;

  const std::vector<double> steps = SlipForceOfParts(problem, solution, estimates, thresholds);
  // The gap is a mean over parts of the strokes in each of which the model misses so much.
  const double error =
      result.adequacy.misfit / std::sqrt(std::max(1.0, static_cast<double>(steps.size())));
  const double margin = std::hypot(ScatterOfCycles(facts) / load_ratio, error);
  GrowingRange range{slip_force.value, slip_force.value};
  range.Include(*half_gap - margin);
  range.Include(*half_gap + margin);
  const double carried = std::max(*half_gap, facts.peak_force / load_ratio) + margin;
  const auto limited = [&](double end) { return std::clamp(end, *half_gap - margin, carried); };
  const double spread = SpreadOf(steps);
  range.Include(limited(slip_force.lower95.value_or(0.0)));
  range.Include(limited(slip_force.upper95.value_or(carried)));
  range.Include(limited(slip_force.value * std::exp(-spread)));
  range.Include(limited(slip_force.value * std::exp(spread)));
  SetInterval(slip_force,
              {.source = IntervalSource::kDiscrepancy, .lower = range.lower, .upper = range.upper});
  slip_force.includes_discrepancy = true;
  std::erase_if(result.findings,
                [](const Finding& finding) { return finding.code == "slip_force_bounded_below"; });
}

}  // namespace mindahl::identification
